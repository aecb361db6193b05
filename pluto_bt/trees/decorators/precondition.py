"""Precondition: a script decides whether the child is begun."""

from __future__ import annotations

from typing import Any, ClassVar

from pluto_bt.trees.engine.node import DecoratorNode, reset, start
from pluto_bt.trees.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.script import ScriptRunner
from pluto_bt.trees.values import SCRIPT, STATUS


class Precondition(DecoratorNode):
    """Asks `if` before the child begins, not while it is RUNNING; when false the answer is `else`."""

    PORTS: ClassVar = {
        "if": PortModel("if", kind=SCRIPT, at_load=True, description="the condition"),
        "else": PortModel("else", kind=STATUS, default="FAILURE", description="the answer when it is false"),
    }

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.working = False
        self.script: ScriptRunner | None = None  # set by the loader

    def step(self) -> Result:
        otherwise: Result = self.read("else")
        if not self.working:
            if self.script is None:
                self.fail("port 'if' is missing")
            self.working = self.script.is_true(self)
            self.feedback_message = "waits for its condition" if otherwise is RUNNING and not self.working else ""
            if not self.working:
                return self.end_as(otherwise, "else")
        result: Result = self.child.step()
        if result is SKIPPED:
            return self.skip()
        if result is RUNNING:
            start(self)
            return RUNNING
        reset(self.child)
        self.working = False
        self.status = SUCCESS if result is SUCCESS else FAILURE
        return result
