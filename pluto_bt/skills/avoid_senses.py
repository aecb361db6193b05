"""What avoidance is told at each step."""

from __future__ import annotations

from typing import NamedTuple

from pluto_bt.blackboard.messages import SonarState
from pluto_bt.skills import reasons
from pluto_bt.skills.limits import STILL, Twist
from pluto_bt.skills.outline import Planar
from pluto_bt.skills.sight import ScanView
from pluto_bt.skills.verdict import Verdict


class AvoidSenses(NamedTuple):
    """What avoidance knows at a step; None = missing or too old. Poses are x m, y m, theta rad.

    `pose` is interface 3, `dead` interface 0, `raw_heading_rad` that of ATRV2/Drive/Raw, `twist` the velocities in force,
    `waits_for_walker`: the stop filter holds the robot back because of somebody, or did so just now,
    `wheels_stand`: it lets them rest, for they are told to turn and do not; `no_pose`: why there is no `pose`.
    """

    pose: Planar | None
    dead: Planar | None
    raw_heading_rad: float | None
    twist: Twist = STILL
    view: ScanView | None = None
    sonar: SonarState | None = None
    waits_for_walker: bool = False
    wheels_stand: bool = False
    no_pose: Verdict = Verdict(reason=reasons.NO_POSE, text="waits until it is known where the robot is")
