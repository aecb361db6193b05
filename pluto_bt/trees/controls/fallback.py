"""Fallback, AsyncFallback: one child after the other until one succeeds; the place is kept between ticks."""

from __future__ import annotations

from typing import Any, ClassVar

from pluto_bt.trees.engine.node import ControlNode
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SUCCESS, Result


class Fallback(ControlNode):
    """SUCCESS with the first child that succeeds, FAILURE when all have failed; SKIPPED if all were skipped."""

    YIELDS: ClassVar[bool] = False

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
        count = len(children)
        while self.index < count:
            child = children[self.index]
            before = child.status
            result: Result = child.step()
            if result is FAILURE:
                self.index += 1
                if self.YIELDS and before is IDLE and self.index < count:
                    self.context.wake_up()
                    return RUNNING
            elif result is RUNNING:
                return RUNNING
            elif result is SUCCESS:
                return self.finished(SUCCESS)
            else:
                self.index += 1
                self.skips += 1
        if self.skips < count:
            return self.finished(FAILURE)
        self.reset_children()
        self.index = self.skips = 0
        return self.skip()

    def finished(self, result: Result) -> Result:
        """Start from the first child next time."""
        self.reset_children()
        self.index = self.skips = 0
        self.status = SUCCESS if result is SUCCESS else FAILURE
        return result

    def forget(self) -> None:
        self.index = self.skips = 0


class AsyncFallback(Fallback):
    """A Fallback that can be interrupted between children: it yields after each that started and failed in one tick."""

    YIELDS = True
