"""The robot's own trail, by the odometry: where it came from is free, for it was there."""

from __future__ import annotations

import math
from collections import deque
from itertools import pairwise
from typing import Final

from pluto_bt.skills.outline import Planar

STEP_M: Final = 0.1
MOST: Final = 200  # of steps: 20 m at least
GAP_M: Final = 0.5  # a robot that was not watched for so long a way came from somewhere else


class Trail:
    """Where the robot was, the oldest first; what is backed over is taken off again."""

    def __init__(self) -> None:
        self._places: deque[tuple[float, float]] = deque(maxlen=MOST)

    def note(self, robot: Planar, is_backing: bool) -> None:
        """The robot is here now."""
        places, here = self._places, robot[:2]
        if places and math.dist(places[-1], here) > GAP_M:
            places.clear()
        while is_backing and len(places) > 1 and math.dist(places[-2], here) < math.dist(places[-1], here):
            places.pop()
        if not places or (not is_backing and math.dist(places[-1], here) > STEP_M):
            places.append(here)

    @property
    def length_m(self) -> float:
        """How far back it is known."""
        return sum(math.dist(a, b) for a, b in pairwise(self._places))

    def turn_rad(self, robot: Planar, aim_m: float) -> float:
        """The turn with which the tail of the robot points to where it was `aim_m` ago; 0 where that is not known."""
        way_m, (x, y) = 0.0, robot[:2]
        for place in reversed(self._places):
            way_m += math.dist((x, y), place)
            x, y = place
            if way_m >= aim_m:
                break
        away_m = math.hypot(robot[0] - x, robot[1] - y)
        return math.remainder(math.atan2(robot[1] - y, robot[0] - x) - robot[2], math.tau) if away_m > STEP_M else 0.0
