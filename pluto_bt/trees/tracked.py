"""A node with what the mission knows of it: its plan, and since when it is in its status."""

from __future__ import annotations

from typing import Any

from pluto_bt.blackboard.messages import NodeState
from pluto_bt.trees.engine.status import IDLE, SKIPPED, Result, name_of
from pluto_bt.trees.loader.expand import Plan


def letter_of(node: Any) -> str:
    """The stored status of a node as one letter: I (py_trees' INVALID, which we call idle) R S F."""
    letter: str = node.status._name_[0]
    return letter


class Tracked:
    """One node of a mission."""

    __slots__ = ("node", "path", "plan", "shown", "since_s")

    def __init__(self, node: Any, plan: Plan) -> None:
        self.node, self.plan, self.path = node, plan, plan.path
        self.shown = "IDLE"
        self.since_s = 0.0

    def status(self, skipped: set[int]) -> str:
        """The status now; SKIPPED for those that were skipped in the last tick."""
        result: Result = SKIPPED if id(self.node) in skipped else self.node.status
        return name_of(result)

    def letter(self, skipped: set[int]) -> str:
        """The status now as one letter."""
        return "K" if id(self.node) in skipped else letter_of(self.node)

    def last(self, skipped: set[int]) -> str:
        """What the node told its parent last; IDLE if it was never ticked."""
        node = self.node
        result: Result = SKIPPED if id(node) in skipped else node.status if node.status is not IDLE else node.last
        return name_of(result)

    def state(self, status: str, now_s: float) -> NodeState:
        """The line of this node. `since_s` is when a look first found it in this status."""
        if status != self.shown:
            self.shown, self.since_s = status, now_s
        plan = self.plan
        return NodeState(self.path, plan.type_name, plan.name, plan.depth, status, self.node.feedback_message, self.since_s)
