"""The lockstep scheduler: virtual time, one thread, table order at equal times. Same table, same inputs, same bits.

Due times are `start + k * period` in integer nanoseconds. A part that is woken runs at the very time of the waking, in table order.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from heapq import heappop, heappush, heapreplace

from pluto_bt.runtime.clock import VirtualClock
from pluto_bt.runtime.supervision import Part, Waker

WAKES_AT_ONE_TIME = 16  # two parts that wake each other must not hold the clock; who is left out waits for his period, but for a stop


class Lockstep:
    """Steps parts in virtual time."""

    def __init__(self, parts: Sequence[Part], clock: VirtualClock) -> None:
        self.parts = tuple(parts)
        self.current: Part | None = None  # for the watchdog: who is at work
        self.turns = 0  # for the watchdog: how far we are
        self._clock = clock
        self._due: list[tuple[int, int, bool]] = []  # (at_ns, row, is_wake)
        self._is_woken = [False] * len(self.parts)
        self._wakes_now = 0

    def start(self) -> None:
        """Every part is due for the first time at once; the parts themselves have been started by the caller."""
        now_ns = self._clock.now_ns()
        for row, part in enumerate(self.parts):
            if part.period_ns:
                heappush(self._due, (now_ns, row, False))

    def waker(self, row: int, *, for_stop: bool = False) -> Waker:
        """What to call so that the part of this row steps now; `for_stop`: however many have been woken at this moment.

        Stops only travel down the chain, so they cannot hold the clock.
        """

        def wake() -> None:
            if not self._is_woken[row] and (for_stop or self._wakes_now < WAKES_AT_ONE_TIME):
                self._is_woken[row] = True
                self._wakes_now += 1
                heappush(self._due, (self._clock.now_ns(), row, True))

        return wake

    def run_until(self, end_ns: int, keep_going: Callable[[], bool] = lambda: True) -> None:
        """Step whatever is due up to `end_ns`; `keep_going` is asked each time the clock is about to move."""
        due, parts, clock, woken = self._due, self.parts, self._clock, self._is_woken
        now_ns = clock.now_ns()
        while due and due[0][0] <= end_ns:
            at_ns, row, is_wake = due[0]
            if at_ns > now_ns:
                if not keep_going():
                    return
                clock.jump_to(at_ns)
                now_ns = at_ns
                self._wakes_now = 0
            part = self.current = parts[row]
            if is_wake:
                heappop(due)
                woken[row] = False
            else:
                heapreplace(due, (at_ns + part.period_ns, row, False))
            self.turns += 1
            part.step(at_ns)
        self.current = None
        if keep_going():
            clock.jump_to(end_ns)
