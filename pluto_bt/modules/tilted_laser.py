"""A laser that stays tilted sees the ground and is no witness of the robot's way: that is said, with the cure."""

from __future__ import annotations

import math
from collections.abc import Callable

from estimation.se2 import Pose2

LEVEL_RAD = math.radians(2.0)  # a scan from a wrist or a robot that leans more also sees the ground
STAYS_M = 2.0  # so much way in one posture is no glance at the ground any more
TILTED = "laser-tilted"


class TiltedLaser:
    """Watches the wrist while the robot drives. Said once, and again only after as much way with a level laser."""

    def __init__(self, say: Callable[[str, str, str, str], None]) -> None:
        self._say = say
        self._is_tilted = self._is_told = False
        self._way_m = 0.0  # driven in this posture
        self._last: Pose2 | None = None

    def look(self, tilt_rad: float, pose_odom_robot: Pose2) -> None:
        """The wrist's tilt at a scan, and where the robot was."""
        is_tilted = abs(tilt_rad) > LEVEL_RAD
        if is_tilted is not self._is_tilted:
            self._is_tilted, self._way_m = is_tilted, 0.0
        elif self._last is not None:
            self._way_m += math.dist(self._last[:2], pose_odom_robot[:2])
        self._last = pose_odom_robot
        if self._way_m < STAYS_M or is_tilted is self._is_told:
            return
        self._is_told = is_tilted
        if is_tilted:
            text = f"the laser has been tilted by {math.degrees(tilt_rad):.0f} deg for {self._way_m:.0f} m: so it cannot tell whether the wheels slip"
            self._say("warning", TILTED, "local", f'{text} or the gyro drifts; PointWrist with tilt_deg="0" levels it')
