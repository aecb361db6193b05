"""What Sequence and Fallback share: one child after the other, the place kept between ticks."""

from __future__ import annotations

from typing import Any, ClassVar

from py_trees.common import Status

from pluto_bt.trees.engine.node import ControlNode
from pluto_bt.trees.engine.status import IDLE, RUNNING, Result


class InOrder(ControlNode):
    """Goes on to the next child after each that returns `GOES_ON`; the first that returns `DECIDES` decides. SKIPPED if all were skipped.

    A RUNNING child is ticked again in the next tick; those before it are not.
    """

    GOES_ON: ClassVar[Status]
    DECIDES: ClassVar[Status]
    YIELDS: ClassVar[bool] = False  # after a child that started and finished in one tick

    def __init__(self, name: str = "", children: list[Any] | None = None) -> None:
        super().__init__(name, children)
        self.index = 0
        self.skips = 0

    def step(self) -> Result:
        children = self.children
        if self.status is not RUNNING:
            self.status = RUNNING
            self.last = IDLE
            self.skips = 0
        count, goes_on, decides = len(children), self.GOES_ON, self.DECIDES
        while self.index < count:
            child = children[self.index]
            before = child.status
            result: Result = child.step()
            if result is goes_on:
                self.index += 1
                if self.YIELDS and before is IDLE and self.index < count:
                    self.context.wake_up()
                    return RUNNING
            elif result is RUNNING:
                return RUNNING
            elif result is decides:
                return self.decided()
            else:
                self.index += 1
                self.skips += 1
        all_skipped = self.skips == count
        self.reset_children()
        self.forget_place()
        if all_skipped:
            return self.skip()
        self.status = goes_on
        return goes_on

    def decided(self) -> Result:
        """One child decided for all: start from the first next time."""
        self.reset_children()
        self.forget_place()
        self.status = self.DECIDES
        return self.DECIDES

    def forget_place(self) -> None:
        """The next tick begins with the first child."""
        self.index = self.skips = 0

    def forget(self) -> None:
        self.forget_place()
