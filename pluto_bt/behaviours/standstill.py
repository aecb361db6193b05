"""For how long the robot has not come anywhere although nothing holds it: its wheels spin, or it wavers on the spot."""

from __future__ import annotations

import math
from typing import Final

from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.messages import Pose

MOVED_M: Final = 0.05
MOVED_RAD: Final = 0.05


class Standstill:
    """Watches dead reckoning, which believes wheels that slip as far as they grip. What holds the robot back with a word is left to that word."""

    def __init__(self, now_s: float) -> None:
        self._place: Pose | None = None
        self._since_s = now_s

    def step(self, robot: Robot, now_s: float, is_held: bool) -> float:
        """Seconds since the robot last came away from where it was, or was held."""
        now = robot.newest("Localization/Dead-Reckoning")
        if is_held or self._place is None or not isinstance(now, Pose) or _is_away(self._place, now):
            self._place, self._since_s = now if isinstance(now, Pose) else None, now_s
        return now_s - self._since_s


def _is_away(a: Pose, b: Pose) -> bool:
    turned_rad = math.remainder(b.pose[3] - a.pose[3], math.tau)
    return math.dist(a.pose[:2], b.pose[:2]) > MOVED_M or abs(turned_rad) > MOVED_RAD
