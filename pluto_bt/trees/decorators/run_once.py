"""RunOnce: the child is worked to its end once in the life of the mission."""

from __future__ import annotations

from typing import Any, ClassVar

from py_trees.common import Status

from pluto_bt.trees.engine.node import DecoratorNode, start
from pluto_bt.trees.engine.status import RUNNING, SKIPPED, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.values import BOOL


class RunOnce(DecoratorNode):
    """After the child's first end: SKIPPED for ever, or its answer again with `then_skip` false. A halt does not re-arm it."""

    PORTS: ClassVar = {"then_skip": PortModel("then_skip", kind=BOOL, default="true", description="afterwards skip (else repeat the answer)")}

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.answer: Status | None = None

    def step(self) -> Result:
        then_skip = self.read("then_skip")
        if self.answer is not None:
            if then_skip:
                return self.skip()
            self.status = self.answer
            return self.answer
        start(self)
        result = self.pass_on()
        if result is not SKIPPED and result is not RUNNING:
            self.answer = self.status
            self.feedback_message = f"done once: {self.answer.name}"
        return result
