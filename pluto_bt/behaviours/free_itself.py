"""How a robot frees itself where it can neither go on nor turn: a little back, or where that is blocked a little forward."""

from __future__ import annotations

import math
from typing import Final

from pluto_bt.behaviours.surroundings import Surroundings
from pluto_bt.skills.outline import Planar

SPEED_MPS: Final = 0.15
WAY_M: Final = 0.4
EACH_S: Final = 4.0  # for one direction


class FreeItself:
    """One attempt, from the pose in which the robot is stuck. The chain keeps it from touching anything."""

    def __init__(self, around: Surroundings, now_s: float) -> None:
        self._from: Planar = around.robot
        self._speeds = [speed for speed in (-SPEED_MPS, SPEED_MPS) if self._stays_inside(around, speed)]
        self._since_s = now_s

    def speed_mps(self, around: Surroundings, now_s: float) -> float:
        """The speed to drive straight with now; 0 = the attempt is over, with or without success."""
        if math.dist(around.robot[:2], self._from[:2]) >= WAY_M:
            self._speeds = []
        elif self._speeds and now_s - self._since_s > EACH_S:
            self._speeds, self._since_s = self._speeds[1:], now_s
        return self._speeds[0] if self._speeds else 0.0

    def _stays_inside(self, around: Surroundings, speed: float) -> bool:
        """True if the way does not lead out of the rectangle."""
        rectangle, (x, y, theta) = around.rectangle_here, self._from
        way_m = math.copysign(WAY_M, speed)
        return rectangle is None or rectangle.depth_m(x + way_m * math.cos(theta), y + way_m * math.sin(theta)) >= 0.0
