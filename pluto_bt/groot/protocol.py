"""The protocol of the monitor without sockets: the parts of a request in, the parts of the reply out.

Request: 6 bytes (protocol 2, type, number chosen by the client), for some types a second part. Reply: the same 6 bytes and 16 bytes of the
tree's id, then the payload if there is one. Errors are two parts of text. Hooks (break-points, replaced results) are refused: who watches
does not drive.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Final

import msgspec

from pluto_bt.groot.snapshot import Shown
from pluto_bt.groot.tree_xml import tree_xml

PROTOCOL: Final = 2
REQUEST: Final = struct.Struct("<BcI")
NO_HOOKS: Final = "break-points are not served: this monitor only looks on"
NO_NODE: Final = "Node ID not found"
NO_ID: Final = bytes(16)

Payload = bytes | None


class GrootError(Exception):
    """A request that is answered with an error."""


class Desk:
    """Answers requests about the mission that is shown; `calendar_us` and `now_ns` tell the time of the wall and of the run."""

    def __init__(self, now_ns: Callable[[], int], calendar_us: Callable[[], int]) -> None:
        self.shown: Shown | None = None
        self.answered = 0  # requests so far
        self._now_ns, self._calendar_us = now_ns, calendar_us
        self._xml: tuple[Shown, bytes] | None = None
        self._types: dict[bytes, Callable[[list[bytes]], Payload]] = {
            b"T": self._tree, b"S": self._statuses, b"B": self._boards, b"t": self._changes, b"r": self._record,
            b"D": lambda parts: b"[]", b"A": lambda parts: None, b"X": lambda parts: None,
            b"I": self._hook(NO_HOOKS), b"R": self._hook(NO_NODE), b"U": self._hook(NO_NODE),
        }  # fmt: skip

    def answer(self, parts: list[bytes]) -> list[bytes]:
        """The reply to one request; never raises, whatever was sent."""
        self.answered += 1
        try:
            return self._answer(parts)
        except GrootError as error:
            return [b"error", str(error).encode()]

    def _answer(self, parts: list[bytes]) -> list[bytes]:
        if not parts or len(parts[0]) != REQUEST.size:
            raise GrootError("wrong request header")
        _, kind, number = REQUEST.unpack(parts[0])
        if kind not in self._types:
            raise GrootError("Request not recognized")
        payload = self._types[kind](parts)
        head = REQUEST.pack(PROTOCOL, kind, number) + (self.shown.tree_id if self.shown is not None else NO_ID)
        return [head] if payload is None else [head, payload]

    def _tree(self, parts: list[bytes]) -> Payload:
        shown = self._asked()
        if self._xml is None or self._xml[0] is not shown:
            self._xml = shown, tree_xml(shown.mission.name, shown.mission.nodes()[0].plan).encode()
        return self._xml[1]

    def _statuses(self, parts: list[bytes]) -> Payload:
        return self._asked().statuses()

    def _boards(self, parts: list[bytes]) -> Payload:
        names = _second(parts).decode("utf-8", "replace").split(";")
        return msgspec.msgpack.encode(self._asked().boards(names))

    def _changes(self, parts: list[bytes]) -> Payload:
        return self._asked().take_changes()

    def _record(self, parts: list[bytes]) -> Payload:
        word = _second(parts)
        if word == b"start":
            self._asked().record(self._now_ns())
            return str(self._calendar_us()).encode()
        if word == b"stop":
            self._asked().stop_recording()
            return None
        raise GrootError("expected start or stop")

    def _asked(self) -> Shown:
        if self.shown is None:
            raise GrootError("there is no tree yet")
        return self.shown

    @staticmethod
    def _hook(text: str) -> Callable[[list[bytes]], Payload]:
        def refuse(parts: list[bytes]) -> Payload:
            _second(parts)
            raise GrootError(text)

        return refuse


def _second(parts: list[bytes]) -> bytes:
    if len(parts) < 2:
        raise GrootError("must be 2 parts message")
    return parts[1]
