"""The robot as a leaf sees it: give a command, watch its status, read topics. `pluto_bt.modules.robot_link` implements it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from pluto_bt.blackboard.codes import MotionStatus, MovetoStatus
from pluto_bt.blackboard.messages import ActuatorState, FloatArray, FVectorState, Message, Pair, Pose
from pluto_bt.maps.platform import Platform
from pluto_bt.maps.world import World
from pluto_bt.skills import reasons
from pluto_bt.skills.sight import ScanView

NO_DOUBT = FVectorState(0.0)
NO_POINTS = np.zeros((0, 2))

if TYPE_CHECKING:
    from pluto_bt.behaviours.navigation import Navigation
    from pluto_bt.behaviours.surroundings import Surroundings


@dataclass(frozen=True, slots=True)
class Ticket:
    """A command that was posted; `refused` is "" or the code of the refusal (`wrong-state`)."""

    command: ActuatorState
    refused: str = ""


class Robot(Protocol):
    """One robot. What it says of topics is that of the snapshot of this tick, so it is consistent."""

    @property
    def platform(self) -> Platform:
        """The platform file."""

    @property
    def map(self) -> World | None:
        """The a-priori map."""

    @property
    def resumes(self) -> int:
        """How often the mission has gone on after a pause; a motion leaf that sees it grow commands again."""

    @property
    def surroundings(self) -> Surroundings:
        """The local map and what belongs to it."""

    @property
    def navigation(self) -> Navigation:
        """Planning on the map, and what was seen in the way."""

    def scan_views(self) -> Sequence[ScanView]:
        """The laser scans that came since the last call, oldest first, each with the place it was taken from (dead reckoning)."""

    def command(
        self,
        flags: int,
        position: Pair = (0.0, 0.0),
        velocity: Pair = (0.0, 0.0),
        tolerance_m: float = 0.0,
        force: float | tuple[float, ...] = 1.0,
        *,
        on_the_way: bool = False,
    ) -> Ticket:
        """Post a command to motion; within one tick the newest wins.

        Args:
            tolerance_m: 0 = avoidance's own.
            on_the_way: the position is a point on the way to a goal, not one itself; pictures leave it out.
        """

    def status(self, ticket: Ticket) -> FVectorState | None:
        """`motion/status`, but only while motion works on exactly this command; None before and after."""

    def newest(self, topic: str) -> Message | None:
        """The newest value, or None if nobody has written yet."""

    def age_s(self, topic: str) -> float:
        """Seconds since the value was true; infinite without a value."""

    def is_stale(self, topic: str) -> bool:
        """True if the value is missing or older than the table of topics allows."""

    def point_wrist(self, pan_rad: float, tilt_rad: float, rate_radps: float, acceleration_radps2: float) -> None:
        """Point the laser."""

    def move_arm(self, share: float) -> None:
        """Unfold the arm: 0 = folded, 1 = unfolded."""

    def show_phase(self, moveto: MovetoStatus | None, motion: MotionStatus | None) -> None:
        """What a job of motion shows in `element[2..3]`; None = as it is."""

    def post_pose(self, x_m: float, y_m: float, theta_rad: float) -> Pose | None:
        """Tell localisation where the robot stands on the map; what was posted, None if another module keeps the pose."""

    def show_path(self, points: FloatArray) -> None:
        """The path (n, 2) of the map that is followed from now on, for who looks on; one point = a goal without a planned way, none = no more."""

    def read_alarms(self) -> None:
        """Take back the alarms of `imu/alarms` that stay until they are read."""

    def order_module(self, name: str, run: bool) -> bool:
        """Start a module, after all that it needs, or stop it; False if there is none of that name. `modules` tells what became of it."""

    def say(self, text: str) -> None:
        """A line for operators."""

    def stop(self) -> None:
        """Zero velocity at once; beats every command that waits."""


def pose_doubt(robot: Robot) -> FVectorState:
    """Why the pose must not be believed: `reason` is one of `PLACELESS`, or "" if nothing speaks against it."""
    check = robot.newest("Localization/Check")
    return check if isinstance(check, FVectorState) and check.reason in reasons.PLACELESS else NO_DOUBT


def why_no_pose(robot: Robot) -> tuple[str, str]:
    """Word and sentence for a leaf that has no pose to go by: the word of what speaks against it (`PLACELESS`), else `no-pose`."""
    doubt = pose_doubt(robot)
    return doubt.reason or reasons.NO_POSE, doubt.text or "it is not known where the robot is"


def pose_of(robot: Robot) -> tuple[float, float, float] | None:
    """(x m, y m, theta rad) of `Localization/Pose`, or None if it is missing, too old to trust, or not to be believed (`pose_doubt`)."""
    pose = robot.newest("Localization/Pose")
    if pose_doubt(robot) is not NO_DOUBT or not isinstance(pose, Pose) or robot.is_stale("Localization/Pose"):
        return None
    return (pose.pose[0], pose.pose[1], pose.pose[3])
