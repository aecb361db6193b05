"""Parallel, ParallelAll: all unfinished children in every tick."""

from __future__ import annotations

from typing import Any, ClassVar

from pluto_bt.trees.engine.node import ControlNode, start
from pluto_bt.trees.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.values import INT


class Parallel(ControlNode):
    """Ends as soon as enough children have succeeded or failed; children after the deciding one are not ticked any more.

    A negative count n means N + n + 1 of N children, so -1 means all.
    """

    PORTS: ClassVar = {
        "success_count": PortModel("success_count", kind=INT, default="-1", description="successes needed; negative: counted from all"),
        "failure_count": PortModel("failure_count", kind=INT, default="1", description="failures that end it; negative: counted from all"),
    }

    def __init__(self, name: str = "", children: list[Any] | None = None) -> None:
        super().__init__(name, children)
        self.done: set[int] = set()
        self.successes = 0
        self.failures = 0

    def step(self) -> Result:
        count = len(self.children)
        asked: int = self.read("success_count")
        needed = absolute_count(asked, count)
        limit = absolute_count(self.read("failure_count"), count)
        if count < needed:
            self.fail(f"success_count {needed} is more than the {count} children; it can never succeed")
        if count < limit:
            self.fail(f"failure_count {limit} is more than the {count} children; it can never fail")
        start(self)
        skips = 0
        for i, child in enumerate(self.children):
            if i not in self.done:
                result: Result = child.step()
                if result is SKIPPED:
                    skips += 1
                elif result is not RUNNING:
                    self._count(i, result)
            if self.successes >= needed or (asked < 0 and self.successes + skips >= needed):
                return self._finished(SUCCESS)
            if count - self.failures < needed or self.failures == limit:
                return self._finished(FAILURE)
        return self.skip() if skips == count else RUNNING

    def _count(self, i: int, result: Result) -> None:
        self.done.add(i)
        if result is SUCCESS:
            self.successes += 1
        else:
            self.failures += 1

    def _finished(self, result: Result) -> Result:
        self.forget()
        self.reset_children()
        self.status = SUCCESS if result is SUCCESS else FAILURE
        return result

    def forget(self) -> None:
        self.done.clear()
        self.successes = self.failures = 0


class ParallelAll(ControlNode):
    """Waits for all children; FAILURE if `max_failures` or more of them failed."""

    PORTS: ClassVar = {"max_failures": PortModel("max_failures", kind=INT, default="1", description="so many failures make the node fail")}

    def __init__(self, name: str = "", children: list[Any] | None = None) -> None:
        super().__init__(name, children)
        self.done: set[int] = set()
        self.failures = 0

    def step(self) -> Result:
        count = len(self.children)
        limit = absolute_count(self.read("max_failures"), count)
        if count < limit:
            self.fail(f"max_failures {limit} is more than the {count} children; it can never fail")
        start(self)
        skips = 0
        for i, child in enumerate(self.children):
            if i in self.done:
                continue
            result: Result = child.step()
            if result is SKIPPED:
                skips += 1
            elif result is not RUNNING:
                self.done.add(i)
                self.failures += result is FAILURE
        if skips == count:
            return self.skip()
        if skips + len(self.done) < count:
            return RUNNING
        failed = self.failures >= limit
        self.reset_children()
        self.forget()
        self.status = FAILURE if failed else SUCCESS
        return self.status

    def forget(self) -> None:
        self.done.clear()
        self.failures = 0


def absolute_count(count: int, n_children: int) -> int:
    """The count that a negative one stands for: -1 means all, never below 0."""
    return count if count >= 0 else max(n_children + count + 1, 0)
