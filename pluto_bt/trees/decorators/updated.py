"""SkipUnlessUpdated, WaitValueUpdate: the child only when an entry has been written since the last look."""

from __future__ import annotations

from typing import Any, ClassVar

from pluto_bt.trees.engine.node import DecoratorNode
from pluto_bt.trees.engine.status import RUNNING, SKIPPED, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.scopes import Scope


class UpdateWatch:
    """Whether an entry was written since the last look; the first look at a written entry counts, a missing one never does."""

    def __init__(self, scope: Scope, key: str) -> None:
        self.scope, self.key = scope, key
        self.seen = 0

    def is_updated(self) -> bool:
        """Look once."""
        entry = self.scope.find(self.key)
        if entry is None:
            return False
        before, self.seen = self.seen, entry.seq
        return before != self.seen


class EntryUpdated(DecoratorNode):
    """A child that is RUNNING is continued without looking.

    A child that has ended is left as it ended, as BehaviorTree.CPP 4.10 leaves it (`EntryUpdatedDecorator::tick`): nobody makes it IDLE again, so
    its pre-conditions are asked once, and a Sleep that has passed does not wait anew.
    """

    PORTS: ClassVar = {"entry": PortModel("entry", at_load=True, description="the entry to watch")}
    OTHERWISE: ClassVar[Result] = SKIPPED

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.working = False
        self.watch: UpdateWatch | None = None  # set by the loader

    def step(self) -> Result:
        if not self.working and not (self.watch is not None and self.watch.is_updated()):
            if self.OTHERWISE is SKIPPED:
                return self.skip()
            self.status = RUNNING
            self.feedback_message = "waits for a new value" if self.watch is None else f"waits for a new value of {self.watch.key}"
            return RUNNING
        self.feedback_message = ""
        result: Result = self.child.step()
        self.working = result is RUNNING
        if result is SKIPPED:
            return self.skip()
        self.status = result
        return result

    def forget(self) -> None:
        self.working = False


class SkipUnlessUpdated(EntryUpdated):
    """SKIPPED while the entry has not been written since the last look."""


class WaitValueUpdate(EntryUpdated):
    """RUNNING while the entry has not been written since the last look."""

    OTHERWISE = RUNNING
