"""What all of Nav2's conditions have in common."""

from __future__ import annotations

from py_trees.common import Status

from pluto_bt.behaviours.leaf import Leaf
from pluto_bt.behaviours.robot import pose_of


class Nav2Condition(Leaf):
    """Answers at once."""

    KIND = "Condition"

    @property
    def is_fresh(self) -> bool:
        """True if a parent has reset this node since it was ticked last."""
        return self.status is Status.INVALID

    def answer(self, is_so: bool, text: str = "") -> Status:
        """SUCCESS or FAILURE."""
        self.feedback_message = text
        return Status.SUCCESS if is_so else Status.FAILURE

    def here(self) -> tuple[float, float, float] | None:
        """Where the robot is, if that is known."""
        return pose_of(self.robot) if self.robot is not None else None
