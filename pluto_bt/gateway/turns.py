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
        self._name_of: dict[int, str] = {}  # a client's line, until he is gone
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def add(self, item: Waiting) -> None:
        """Line up. The inquiries of a client who is gone are forgotten: nobody hears the answers."""
        frame, name = item[0], ""
        if isinstance(frame, Ask):
            name = self._name_of[frame.client] = frame.session or f"#{frame.client}"
        elif isinstance(frame, Gone):
            name = self._name_of.pop(frame.client, "")
            self._forget(name, frame.client)
        self._lines.setdefault(name, deque()).append(item)
        self._count += 1

    def _forget(self, name: str, client: int) -> None:
        line = self._lines.pop(name, None)
        if line is not None:
            kept = deque(item for item in line if not _is_inquiry_of(client, item[0]))
            self._count -= len(line) - len(kept)
            self._lines[name] = kept  # the frame that is about to join stands at its end, so no line is empty

    def next(self) -> Waiting:
        """The first of the client whose turn it is; he goes to the end. Raises: StopIteration if nobody waits."""
        name = next(iter(self._lines))
        line = self._lines.pop(name)
        item = line.popleft()
        self._count -= 1
        if line:
            self._lines[name] = line
        return item

    def clear(self) -> None:
        """Nobody waits any more."""
        self._lines.clear()
        self._name_of.clear()
        self._count = 0


def _is_inquiry_of(client: int, frame: Up) -> bool:
    return isinstance(frame, Ask) and frame.client == client and isinstance(frame.request, Get | ShowTree | ShowModules | Log | Why)
