"""The sockets of all clients as one table, so that a line goes to a thousand of them at once, past their transports.

That is allowed where nothing stands before the line. Whoever lets something wait for a client holds his outlet; it opens again when the next
line finds nothing waiting. So no client is asked as long as all goes well.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pluto_bt.gateway.burst import Burst, Ints, Writes

Slots = NDArray[np.intp]


class Owner(Protocol):
    """Whose socket it is."""

    def is_clear(self) -> bool:
        """True if nothing of his waits to be sent, and more may be sent."""

    def send_rest(self, rest: bytes) -> None:
        """The socket took a line only in part: send the rest before all else."""


class Outlet:
    """One client's place in the table. It must be closed before his socket is."""

    __slots__ = ("_table", "slot")

    def __init__(self, table: Outlets, slot: int) -> None:
        self._table, self.slot = table, slot

    def hold(self) -> None:
        """Something waits: nothing goes past it."""
        self._table.is_open[self.slot] = False

    def close(self) -> None:
        """The socket ends; harmless if it is done twice."""
        self._table.close(self)


class Outlets:
    """The table; `burst` does the sending."""

    def __init__(self, burst: Burst | None = None) -> None:
        self._burst = burst or Writes()
        self._fds: Ints = np.full(0, -1, np.int32)
        self._owners: list[Owner | None] = []
        self._free: list[int] = []
        self.is_open = np.zeros(0, np.bool_)  # by slot: a line may be sent without asking

    def add(self, fd: int, owner: Owner) -> Outlet:
        """A client's socket, which never blocks."""
        if not self._free:
            self._grow()
        slot = self._free.pop()
        self._fds[slot], self._owners[slot] = fd, owner
        return Outlet(self, slot)

    def close(self, outlet: Outlet) -> None:
        """Nothing is ever sent there again."""
        slot, outlet.slot = outlet.slot, 0
        if slot:
            self._fds[slot], self._owners[slot], self.is_open[slot] = -1, None, False
            self._free.append(slot)

    def send(self, slots: Slots, line: bytes) -> NDArray[np.bool_]:
        """Send a line to the clients in `slots` (n,); (n,) true for whom it is on its way."""
        for slot in slots[~self.is_open[slots]].tolist():
            owner = self._owners[slot]
            self.is_open[slot] = owner is not None and owner.is_clear()
        is_sent = self.is_open[slots]
        chosen = slots[is_sent]
        sent = self._burst.send(self._fds[chosen], line)
        if np.any(sent != len(line)):
            is_sent[is_sent] = self._mend(chosen, sent, line)
        return is_sent

    def _mend(self, slots: Slots, sent: Ints, line: bytes) -> NDArray[np.bool_]:
        """Some sockets took less than all: the transports go on with them, and hear of what is broken."""
        for i in np.flatnonzero(sent != len(line)).tolist():
            slot, n_bytes = int(slots[i]), int(sent[i])
            self.is_open[slot] = False
            owner = self._owners[slot]
            if n_bytes >= 0 and owner is not None:
                owner.send_rest(line[n_bytes:])
        return np.asarray(sent >= 0)

    def _grow(self) -> None:
        """Twice the slots. Slot 0 is nobody's: there closed outlets point to."""
        old, more = len(self._owners), max(16, len(self._owners))
        self._fds = np.concatenate([self._fds, np.full(more, -1, np.int32)])
        self.is_open = np.concatenate([self.is_open, np.zeros(more, np.bool_)])
        self._owners += [None] * more
        self._free += range(old + more - 1, max(old, 1) - 1, -1)
