"""The thread scheduler: one thread a group, so that a hung mission cannot block the chain. Same table and parts as lockstep."""

from __future__ import annotations

import threading
from collections.abc import Sequence

from pluto_bt.runtime.clock import NS, MonotonicClock
from pluto_bt.runtime.precedence import take_precedence
from pluto_bt.runtime.supervision import Part, Waker


class _Group(threading.Thread):
    """The parts of one group, stepped when due or woken."""

    def __init__(self, name: str, parts: Sequence[Part], clock: MonotonicClock, goes_first: bool) -> None:
        super().__init__(name=f"pluto-{name}", daemon=True)
        self.parts = tuple(parts)
        self.current: Part | None = None
        self.busy_since_ns = 0
        self.clock = clock
        self._goes_first = goes_first
        self.late_ns = 0
        self._wake = threading.Condition()
        self._woken: set[int] = set()
        self._stopping = False

    def wake(self, index: int) -> None:
        """Step the part as soon as the thread is free."""
        with self._wake:
            self._woken.add(index)
            self._wake.notify()

    def end(self) -> None:
        """Leave the loop after the step at hand."""
        with self._wake:
            self._stopping = True
            self._wake.notify()

    def run(self) -> None:
        if self._goes_first:
            take_precedence()
        now_ns = self.clock.now_ns()
        due_ns = [now_ns if part.period_ns else -1 for part in self.parts]
        while True:
            with self._wake:
                wait_s = self._seconds_to_next(due_ns)
                if not self._stopping and not self._woken and wait_s > 0.0:
                    self._wake.wait(wait_s)
                if self._stopping:
                    return
                woken, self._woken = self._woken, set()
            self._step_due(due_ns, woken)

    def _seconds_to_next(self, due_ns: list[int]) -> float:
        times = [at for at in due_ns if at >= 0]
        if not times:
            return 3600.0
        return max(0.0, (min(times) - self.clock.now_ns()) / NS / self.clock.speed)

    def _step_due(self, due_ns: list[int], woken: set[int]) -> None:
        for index, part in enumerate(self.parts):
            now_ns = self.clock.now_ns()
            is_due = 0 <= due_ns[index] <= now_ns
            if not is_due and index not in woken:
                continue
            if is_due:
                late = now_ns - due_ns[index]
                self.late_ns = max(self.late_ns, late)
                missed = late // part.period_ns  # a late part does not run twice to catch up
                part.overruns += missed
                due_ns[index] += (missed + 1) * part.period_ns
            self.busy_since_ns, self.current = now_ns, part
            part.step(now_ns)
            self.current = None


class Threads:
    """Steps parts in real time (or at `--speed` times it), one thread a group.

    Attributes:
        goes_first: its threads ask to go before the computer's ordinary programs.
    """

    def __init__(self, parts: Sequence[Part], clock: MonotonicClock) -> None:
        self.parts = tuple(parts)
        self._clock = clock
        names = tuple(dict.fromkeys(part.module.group for part in parts))
        self.goes_first = clock.speed <= 1.0  # a simulation in a hurry is nobody's robot, and would take the processor from all others
        self._groups = {name: _Group(name, [part for part in parts if part.module.group == name], clock, self.goes_first) for name in names}

    def start(self) -> None:
        """Start the threads; the parts themselves have been started by the caller."""
        for group in self._groups.values():
            group.start()

    def waker(self, row: int, *, for_stop: bool = False) -> Waker:
        """What to call so that the part of this row steps as soon as its thread is free; here a stop is no faster than a command."""
        part = self.parts[row]
        group = self._groups[part.module.group]
        index = group.parts.index(part)
        return lambda: group.wake(index)

    def stuck_part(self, limit_s: float) -> Part | None:
        """A part whose step has lasted longer than `limit_s` of the wall, or None."""
        for group in self._groups.values():
            part = group.current
            if part is not None and (self._clock.now_ns() - group.busy_since_ns) / NS / self._clock.speed > limit_s:
                return part
        return None

    def stop(self, wait_s: float = 1.0) -> None:
        """End the threads. A hung thread is left behind (it is a daemon)."""
        for group in self._groups.values():
            group.end()
        for group in self._groups.values():
            if group.is_alive():
                group.join(wait_s)
