"""What waits for the executive: of each client in the order in which it came, and of all clients one in turn."""

from __future__ import annotations

from collections import deque

from pluto_bt.gateway.requests import Get, Log, ShowModules, ShowTree, Why
from pluto_bt.gateway.wire import Ask, Gone, Up

Waiting = tuple[Up, int]
"""A frame, and the count of stops when it came."""


class Turns:
    """Lines of frames, one a client, or one for all connections of a session. Who asks for much waits behind himself alone."""

    def __init__(self) -> None:
        self._lines: dict[str, deque[Waiting]] = {}  # in the order of their turns
        self._held: dict[str, deque[Waiting]] = {}  # lines whose first request is at work elsewhere
        self._name_of: dict[int, str] = {}  # a client's line, until he is gone
        self._count = 0

    def __len__(self) -> int:
        return self._count

    @property
    def is_ready(self) -> bool:
        """True if somebody has a turn."""
        return bool(self._lines)

    def add(self, item: Waiting) -> None:
        """Line up. The inquiries of a client who is gone are forgotten: nobody hears the answers."""
        frame, name = item[0], ""
        if isinstance(frame, Ask):
            name = self._name_of[frame.client] = line_of(frame)
        elif isinstance(frame, Gone):
            name = self._name_of.pop(frame.client, "")
            self._forget(name, frame.client)
        line = self._held[name] if name in self._held else self._lines.setdefault(name, deque())
        line.append(item)
        self._count += 1

    def _forget(self, name: str, client: int) -> None:
        lines = self._held if name in self._held else self._lines
        line = lines.pop(name, None)
        if line is not None:
            kept = lines[name] = deque(item for item in line if not _is_inquiry_of(client, item[0]))
            self._count -= len(line) - len(kept)  # it may be empty, but for the frame that is about to join it

    def next(self) -> Waiting:
        """The first of the client whose turn it is; he goes to the end. Only if `is_ready`."""
        name = next(iter(self._lines))
        line = self._lines.pop(name)
        item = line.popleft()
        self._count -= 1
        if line:
            self._lines[name] = line
        return item

    def hold(self, name: str) -> None:
        """The rest of this line waits until it is free again."""
        self._held[name] = self._lines.pop(name, deque())

    def free(self, name: str) -> bool:
        """The line has its turns again; False if it was not held."""
        line = self._held.pop(name, None)
        if line:
            self._lines[name] = line
        return line is not None

    def clear(self) -> None:
        """Nobody waits any more."""
        self._lines.clear()
        self._held.clear()
        self._name_of.clear()
        self._count = 0


def line_of(ask: Ask) -> str:
    """The name of the line in which a request waits."""
    return ask.session or f"#{ask.client}"


def _is_inquiry_of(client: int, frame: Up) -> bool:
    return isinstance(frame, Ask) and frame.client == client and isinstance(frame.request, Get | ShowTree | ShowModules | Log | Why)
