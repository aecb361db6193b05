"""PipelineSequence, NonblockingSequence, PersistentSequence: Nav2's ways to work through children."""

from __future__ import annotations

from typing import Any, ClassVar

from pluto_bt.trees.controls.branch import close
from pluto_bt.trees.engine.node import ControlNode, start
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.scopes import MissingValue
from pluto_bt.trees.values import INT


class PipelineSequence(ControlNode):
    """Ticks from the first child in every tick, as far as the furthest one so far that was RUNNING; FAILURE of any ends it, SUCCESS of the last.

    Children that finished are not reset between ticks: they are ticked again as they are.
    """

    def __init__(self, name: str = "", children: list[Any] | None = None) -> None:
        super().__init__(name, children)
        self.furthest = 0

    def step(self) -> Result:
        skips = 0
        for i, child in enumerate(self.children):
            result: Result = child.step()
            if result is FAILURE:
                return close(self, FAILURE)
            if result is RUNNING and i >= self.furthest:
                self.furthest = i
                start(self)
                return RUNNING
            skips += result is SKIPPED
        return close(self, SKIPPED if skips == len(self.children) else SUCCESS)

    def forget(self) -> None:
        self.furthest = 0


class NonblockingSequence(ControlNode):
    """Ticks every child in every tick; SUCCESS if all succeed in one and the same tick, FAILURE with the first that fails."""

    def step(self) -> Result:
        all_succeeded = True
        for child in self.children:
            result: Result = child.step()
            if result is FAILURE:
                return close(self, FAILURE)
            if result is SKIPPED:
                self.fail(f"child {child.name!r} was skipped, which <NonblockingSequence> does not allow")
            all_succeeded = all_succeeded and result is SUCCESS
        if all_succeeded:
            return close(self, SUCCESS)
        start(self)
        return RUNNING


class PersistentSequence(ControlNode):
    """A Sequence whose place stands on the blackboard, so that it survives halts and can be set; a skipped child counts as done."""

    PORTS: ClassVar = {
        "current_child_idx": PortModel("current_child_idx", "inout", INT, required=False, description="the child to go on with; 0 = the first")
    }

    def __init__(self, name: str = "", children: list[Any] | None = None) -> None:
        super().__init__(name, children)
        self.index = 0

    def step(self) -> Result:
        self.index = self._place()
        start(self)
        while self.index < len(self.children):
            result: Result = self.children[self.index].step()
            if result is RUNNING:
                return RUNNING
            if result is FAILURE:
                return self._ended(FAILURE)
            self._go_to(self.index + 1)
        return self._ended(SUCCESS)

    def _place(self) -> int:
        """The index on the blackboard, or the own one where the port leads nowhere or nothing has been written yet."""
        reader = self.readers.get("current_child_idx")
        try:
            index: int = self.index if reader is None else reader()
        except MissingValue:
            return self.index
        if index < 0:
            self.fail(f"current_child_idx is {index}, below 0")
        return index

    def _go_to(self, index: int) -> None:
        self.index = index
        self.write("current_child_idx", index)

    def _ended(self, result: Result) -> Result:
        self._go_to(0)
        return close(self, result)

    def halt(self) -> None:
        """The place stays."""
        self.reset_children()
        self.status = IDLE
