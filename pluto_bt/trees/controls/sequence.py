"""Sequence, AsyncSequence, SequenceWithMemory: one child after the other while they succeed; the place is kept between ticks."""

from __future__ import annotations

from typing import Any, ClassVar

from pluto_bt.trees.engine.node import ControlNode, reset
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SUCCESS, Result


class Sequence(ControlNode):
    """SUCCESS when all children succeeded, FAILURE with the first that fails; SKIPPED if all were skipped.

    A RUNNING child is ticked again in the next tick; those before it are not.
    """

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
            if result is SUCCESS:
                self.index += 1
                if self.YIELDS and before is IDLE and self.index < count:
                    self.context.wake_up()
                    return RUNNING
            elif result is RUNNING:
                return RUNNING
            elif result is FAILURE:
                return self.failed()
            else:
                self.index += 1
                self.skips += 1
        all_skipped = self.skips == count
        self.reset_children()
        self.index = self.skips = 0
        if all_skipped:
            return self.skip()
        self.status = SUCCESS
        return SUCCESS

    def failed(self) -> Result:
        """Start from the first child next time."""
        self.reset_children()
        self.index = 0
        self.status = FAILURE
        return FAILURE

    def forget(self) -> None:
        self.index = self.skips = 0


class AsyncSequence(Sequence):
    """A Sequence that can be interrupted between children: it yields after each that started and finished in one tick."""

    YIELDS = True


class SequenceWithMemory(Sequence):
    """A Sequence that remembers its place through failures and halts: children that succeeded are not ticked again. It yields."""

    YIELDS = True

    def failed(self) -> Result:
        for child in self.children[self.index :]:
            reset(child)
        self.status = FAILURE
        return FAILURE

    def forget(self) -> None:
        """The place survives a halt."""
