"""Script, ScriptCondition."""

from __future__ import annotations

from typing import ClassVar

from pluto_bt.trees.engine.node import Node
from pluto_bt.trees.engine.status import FAILURE, SUCCESS, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.script import ScriptRunner
from pluto_bt.trees.values import SCRIPT


class Script(Node):
    """Runs `code`; SUCCESS."""

    PORTS: ClassVar = {"code": PortModel("code", kind=SCRIPT, at_load=True, description="the statements")}

    def __init__(self, name: str = "") -> None:
        super().__init__(name)
        self.script: ScriptRunner | None = None  # set by the loader

    def step(self) -> Result:
        if self.script is None:
            self.fail("port 'code' is missing")
        self.script.run(self)
        self.status = SUCCESS
        return SUCCESS


class ScriptCondition(Node):
    """SUCCESS if `code` is true, else FAILURE."""

    KIND = "Condition"
    PORTS: ClassVar = {"code": PortModel("code", kind=SCRIPT, at_load=True, description="the condition")}

    def __init__(self, name: str = "") -> None:
        super().__init__(name)
        self.script: ScriptRunner | None = None  # set by the loader

    def step(self) -> Result:
        if self.script is None:
            self.fail("port 'code' is missing")
        self.status = SUCCESS if self.script.is_true(self) else FAILURE
        return self.status
