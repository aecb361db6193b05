"""TryCatch: a sequence with a last child that cleans up when the sequence fails."""

from __future__ import annotations

from typing import Any, ClassVar

from pluto_bt.trees.engine.node import ControlNode, reset
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.values import BOOL


class TryCatch(ControlNode):
    """The children but the last are a Sequence; if one fails, the last is worked to its end and the node fails.

    With `catch_on_halt` the last child is also ticked once when the sequence is interrupted.
    """

    CHILDREN = (2, None)
    PORTS: ClassVar = {"catch_on_halt": PortModel("catch_on_halt", kind=BOOL, default="false", description="clean up also when halted")}

    def __init__(self, name: str = "", children: list[Any] | None = None) -> None:
        super().__init__(name, children)
        self.index = 0
        self.skips = 0
        self.catching = False

    def step(self) -> Result:
        if self.status is not RUNNING:
            self.status = RUNNING
            self.last = IDLE
            self.skips = 0
            self.catching = False
        if self.catching:
            return self._clean_up()
        tries = self.children[:-1]
        while self.index < len(tries):
            result: Result = tries[self.index].step()
            if result is RUNNING:
                return RUNNING
            if result is FAILURE:
                self.reset_children()
                self.index = 0
                self.catching = True
                return self._clean_up()
            self.index += 1
            self.skips += result is SKIPPED
        all_skipped = self.skips == len(tries)
        self.reset_children()
        self.forget()
        if all_skipped:
            return self.skip()
        self.status = SUCCESS
        return SUCCESS

    def _clean_up(self) -> Result:
        result: Result = self.children[-1].step()
        if result is RUNNING:
            return RUNNING
        self.reset_children()
        self.index = 0
        self.catching = False
        self.status = FAILURE
        return FAILURE

    def halt(self) -> None:
        if self.status is RUNNING and not self.catching and self.read("catch_on_halt"):
            for child in self.children[:-1]:
                reset(child)
            if self.children[-1].step() is RUNNING:
                reset(self.children[-1])
        super().halt()

    def forget(self) -> None:
        self.index = self.skips = 0
        self.catching = False
