"""Supervision: a part that raises is counted, reported and started again with back-off; a critical one stops the robot.

A `Part` is a component with its row of the table and its record of service. Both schedulers step parts, never components.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Protocol

from pluto_bt.runtime.clock import NS, wall_ns
from pluto_bt.runtime.component import Component
from pluto_bt.runtime.table import Module

FIRST_BACK_OFF_NS = NS // 10
LONGEST_BACK_OFF_NS = 5 * NS
HEALTHY_AFTER_NS = 10 * NS  # a part that ran this long without failing starts over with the first back-off
RESTARTS_OF_A_CRITICAL_PART = 3


class InjectedError(Exception):
    """The failure that a world script asked for."""


class Listener(Protocol):
    """Who is told of failures; called in the thread of the part."""

    def part_failed(self, part: Part, error: BaseException, is_final: bool) -> None:
        """`part` raised; `is_final`: it is critical and will not be started again."""

    def part_restarted(self, part: Part) -> None:
        """`part` runs again after a failure."""


class Part:
    """A module at work."""

    def __init__(self, module: Module, component: Component, row: int, listener: Listener) -> None:
        self.module = module
        self.component = component
        self.row = row
        self.listener = listener
        self.is_running = False
        self.steps = self.failures = self.overruns = 0
        self.total_ns = self.worst_ns = 0
        self.stepped_ns = 0  # when it last finished a step: its sign of life
        self.error = ""
        self.fault = ""  # what a world script does to this part: "", raise, hang, slow
        self.slow_ns = 0
        self.failed_at_ns = -HEALTHY_AFTER_NS
        self.resume_at_ns = 0
        self.has_given_up = False
        self._has_failed = False  # since it was started last
        self._wanted: bool | None = None  # an order to start or stop, carried out by the part's own thread
        self._handed: deque[Callable[[], None]] = deque()  # what others want done between two steps
        self._back_off_ns = FIRST_BACK_OFF_NS
        self._budget_ns = round(module.budget_ms * 1e6)
        self._notable_ns = 0  # a step that takes longer is the worst so far, or over budget
        self.period_ns = module.period_ns

    def start(self, now_ns: int) -> None:
        """Start the component; harmless if it runs."""
        if not self.is_running:
            self.component.start(now_ns / NS)
            self.stepped_ns = now_ns
            self.is_running = True

    def stop(self) -> None:
        """Stop the component; it stays listed. Harmless if it is stopped."""
        if self.is_running:
            self.is_running = False
            self.component.stop()

    def order(self, run: bool) -> None:
        """Start or stop at the next step, in the part's own thread. Starting twice is harmless."""
        self._wanted = run

    def hand(self, call: Callable[[], None]) -> None:
        """Have `call` made before the next step, in the part's own thread."""
        self._handed.append(call)

    def step(self, now_ns: int) -> None:
        """One supervised step: never raises (but for what is not an Exception, such as the watchdog's interrupt)."""
        if self._wanted is not None and not self._obey(now_ns):
            return
        if not self.is_running or now_ns < self.resume_at_ns or self.has_given_up or self.fault == "hang":
            return
        began_ns = wall_ns()
        try:
            if self._handed or self._has_failed or self.fault:
                self._prepare(now_ns)
            self.component.step(now_ns / NS)
            self.stepped_ns = now_ns
        except Exception as error:
            self._fail(now_ns, error)
        took_ns = wall_ns() - began_ns
        self.steps += 1
        self.total_ns += took_ns
        if took_ns > self._notable_ns:
            self._note_slow(took_ns)
        if self.slow_ns:
            self.resume_at_ns = now_ns + self.slow_ns

    def _prepare(self, now_ns: int) -> None:
        """What comes before a step now and then: what others want done, a failure that a world script asked for, a new start."""
        while self._handed:
            self._handed.popleft()()
        if self.fault == "raise":
            raise InjectedError(f'the world script lets module "{self.module.name}" raise')
        if self._has_failed:
            self._restart(now_ns)

    def _obey(self, now_ns: int) -> bool:
        """Start or stop as ordered; False if the component raised. One that cannot start stays stopped, with the error beside it."""
        wanted, self._wanted = self._wanted, None
        try:
            if wanted:
                self.has_given_up = self._has_failed = False
                self.resume_at_ns, self.error = 0, ""
                self.start(now_ns)
            else:
                self.stop()
        except Exception as error:
            self._fail(now_ns, error)
            return False
        return True

    def _note_slow(self, took_ns: int) -> None:
        """The slowest step so far, or one over budget. The first step does not count: it pays for imports and caches."""
        if self.steps > 1:
            self.worst_ns = max(self.worst_ns, took_ns)
            self.overruns += took_ns > self._budget_ns
            self._notable_ns = min(self.worst_ns, self._budget_ns)

    def _fail(self, now_ns: int, error: Exception) -> None:
        self.failures += 1
        self.error = f"{type(error).__name__}: {error}"
        if now_ns - self.failed_at_ns > HEALTHY_AFTER_NS:
            self._back_off_ns = FIRST_BACK_OFF_NS
        last_chance_ns = FIRST_BACK_OFF_NS << RESTARTS_OF_A_CRITICAL_PART
        self.has_given_up = self.module.critical and self._back_off_ns >= last_chance_ns
        self.failed_at_ns, self._has_failed = now_ns, True
        self.resume_at_ns = now_ns + self._back_off_ns
        self._back_off_ns = min(2 * self._back_off_ns, LONGEST_BACK_OFF_NS)
        self.listener.part_failed(self, error, self.has_given_up)

    def _restart(self, now_ns: int) -> None:
        self.component.stop()
        self.component.start(now_ns / NS)
        self._has_failed, self.resume_at_ns = False, 0
        self.listener.part_restarted(self)

    @property
    def state(self) -> str:
        """One word: running, stopped, restarting, failed."""
        if self.has_given_up:
            return "failed"
        if not self.is_running:
            return "stopped"
        return "restarting" if self._has_failed else "running"


Waker = Callable[[], None]
