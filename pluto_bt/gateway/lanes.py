"""Clients who want one topic at one rate, and are served together."""

from __future__ import annotations

import numpy as np

from pluto_bt.gateway.newest import Newest
from pluto_bt.gateway.outlets import Outlets, Slots
from pluto_bt.gateway.subscriptions import Flow

FLOWS = 512
"""A lane with so many is full: the last of them waits for the sends to all others."""


class Lane:
    """Flows of one topic and one period.

    Those that can take any value as it comes run along: one burst serves them, and no one of them is looked at. The others are asked each time.

    Attributes:
        next_s: when it is due; seq: of the value it was served with last.
    """

    __slots__ = ("_along", "_others", "_outlets", "_row", "_slots", "next_s", "period_s", "seq")

    def __init__(self, outlets: Outlets, period_s: float, next_s: float) -> None:
        self.period_s, self.next_s = period_s, next_s
        self.seq = 0
        self._outlets = outlets
        self._along: dict[Flow, None] = {}  # each has taken the lane's last value
        self._others: dict[Flow, None] = {}
        self._row: list[Flow] | None = None  # those who run along, while they are the same as last time
        self._slots: Slots = np.zeros(0, np.intp)  # and their outlets

    def __len__(self) -> int:
        return len(self._along) + len(self._others)

    def join(self, flow: Flow) -> None:
        """A new flow; what it has taken so far it says itself."""
        self._others[flow] = None

    def leave(self, flow: Flow) -> None:
        """Nobody wants this flow any more."""
        if flow in self._along:
            del self._along[flow]
            self._row = None
        self._others.pop(flow, None)

    def serve(self, newest: Newest, now_s: float) -> list[Flow]:
        """Send the value to all who can take it at once; returns the others, for whom it waits now."""
        before, self.seq = self.seq, newest.seq
        if self.period_s:
            late_s = now_s - self.next_s
            self.next_s = self.next_s + self.period_s if late_s < self.period_s else now_s + self.period_s
        waiting = self._serve_along(newest, before, now_s) if self._along and newest.seq != before else []
        waiting += [flow for flow in self._others if flow.take(newest)]
        joining = [flow for flow in self._others if flow.outlet is not None]
        for flow in joining:
            del self._others[flow]
            self._along[flow] = self._row = None
        return waiting

    def _serve_along(self, newest: Newest, before: int, now_s: float) -> list[Flow]:
        if self._row is None:
            self._row = list(self._along)
            self._slots = np.array([flow.outlet.slot for flow in self._row if flow.outlet is not None], np.intp)
        late = self._row
        if self.period_s or newest.seq == before + 1:  # who wants each value is told what he lost
            is_sent = self._outlets.send(self._slots, newest.line(now_s))
            late = [] if is_sent.all() else [self._row[i] for i in np.flatnonzero(~is_sent).tolist()]
        for flow in late:
            flow.seq = before
            flow.take(newest)
        return list(late)
