"""RetryUntilSuccessful, Repeat: the child again, so many times; both yield between rounds that began and ended in one tick."""

from __future__ import annotations

from typing import Any, ClassVar

from pluto_bt.trees.engine.node import DecoratorNode, reset, start
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.values import INT


class RetryUntilSuccessful(DecoratorNode):
    """Again while the child fails, `num_attempts` times at most (-1: without limit)."""

    PORTS: ClassVar = {"num_attempts": PortModel("num_attempts", kind=INT, description="attempts; -1: without limit")}

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.count = 0

    def step(self) -> Result:
        limit = self.read("num_attempts")
        start(self)
        while limit == -1 or self.count < limit:
            before = self.child.status
            result: Result = self.child.step()
            if result is RUNNING:
                return RUNNING
            reset(self.child)
            if result is SKIPPED:
                return self.skip()
            if result is SUCCESS:
                return self._finished(SUCCESS)
            self.count += 1
            limit = self.read("num_attempts")  # a child may have changed it
            if before is IDLE and (limit == -1 or self.count < limit):
                self.context.wake_up()
                return RUNNING
        return self._finished(FAILURE)

    def _finished(self, result: Result) -> Result:
        self.count = 0
        self.status = SUCCESS if result is SUCCESS else FAILURE
        return result

    def forget(self) -> None:
        self.count = 0


class Repeat(DecoratorNode):
    """Again while the child succeeds, `num_cycles` times (-1: without end)."""

    PORTS: ClassVar = {"num_cycles": PortModel("num_cycles", kind=INT, description="rounds; -1: without end")}

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.count = 0

    def step(self) -> Result:
        limit = self.read("num_cycles")
        start(self)
        while limit == -1 or self.count < limit:
            before = self.child.status
            result: Result = self.child.step()
            if result is RUNNING:
                return RUNNING
            reset(self.child)
            if result is SKIPPED:
                return self.skip()
            if result is FAILURE:
                return self._finished(FAILURE)
            self.count += 1
            if before is IDLE and (limit == -1 or self.count < limit):
                self.context.wake_up()
                return RUNNING
        return self._finished(SUCCESS)

    def _finished(self, result: Result) -> Result:
        self.count = 0
        self.status = SUCCESS if result is SUCCESS else FAILURE
        return result

    def forget(self) -> None:
        self.count = 0
