"""Timeout, Delay: the clock decides. The clock is the mission's; a VirtualClock fires their timers inside `advance`."""

from __future__ import annotations

from typing import Any, ClassVar

from pluto_bt.trees.engine.context import Timer
from pluto_bt.trees.engine.node import DecoratorNode, reset, start
from pluto_bt.trees.engine.status import FAILURE, RUNNING, SKIPPED, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.values import UINT


class Timed(DecoratorNode):
    """A decorator with one timer, set when it is activated."""

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.started = False
        self.timer: Timer | None = None

    def forget(self) -> None:
        self.started = False
        if self.timer is not None:
            self.timer.cancel()
            self.timer = None


class Timeout(Timed):
    """Halts the running child when the time is over, at that very moment; the next tick then fails without ticking the child."""

    PORTS: ClassVar = {"msec": PortModel("msec", kind=UINT, unit="ms", description="time allowed; 0: no limit")}

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.expired = False

    def step(self) -> Result:
        limit_ms = self.read("msec")
        if not self.started:
            self.started = True
            self.expired = False
            start(self)
            if limit_ms > 0:
                self.timer = self.context.call_in(limit_ms / 1000, self._expire)
        if self.expired:
            self.started = False
            self.status = FAILURE
            return FAILURE
        result = self.pass_on()
        if result is not SKIPPED and result is not RUNNING:
            self.forget()
        return result

    def _expire(self) -> None:
        if self.child.status is RUNNING:
            self.expired = True
            self.feedback_message = "timeout"
            reset(self.child)
            self.context.wake_up()


class Delay(Timed):
    """RUNNING until the time is over, then the child; each activation waits again."""

    PORTS: ClassVar = {"delay_msec": PortModel("delay_msec", kind=UINT, unit="ms", description="how long to wait before the child")}

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.over = False

    def step(self) -> Result:
        delay_ms = self.read("delay_msec")
        if not self.started:
            self.started = True
            start(self)
            self.over = delay_ms == 0
            if not self.over:
                self.feedback_message = f"waits {delay_ms / 1000:g} s before its child"
                self.timer = self.context.call_in(delay_ms / 1000, self._wake)
        if not self.over:
            return RUNNING
        result = self.pass_on()
        if result is not SKIPPED and result is not RUNNING:
            self.started = False
        return result

    def _wake(self) -> None:
        self.over = True
        self.feedback_message = ""
        self.context.wake_up()
