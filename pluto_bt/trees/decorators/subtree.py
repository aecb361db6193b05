"""SubTree: another tree of the mission, with a scope of its own."""

from __future__ import annotations

from typing import Any

from pluto_bt.trees.engine.node import DecoratorNode
from pluto_bt.trees.engine.status import IDLE, RUNNING, Result


class SubTree(DecoratorNode):
    """Passes its child's answer unchanged. `tree_id` is the ID of the tree it stands for."""

    PASSES_ON = True
    KIND = "SubTree"

    def __init__(self, name: str = "", child: Any = None, tree_id: str = "") -> None:
        super().__init__(name, child)
        self.tree_id = tree_id

    def step(self) -> Result:
        if self.status is IDLE:
            self.status = RUNNING
            self.last = IDLE
        return self.pass_on()
