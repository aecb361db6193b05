"""Time as a parameter: the virtual clock of lockstep runs and tests, and the monotonic clock of the robot."""

from __future__ import annotations

import heapq
import itertools
import threading
import time
from collections.abc import Callable
from typing import Protocol

NS = 1_000_000_000


class Clock(Protocol):
    """Seconds of the run, monotonic, from 0 at its start."""

    def now_ns(self) -> int:
        """Nanoseconds since the start of the run."""

    def now_s(self) -> float:
        """Seconds since the start of the run."""


class MissionClock(Protocol):
    """All that a mission needs of a clock. One that also has `call_at(at_s, callback)` fires timers between ticks."""

    def now_s(self) -> float:
        """Seconds of the run."""


class Timer:
    """A callback that a clock owes; `cancel` forgets it."""

    __slots__ = ("at_ns", "callback", "cancelled")

    def __init__(self, at_ns: int, callback: Callable[[], None]) -> None:
        self.at_ns = at_ns
        self.callback = callback
        self.cancelled = False

    def cancel(self) -> None:
        """The callback will not be called any more."""
        self.cancelled = True


class VirtualClock:
    """A clock that moves only when told. Timers that fall due fire inside `advance`, in order of time, then of creation."""

    def __init__(self) -> None:
        self._now_ns = 0
        self._timers: list[tuple[int, int, Timer]] = []
        self._order = itertools.count()

    def now_ns(self) -> int:
        """Nanoseconds since the start of the run."""
        return self._now_ns

    def now_s(self) -> float:
        """Seconds since the start of the run."""
        return self._now_ns / NS

    def call_at(self, at_s: float, callback: Callable[[], None]) -> Timer:
        """Call `callback` when the clock reaches `at_s`."""
        timer = Timer(round(at_s * NS), callback)
        heapq.heappush(self._timers, (timer.at_ns, next(self._order), timer))
        return timer

    def advance(self, seconds: float) -> None:
        """Move on by `seconds`, firing due timers on the way, each at its own time."""
        if seconds < 0:
            raise ValueError(f"time does not run backwards: advance({seconds})")
        self.jump_to(self._now_ns + round(seconds * NS))

    def jump_to(self, at_ns: int) -> None:
        """Move on to `at_ns`, firing due timers on the way."""
        while self._timers and self._timers[0][0] <= at_ns:
            due_ns, _, timer = heapq.heappop(self._timers)
            self._now_ns = max(self._now_ns, due_ns)
            if not timer.cancelled:
                timer.callback()
        self._now_ns = max(self._now_ns, at_ns)


class MonotonicClock:
    """The clock of the robot, and of `--realtime` runs: `speed` run seconds pass in one second of the wall."""

    def __init__(self, speed: float = 1.0) -> None:
        self._start_ns = time.monotonic_ns()
        self.speed = speed

    def restart(self) -> None:
        """Count from now: the time that setting up took does not belong to the run."""
        self._start_ns = time.monotonic_ns()

    def now_ns(self) -> int:
        """Nanoseconds since the start of the run."""
        return int((time.monotonic_ns() - self._start_ns) * self.speed)

    def now_s(self) -> float:
        """Seconds since the start of the run."""
        return self.now_ns() / NS


class StepClock:
    """A clock that stands still until it is told the time: where real time flows, a tick of the tree still sees one moment."""

    def __init__(self) -> None:
        self._now_s = 0.0

    def now_ns(self) -> int:
        """Nanoseconds of the run at the last step."""
        return round(self._now_s * NS)

    def now_s(self) -> float:
        """Seconds of the run at the last step."""
        return self._now_s

    def step_to(self, now_s: float) -> None:
        """It is `now_s`, until the next call."""
        self._now_s = now_s


wall_ns = time.perf_counter_ns
"""The wall's monotonic nanoseconds, for measuring and for the watchdog; never for decisions that a trace holds."""


def calendar_ns() -> int:
    """Nanoseconds since 1970, for what outlives a run; never for decisions within one."""
    return time.time_ns()


def wait(event: threading.Event, seconds: float) -> bool:
    """Wait for `event` at most `seconds` of the wall; True if it came. The one place where the main thread waits."""
    return event.wait(seconds)
