"""What waits for the executive: of each client in the order in which it came, and of all clients one in turn."""

from __future__ import annotations

from collections import deque

from pluto_bt.gateway.wire import Ask, Gone, Key, Up

Waiting = tuple[Up, int]
"""A frame, and the count of stops when it came."""
_NOBODY: Key = 0
"""The line of what no client asks."""


class Turns:
    """Lines of frames, one a client, or one for all connections of a session. Who asks for much waits behind himself alone.

    Attributes:
        size_bytes: of all requests that wait or are at work elsewhere.
    """

    def __init__(self) -> None:
        self._lines: dict[Key, deque[Waiting]] = {}  # in the order of their turns
        self._held: dict[Key, deque[Waiting]] = {}  # lines whose first request is at work elsewhere
        self._holds: dict[int, tuple[Key, int]] = {}  # the line, and the size of the request at work
        self._line_of: dict[int, Key] = {}  # where a client waits, until he is gone
        self._last, self._n_holds = _NOBODY, 0
        self._count = self.size_bytes = 0

    def __len__(self) -> int:
        return self._count

    @property
    def is_ready(self) -> bool:
        """True if somebody has a turn."""
        return bool(self._lines)

    def add(self, item: Waiting) -> None:
        """Line up. The inquiries of a client who is gone are forgotten: nobody hears the answers."""
        frame, name = item[0], _NOBODY
        if isinstance(frame, Ask):
            name = self._line_of[frame.client] = self._line_for(frame)
        elif isinstance(frame, Gone):
            name = self._line_of.pop(frame.client, _NOBODY)
            self._forget(name, frame.client)
        line = self._held[name] if name in self._held else self._lines.setdefault(name, deque())
        line.append(item)
        self._count += 1
        self.size_bytes += _size_bytes(frame)

    def _line_for(self, ask: Ask) -> Key:
        """The line of his session; but who still waits where he began must not overtake himself."""
        name = self._line_of.get(ask.client, ask.key)
        return name if name in self._lines or name in self._held else ask.key

    def _forget(self, name: Key, client: int) -> None:
        lines = self._held if name in self._held else self._lines
        line = lines.pop(name, None)
        if line is not None:
            kept = lines[name] = deque(item for item in line if not _is_inquiry_of(client, item[0]))
            self._count -= len(line) - len(kept)  # it may be empty, but for the frame that is about to join it
            self.size_bytes -= sum(_size_bytes(item[0]) for item in line) - sum(_size_bytes(item[0]) for item in kept)

    def next(self) -> Waiting:
        """The first of the client whose turn it is; he goes to the end. Only if `is_ready`."""
        self._last = name = next(iter(self._lines))
        line = self._lines.pop(name)
        item = line.popleft()
        self._count -= 1
        self.size_bytes -= _size_bytes(item[0])
        if line:
            self._lines[name] = line
        return item

    def hold(self, ask: Ask) -> int:
        """The rest of the line that had the last turn waits until this request of it is done; the number of this hold."""
        self._n_holds += 1
        self._holds[self._n_holds] = self._last, ask.size_bytes
        self.size_bytes += ask.size_bytes
        self._held[self._last] = self._lines.pop(self._last, deque())
        return self._n_holds

    def is_wanted(self, hold: int, ask: Ask) -> bool:
        """False for a request under a hold that has ended, and for an inquiry of a client who is gone. In whatever thread."""
        return hold in self._holds and (ask.client in self._line_of or not ask.request.only_looks)

    def free(self, hold: int) -> None:
        """The line has its turns again, unless the hold has ended before."""
        if hold in self._holds:
            name, size_bytes = self._holds.pop(hold)
            self.size_bytes -= size_bytes
            line = self._held.pop(name)
            if line:
                self._lines[name] = line

    def clear(self) -> None:
        """Nobody waits any more; all holds end."""
        for waiting in (self._lines, self._held, self._holds, self._line_of):
            waiting.clear()
        self._count = self.size_bytes = 0


def _is_inquiry_of(client: int, frame: Up) -> bool:
    return isinstance(frame, Ask) and frame.client == client and frame.request.only_looks


def _size_bytes(frame: Up) -> int:
    return frame.size_bytes if isinstance(frame, Ask) else 0
