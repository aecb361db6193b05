"""ReactiveSequence, ReactiveFallback: every tick begins with the first child again; a RUNNING child silences all others."""

from __future__ import annotations

from pluto_bt.trees.engine.node import ControlNode, reset
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result


class ReactiveSequence(ControlNode):
    """Conditions first, then the work: the conditions are asked again in every tick while the work is RUNNING."""

    def step(self) -> Result:
        if self.status is not RUNNING:
            self.status = RUNNING
            self.last = IDLE
        all_skipped = True
        for child in self.children:
            result: Result = child.step()
            if result is SUCCESS:
                all_skipped = False
            elif result is RUNNING:
                _silence_others(self, child)
                return RUNNING
            elif result is FAILURE:
                self.reset_children()
                self.status = FAILURE
                return FAILURE
            elif result is SKIPPED:
                reset(child)  # so that it can be skipped again
        self.reset_children()
        if all_skipped:
            return self.skip()
        self.status = SUCCESS
        return SUCCESS


class ReactiveFallback(ControlNode):
    """Better plans first: each tick tries them again, and the plan that was RUNNING is halted when a better one runs."""

    def step(self) -> Result:
        if self.status is not RUNNING:
            self.status = RUNNING
            self.last = IDLE
        all_skipped = True
        for child in self.children:
            result: Result = child.step()
            if result is FAILURE:
                all_skipped = False
            elif result is RUNNING:
                _silence_others(self, child)
                return RUNNING
            elif result is SUCCESS:
                self.reset_children()
                self.status = SUCCESS
                return SUCCESS
            elif result is SKIPPED:
                reset(child)  # so that it can be skipped again
        self.reset_children()
        if all_skipped:
            return self.skip()
        self.status = FAILURE
        return FAILURE


def _silence_others(node: ControlNode, running: object) -> None:
    for child in node.children:
        if child is not running and child.status is not IDLE:
            reset(child)
