"""Is there a way round, and how long is it: asked of the planner that the robot itself uses."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.platform import Platform
from pluto_bt.maps.world import World
from pluto_bt.skills.outline import outline_of
from pluto_bt.skills.plan_map import PlanMap
from pluto_bt.skills.plan_parameters import PlanParameters
from pluto_bt.skills.planner import Planner
from pluto_bt.trees.checks.legs import Point

FAR_M: Final = 100.0  # places further away from the world than that do not stretch its grid
DRAWN_CELLS: Final = 1.5  # what is drawn into a grid may be that much too thick
HALF_DIAGONAL: Final = 0.7072  # of a cell: no wall is thinner than what two neighbouring cells leave between them


class Ways:
    """Ways of one robot through a world as it stands at the start, without the things that move."""

    def __init__(self, world: World, robot: Platform, parameters: PlanParameters, places: Iterable[Point]) -> None:
        x0, y0, x1, y1 = world.bounds_m()
        near = [place for place in places if x0 - FAR_M < place[0] < x1 + FAR_M and y0 - FAR_M < place[1] < y1 + FAR_M]
        self._planner = Planner(PlanMap(world, near), outline_of(robot.body.outline_m), parameters)
        self._least_m = inner_radius_m(np.array(robot.body.outline_m))
        self._joined: NDArray[np.int32] | None = None

    @property
    def width_m(self) -> float:
        """What a planned way needs."""
        return 2.0 * self._planner.least_m

    def is_drawn(self, place: Point) -> bool:
        """True if the place lies on the grid."""
        return self._planner.map.frame.has(*place)

    def length_m(self, start: Point, goal: Point, tolerance_m: float) -> float | None:
        """The length of the way that the robot would plan; None if it finds none."""
        points = self._planner.plan(start, goal, tolerance_m)
        return None if points is None else self._planner.length_m(points)

    def is_cut_off(self, start: Point, goal: Point) -> bool:
        """True if nothing as wide as the largest disc in the outline comes from one to the other; False where the grid is too coarse to be sure."""
        plan_map = self._planner.map
        cell_m = plan_map.frame.cell_m
        room_m = self._least_m - (HALF_DIAGONAL + DRAWN_CELLS) * cell_m
        if room_m < HALF_DIAGONAL * cell_m:
            return False
        if self._joined is None:
            from scipy.ndimage import label  # heavy, and only needed here

            self._joined = label(plan_map.clearance * cell_m >= room_m, structure=np.ones((3, 3)))[0]
        ends = [self._joined[plan_map.cell(*place)] for place in (start, goal)]
        return bool(0 not in ends and ends[0] != ends[1])


def inner_radius_m(outline_m: NDArray[np.float64]) -> float:
    """Radius of the largest disc round the robot's origin inside its outline (n, 2): where that does not pass, nothing does."""
    ends = np.roll(outline_m, -1, axis=0)
    along = ends - outline_m
    share = np.clip(-np.sum(outline_m * along, axis=1) / np.sum(along**2, axis=1), 0.0, 1.0)
    return float(np.min(np.linalg.norm(outline_m + share[:, None] * along, axis=1)))
