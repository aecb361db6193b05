"""IfThenElse, WhileDoElse: the first child decides which of the others works."""

from __future__ import annotations

from typing import Any

from pluto_bt.trees.engine.node import ControlNode, reset, start
from pluto_bt.trees.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS, Result


class IfThenElse(ControlNode):
    """The condition decides once, then its branch works to the end. Without a third child a false condition is FAILURE."""

    CHILDREN = (2, 3)

    def __init__(self, name: str = "", children: list[Any] | None = None) -> None:
        super().__init__(name, children)
        self.branch = 0

    def step(self) -> Result:
        check_branches(self)
        start(self)
        if self.branch == 0:
            result: Result = self.children[0].step()
            if result is RUNNING:
                return RUNNING
            if result is SKIPPED:
                self.fail("the condition (first child) was skipped")
            if result is FAILURE and len(self.children) == 2:
                self.status = FAILURE
                return FAILURE
            self.branch = 1 if result is SUCCESS else 2
        result = self.children[self.branch].step()
        return RUNNING if result is RUNNING else close(self, result)

    def forget(self) -> None:
        self.branch = 0


class WhileDoElse(ControlNode):
    """The condition is asked in every tick: while it is true the second child works, else the third (or FAILURE)."""

    CHILDREN = (2, 3)

    def step(self) -> Result:
        check_branches(self)
        start(self)
        result: Result = self.children[0].step()
        if result is RUNNING:
            return RUNNING
        if result is SKIPPED:
            self.fail("the condition (first child) was skipped")
        if len(self.children) == 2:
            if result is FAILURE:
                return close(self, FAILURE)
            branch = 1
        else:
            branch = 1 if result is SUCCESS else 2
            reset(self.children[3 - branch])
        result = self.children[branch].step()
        return RUNNING if result is RUNNING else close(self, result)


def check_branches(node: ControlNode) -> None:
    """The number of children is only looked at while ticking, as in BehaviorTree.CPP."""
    if not 2 <= len(node.children) <= 3:
        node.fail(f"{type(node).__name__} needs 2 or 3 children, it has {len(node.children)}")


def close(node: ControlNode, result: Result) -> Result:
    """End with `result`, all children reset."""
    node.reset_children()
    node.forget()
    if result is SKIPPED:
        return node.skip()
    node.status = SUCCESS if result is SUCCESS else FAILURE
    return result
