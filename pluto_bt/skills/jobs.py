"""The complex jobs of motion (42 to 45): what is ordered, as motion tells the executive, which runs the library tree of the job."""

from __future__ import annotations

from typing import Final, NamedTuple

from pluto_bt.blackboard.codes import MotionCommand
from pluto_bt.blackboard.messages import Pair
from pluto_bt.skills.rectangle import Rectangle

TREES: Final = {MotionCommand.MOVETO: "moveto", MotionCommand.INVESTIGATE: "investigate", MotionCommand.EXPLORE: "explore"}


class Job(NamedTuple):
    """One job.

    Attributes:
        number: counts the orders of a run; what the executive says of a job carries it.
        kind: 42, 43 or 44.
        place: the goal of a moveto, the home of an explore, in `Localization/Pose`.
        speed_mps, avoid: highest speed, and A of cmdFlags = 10*A + T.
        rectangle: what must not be left, in `Localization/Pose`; None = there is none.
        goes_on: True where a stopped job is taken up again.
    """

    number: int
    kind: MotionCommand
    place: Pair
    speed_mps: float
    avoid: int
    radius_m: float = 0.0
    turns: float = 1.0
    rectangle: Rectangle | None = None
    goes_on: bool = False

    @property
    def tree(self) -> str:
        """The ID of its tree in `pluto_bt/trees/library`."""
        return TREES[self.kind]

    @property
    def source(self) -> str:
        """As whom its tree posts to motion."""
        return f"job {self.number}"
