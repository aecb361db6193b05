"""Sleep: wait on the mission's clock."""

from __future__ import annotations

from typing import ClassVar

from pluto_bt.trees.engine.context import Timer
from pluto_bt.trees.engine.node import Node
from pluto_bt.trees.engine.status import IDLE, RUNNING, SUCCESS, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.values import UINT


class Sleep(Node):
    """RUNNING until the time is over, then SUCCESS; with 0 at once. Asks for a tick when the time is over."""

    PORTS: ClassVar = {"msec": PortModel("msec", kind=UINT, unit="ms", description="how long")}

    def __init__(self, name: str = "") -> None:
        super().__init__(name)
        self.waiting = False
        self.timer: Timer | None = None

    def step(self) -> Result:
        if self.status is IDLE:
            wait_ms = self.read("msec")
            if wait_ms == 0:
                self.status = SUCCESS
                return SUCCESS
            self.waiting = True
            self.status = RUNNING
            self.timer = self.context.call_in(wait_ms / 1000, self._wake)
            return RUNNING
        if self.status is RUNNING and not self.waiting:
            self.status = SUCCESS
        return self.status

    def _wake(self) -> None:
        self.waiting = False
        self.context.wake_up()

    def halt(self) -> None:
        self.waiting = False
        if self.timer is not None:
            self.timer.cancel()
            self.timer = None
        self.status = IDLE
