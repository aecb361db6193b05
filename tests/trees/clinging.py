"""A leaf that does not let go."""

from __future__ import annotations

from typing import ClassVar

from py_trees.common import Status
from py_trees.ports import BehaviourWithPorts, PortInformation


class Clings(BehaviourWithPorts, tag="Clings"):
    """Works for ever, and raises when it is told to let go."""

    INPUT_PORTS: ClassVar[dict[str, PortInformation]] = {}
    OUTPUT_PORTS: ClassVar[dict[str, PortInformation]] = {}

    def update(self) -> Status:
        return Status.RUNNING

    def terminate(self, new_status: Status) -> None:
        raise RuntimeError("it does not open")
