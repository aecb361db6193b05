"""RetryUntilSuccessful, Repeat: the child again, so many times; both yield between rounds that began and ended in one tick."""

from __future__ import annotations

from typing import Any, ClassVar

from py_trees.common import Status

from pluto_bt.trees.engine.node import DecoratorNode, reset, start
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.values import INT


class Again(DecoratorNode):
    """The child again after each `AGAIN`, as often as `LIMIT` says; any other end of the child is the end."""

    AGAIN: ClassVar[Status]
    LIMIT: ClassVar[str]  # the port with the number of rounds, -1: without limit

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.count = 0

    def step(self) -> Result:
        limit = self.read(self.LIMIT)
        start(self)
        while limit == -1 or self.count < limit:
            before = self.child.status
            result: Result = self.child.step()
            if result is RUNNING:
                return RUNNING
            reset(self.child)
            if result is SKIPPED:
                return self.skip()
            if result is not self.AGAIN:
                return self._ended(SUCCESS if result is SUCCESS else FAILURE)
            self.count += 1
            limit = self.limit_after(limit)
            if before is IDLE and (limit == -1 or self.count < limit):
                self.context.wake_up()
                return RUNNING
        return self._ended(self.AGAIN)

    def limit_after(self, limit: int) -> int:
        """The limit that holds after one more round."""
        return limit

    def _ended(self, status: Status) -> Result:
        self.count = 0
        self.status = status
        return status

    def forget(self) -> None:
        self.count = 0


class RetryUntilSuccessful(Again):
    """Again while the child fails, `num_attempts` times at most (-1: without limit)."""

    PORTS: ClassVar = {"num_attempts": PortModel("num_attempts", kind=INT, description="attempts; -1: without limit")}
    AGAIN, LIMIT = FAILURE, "num_attempts"

    def limit_after(self, limit: int) -> int:
        """A child may have changed it."""
        return int(self.read(self.LIMIT))


class Repeat(Again):
    """Again while the child succeeds, `num_cycles` times (-1: without end)."""

    PORTS: ClassVar = {"num_cycles": PortModel("num_cycles", kind=INT, description="rounds; -1: without end")}
    AGAIN, LIMIT = SUCCESS, "num_cycles"
