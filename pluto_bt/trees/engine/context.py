"""What all nodes of one mission share: the clock, the timers, the wake-up flag and the list of nodes skipped in this tick."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable
from typing import Any, Protocol

from pluto_bt.runtime.clock import MissionClock


class Timer(Protocol):
    """Something that will call back."""

    def cancel(self) -> None:
        """Forget it."""


class PolledTimer:
    """A timer of a clock that cannot call back: looked at when the tree is ticked."""

    __slots__ = ("callback", "cancelled")

    def __init__(self, callback: Callable[[], None]) -> None:
        self.callback = callback
        self.cancelled = False

    def cancel(self) -> None:
        """The callback will not be called any more."""
        self.cancelled = True


class FrozenClock:
    """The clock of a node that is in no mission: time stands still."""

    def now_s(self) -> float:
        """Always 0."""
        return 0.0


class Context:
    """Shared by the nodes of one mission, and by nothing else."""

    def __init__(self, clock: MissionClock | None = None) -> None:
        self.clock: MissionClock = clock if clock is not None else FrozenClock()
        self.woken = False
        self.may_remember = True  # False: every node is ticked, also those of which it is known what they would answer
        self.skipped: list[Any] = []
        self.current: Any = None  # the leaf that was begun last: the one to blame while a tick does not come back
        self.late_error: Exception | None = None  # raised by a timer between ticks, told at the next tick
        self.polled: list[tuple[float, int, PolledTimer]] = []
        self._order = itertools.count()

    def wake_up(self) -> None:
        """A node asks for another tick at once (`tick_once` repeats, `tick_exactly_once` does not)."""
        self.woken = True

    def call_in(self, delay_s: float, callback: Callable[[], None]) -> Timer:
        """Call `callback` in `delay_s` seconds: inside `advance` of a clock that can, else at the first tick after it."""
        at_s = self.clock.now_s() + delay_s
        guarded = self._guard(callback)
        call_at = getattr(self.clock, "call_at", None)
        if call_at is not None:
            timer: Timer = call_at(at_s, guarded)
            return timer
        polled = PolledTimer(guarded)
        heapq.heappush(self.polled, (at_s, next(self._order), polled))
        return polled

    def fire_due(self) -> None:
        """Fire the polled timers whose time has come."""
        while self.polled and self.polled[0][0] <= self.clock.now_s():
            timer = heapq.heappop(self.polled)[2]
            if not timer.cancelled:
                timer.callback()

    def _guard(self, callback: Callable[[], None]) -> Callable[[], None]:
        """An error inside a timer must not break the clock: it is kept and raised by the next tick."""

        def call() -> None:
            try:
                callback()
            except Exception as error:
                self.late_error = self.late_error or error

        return call
