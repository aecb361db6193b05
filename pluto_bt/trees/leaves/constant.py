"""AlwaysSuccess, AlwaysFailure."""

from __future__ import annotations

from pluto_bt.trees.engine.node import Node
from pluto_bt.trees.engine.status import FAILURE, SUCCESS, Result


class AlwaysSuccess(Node):
    """SUCCESS."""

    PORTS_ALONE = True

    def step(self) -> Result:
        self.status = SUCCESS
        return SUCCESS


class AlwaysFailure(Node):
    """FAILURE."""

    PORTS_ALONE = True

    def step(self) -> Result:
        self.status = FAILURE
        return FAILURE
