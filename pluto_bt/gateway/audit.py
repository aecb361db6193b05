"""The audit log: every message that may change something, who sent it, and what came of it; one JSON line each."""

from __future__ import annotations

import contextlib
from collections import deque
from collections.abc import Callable
from pathlib import Path

import msgspec

from pluto_bt.gateway.replies import AnyReply, Error
from pluto_bt.gateway.wire import Ask
from pluto_bt.runtime.clock import calendar_ns
from pluto_bt.runtime.state_folder import open_private, state_path

LIMIT_BYTES = 16 * 1024 * 1024
LINE_BYTES = 4096
WAITING = 16 * 1024


def default_path() -> Path:
    """Where the log lies if no other place is asked for."""
    return state_path() / "audit.jsonl"


class Audit:
    """`note` never waits, and may be called in any thread; `step` writes. At 16 MiB the file becomes FILE.1, and a new one is begun.

    Args:
        path: None = nothing is kept.
        trouble: told once if the file cannot be written.
    """

    def __init__(self, path: Path | None, trouble: Callable[[str], None] = lambda text: None) -> None:
        self._path, self._trouble = path, trouble
        self._waiting: deque[bytes] = deque(maxlen=WAITING)
        self._encoder = msgspec.json.Encoder()

    def note(self, ask: Ask, reply: AnyReply, run_s: float) -> None:
        """A request and its answer."""
        if self._path is None:
            return
        outcome = reply.code if isinstance(reply, Error) else "ok"
        request = msgspec.to_builtins(ask.request)
        what = request.pop("_")
        entry = {"at_ns": calendar_ns(), "run_s": round(run_s, 3), "client": ask.client, "name": ask.name, "session": ask.session, "peer": ask.peer,
                 "request": what, "content": request, "outcome": outcome}  # fmt: skip
        line = self._encoder.encode(entry)
        if len(line) > LINE_BYTES:  # a mission, say
            line = self._encoder.encode(entry | {"content": {"bytes": len(line)}})
        self._waiting.append(line + b"\n")

    def step(self) -> None:
        """Write what waits."""
        if not self._waiting or self._path is None:
            return
        lines = b"".join(self._waiting.popleft() for _ in range(len(self._waiting)))
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            with contextlib.suppress(FileNotFoundError):
                if self._path.stat().st_size > LIMIT_BYTES:
                    self._path.replace(self._path.with_name(self._path.name + ".1"))
            with open(self._path, "ab", opener=open_private) as file:
                file.write(lines)
        except OSError as error:
            self._trouble(f"the audit log {self._path} cannot be written: {error.strerror or error}")
            self._path = None
