"""The audit log: every message that may change something, who sent it, and what came of it; one JSON line each."""

from __future__ import annotations

import contextlib
import math
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec

from pluto_bt.gateway.replies import AnyReply, Error
from pluto_bt.gateway.tally import Entry, Tally
from pluto_bt.gateway.wire import Ask, Refused
from pluto_bt.runtime.clock import calendar_ns
from pluto_bt.runtime.state_folder import open_private, state_path

LIMIT_BYTES, OLD_FILES = 16 * 1024 * 1024, 4
CONTENT_BYTES, NAME_CHARACTERS = 512, 128
WAITING = 16 * 1024
RETRY_S, LONGEST_RETRY_S = 1.0, 60.0


def default_path() -> Path:
    """Where the log lies if no other place is asked for."""
    return state_path() / "audit.jsonl"


class Audit:
    """`note` never waits, and may be called in any thread; `step` writes. At 16 MiB the file becomes FILE.1, that FILE.2 and so on to FILE.4.

    What a client is refused again and again for the same reason, or does again and again while nobody does anything else, stands there once; how
    often it came again is told after 30 s, or when it is over (`times` more since second `since_s` of the run).

    What cannot be written is tried again, later each time. What cannot be kept so long is counted, and the count is written.

    Args:
        path: None = nothing is kept.
        trouble: told once each time that the file cannot be written any more.
    """

    def __init__(self, path: Path | None, trouble: Callable[[str], None] = lambda text: None) -> None:
        self._path, self._trouble = path, trouble
        self._waiting: deque[bytes] = deque()
        self._lost: deque[None] = deque()  # one each, for it is safe in all threads
        self._tally = Tally()
        self._encoder = msgspec.json.Encoder()
        self._retry_s, self._next_s = 0.0, -math.inf

    def note(self, ask: Ask, reply: AnyReply, run_s: float) -> None:
        """A request and its answer."""
        outcome = reply.code if isinstance(reply, Error) else "ok"
        content = {name: value for name, value in msgspec.to_builtins(ask.request).items() if name != "_"}
        self._keep(run_s, ask, ask.request.element, content, outcome)

    def note_refused(self, refused: Refused, run_s: float) -> None:
        """A request that the gateway itself refused."""
        self._keep(run_s, refused, refused.what, {"text": refused.text}, refused.code)

    def _keep(self, run_s: float, sender: Ask | Refused, what: str, content: dict[str, Any], outcome: str) -> None:
        if self._path is None:
            return
        if len(self._waiting) >= WAITING:
            self._lost.append(None)
            return
        size_bytes = len(self._encoder.encode(content))
        deed = what, self._encoder.encode({name: word for name, word in content.items() if name != "id"})
        if size_bytes > CONTENT_BYTES:  # a mission, say
            content = {"bytes": size_bytes}
        who = {"client": sender.client, "name": sender.name[:NAME_CHARACTERS], "session": sender.session, "peer": sender.peer}
        entry = who | {"request": what, "content": content, "outcome": outcome}
        if outcome == "ok":
            self._write_sums(run_s, self._tally.deed(deed))
        kind = deed if outcome == "ok" else outcome
        if self._tally.is_first((sender.client, kind), (sender.peer.rpartition(":")[0], kind), entry, run_s):
            self._waiting.append(self._line(run_s, entry))

    def _write_sums(self, run_s: float, sums: list[Entry]) -> None:
        self._waiting.extend(self._line(run_s, entry) for entry in sums)

    def _line(self, run_s: float, entry: dict[str, Any]) -> bytes:
        return self._encoder.encode({"at_ns": calendar_ns(), "run_s": round(run_s, 3)} | entry) + b"\n"

    def end(self, now_s: float) -> None:
        """Write all that is known."""
        self._write_sums(now_s, self._tally.due(math.inf))
        self._next_s = -math.inf
        self.step(now_s)

    def step(self, now_s: float) -> None:
        """Write what waits."""
        self._write_sums(now_s, self._tally.due(now_s))
        if self._path is None or not self._waiting or now_s < self._next_s:
            return
        n_lost, lines = len(self._lost), list(self._waiting)
        told = self._line(now_s, {"request": "", "outcome": "lost", "lines": n_lost}) if n_lost else b""
        try:
            self._append(self._path, b"".join(lines) + told)
        except OSError as error:
            if not self._retry_s:
                self._trouble(f"the audit log {self._path} cannot be written; it is tried again: {error.strerror or error}")
            self._retry_s = min(LONGEST_RETRY_S, max(RETRY_S, 2.0 * self._retry_s))
            self._next_s = now_s + self._retry_s
            return
        self._retry_s = 0.0
        for done, count in ((self._waiting, len(lines)), (self._lost, n_lost)):
            for _ in range(count):
                done.popleft()

    @staticmethod
    def _append(path: Path, lines: bytes) -> None:
        """All of it or nothing. Raises: OSError."""
        path.parent.mkdir(parents=True, exist_ok=True)
        with contextlib.suppress(FileNotFoundError):
            if path.stat().st_size > LIMIT_BYTES:
                for number in range(OLD_FILES, 0, -1):
                    with contextlib.suppress(FileNotFoundError):
                        _old(path, number - 1).replace(_old(path, number))
        with open(path, "ab", buffering=0, opener=open_private) as file:
            begin = file.tell()
            try:
                if file.write(lines) != len(lines):
                    raise OSError("the disk is full")
            except OSError:
                file.truncate(begin)
                raise


def _old(path: Path, number: int) -> Path:
    return path.with_name(f"{path.name}.{number}") if number else path
