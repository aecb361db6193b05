"""How far the robot has driven, by dead reckoning: a jump of the odometry is no way, and wheels that slip are believed as far as they grip."""

from __future__ import annotations

import math

from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.messages import Pose


class WayDriven:
    """Metres along the robot's own path since it was made, forwards positive; what is backed counts off."""

    def __init__(self, robot: Robot) -> None:
        self.way_m = 0.0
        self._last: Pose | None = None
        self.step(robot)

    def step(self, robot: Robot) -> float:
        """Add what has been driven since the last call; `way_m`."""
        now = robot.newest("Localization/Dead-Reckoning")
        if not isinstance(now, Pose):
            return self.way_m
        if self._last is not None:
            self.way_m += along_m(self._last, now)
        self._last = now
        return self.way_m


def along_m(a: Pose, b: Pose) -> float:
    """Length of the arc that leads from one pose to the next, as far as it lies ahead (behind: negative)."""
    half_rad = 0.5 * math.remainder(b.pose[3] - a.pose[3], math.tau)
    middle_rad = a.pose[3] + half_rad
    chord_m = (b.pose[0] - a.pose[0]) * math.cos(middle_rad) + (b.pose[1] - a.pose[1]) * math.sin(middle_rad)
    return chord_m * (half_rad / math.sin(half_rad) if abs(half_rad) > 1e-9 else 1.0)
