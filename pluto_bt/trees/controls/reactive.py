"""ReactiveSequence, ReactiveFallback: every tick begins with the first child again; a RUNNING child silences all others."""

from __future__ import annotations

from typing import ClassVar

from py_trees.common import Status

from pluto_bt.trees.engine.node import ControlNode, reset
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SUCCESS, Result


class Reactive(ControlNode):
    """Goes on to the next child after each that returns `GOES_ON`; the first that returns `DECIDES` decides. SKIPPED if all were skipped."""

    GOES_ON: ClassVar[Status]
    DECIDES: ClassVar[Status]

    def step(self) -> Result:
        if self.status is not RUNNING:
            self.status = RUNNING
            self.last = IDLE
        goes_on, skips = self.GOES_ON, 0
        for child in self.children:
            result: Result = child.step()
            if result is goes_on:
                continue
            if result is RUNNING:
                _silence_others(self, child)
                return RUNNING
            if result is self.DECIDES:
                return self._ended(self.DECIDES)
            skips += 1
            reset(child)  # so that it can be skipped again
        if skips == len(self.children):
            self.reset_children()
            return self.skip()
        return self._ended(goes_on) if skips else self._all_went_on()

    def _all_went_on(self) -> Result:
        """As `_ended`, but it is known what stands in the children: this is where a tick spends its time."""
        goes_on = self.status = self.GOES_ON
        for child in self.children:
            child.last = goes_on
            child.status = IDLE
        return goes_on

    def _ended(self, status: Status) -> Result:
        self.reset_children()
        self.status = status
        return status


class ReactiveSequence(Reactive):
    """Conditions first, then the work: the conditions are asked again in every tick while the work is RUNNING."""

    PASSES_ON = True
    GOES_ON, DECIDES = SUCCESS, FAILURE


class ReactiveFallback(Reactive):
    """Better plans first: each tick tries them again, and the plan that was RUNNING is halted when a better one runs."""

    PASSES_ON = True
    GOES_ON, DECIDES = FAILURE, SUCCESS


def _silence_others(node: ControlNode, running: object) -> None:
    for child in node.children:
        if child is not running and child.status is not IDLE:
            reset(child)
