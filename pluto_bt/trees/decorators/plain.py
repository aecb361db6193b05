"""Inverter, ForceSuccess, ForceFailure, KeepRunningUntilFailure: another answer for the child's."""

from __future__ import annotations

from typing import ClassVar

from py_trees.common import Status

from pluto_bt.trees.engine.node import DecoratorNode, reset
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result


class Mapping(DecoratorNode):
    """Answers `FOR_SUCCESS` or `FOR_FAILURE` when its child ends; RUNNING and SKIPPED pass."""

    FOR_SUCCESS: ClassVar[Status]
    FOR_FAILURE: ClassVar[Status]

    def step(self) -> Result:
        if self.status is not RUNNING:
            self.status = RUNNING
            self.last = IDLE
        result: Result = self.child.step()
        if result is SKIPPED:
            return self.skip()
        if result is not RUNNING:
            reset(self.child)
            self.status = self.FOR_SUCCESS if result is SUCCESS else self.FOR_FAILURE
            return self.status
        return result


class Inverter(Mapping):
    """SUCCESS becomes FAILURE and FAILURE becomes SUCCESS."""

    PASSES_ON = True
    FOR_SUCCESS, FOR_FAILURE = FAILURE, SUCCESS


class ForceSuccess(Mapping):
    """A child that ends has succeeded."""

    PASSES_ON = True
    FOR_SUCCESS = FOR_FAILURE = SUCCESS


class ForceFailure(Mapping):
    """A child that ends has failed."""

    PASSES_ON = True
    FOR_SUCCESS = FOR_FAILURE = FAILURE


class KeepRunningUntilFailure(DecoratorNode):
    """RUNNING until the child fails; a child that succeeds begins again in the next tick."""

    def step(self) -> Result:
        if self.status is not RUNNING:
            self.status = RUNNING
            self.last = IDLE
        result: Result = self.child.step()
        if result is FAILURE:
            reset(self.child)
            self.status = FAILURE
            return FAILURE
        if result is SUCCESS:
            reset(self.child)
        return RUNNING
