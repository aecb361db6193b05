"""Ways over the local map: through what is free, in the middle of the street, never out of the rectangle; what is not known may be free."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pluto_bt.skills.local_grid import CELLS
from pluto_bt.skills.local_map import LocalMap
from pluto_bt.skills.map_kernels import Bytes, Floats
from pluto_bt.skills.outline import Array, Outline, Planar
from pluto_bt.skills.rectangle import Rectangle
from pluto_bt.skills.way_kernels import search

TURNING_GAP_M = 0.15  # what must be left around a robot that turns on the spot
RELAXED_M = 1.2  # so near to its start and its goal a way may be as tight as they are; and there and beside home on the edge of the rectangle
GREED = 1.5  # the search hurries towards the goal, for it is asked often
Ground = tuple[Bytes, Floats]  # evidence and clearance, as those of `LocalMap`
GAP_M = 0.05  # how exactly half the width of a gap that is too narrow is looked for
BEYOND_M = 3.0  # a goal beyond the map is reached for now if the edge of the map is reached so near to it


@dataclass(frozen=True, slots=True)
class Way:
    """Points (k, 2) in metres, frame of dead reckoning, from the robot to the end; `leads_there` = the end is the goal itself."""

    points: Array
    leads_there: bool = True

    @property
    def length_m(self) -> float:
        """From the first point to the last."""
        return float(np.hypot(*np.diff(self.points, axis=0).T).sum())


class Gap(NamedTuple):
    """The narrowest place of a way: x m, y m in dead reckoning, and how wide the map shows it to be."""

    x_m: float
    y_m: float
    width_m: float


class Ways:
    """Finds ways; keeps the working memory of the search."""

    def __init__(self, map: LocalMap, outline: Outline) -> None:
        self.map = map
        self.least_m = outline.side_m + map.parameters.side_gap_m
        self.passes_m = max(outline.side_m, self.least_m - map.doubt_m)  # what the map may show of a place that is just wide enough
        self.room_m = max(self.least_m, outline.reach_m + TURNING_GAP_M)
        self._cost = np.zeros(CELLS * CELLS, dtype=np.float32)
        self._came = np.zeros(CELLS * CELLS, dtype=np.int32)
        self._keys = np.zeros(2 * CELLS * CELLS, dtype=np.float32)
        self._places = np.zeros(2 * CELLS * CELLS, dtype=np.int32)

    def to_goal(
        self, robot: Planar, goal: tuple[float, float], rectangle: Rectangle | None, ground: Ground | None = None, least_m: float | None = None
    ) -> Way | None:
        """The best way to within the tolerance of a goal; None if there is none, whatever the unseen may hold.

        Args:
            ground: in place of the map's. least_m: clearance of the narrowest way, in place of `passes_m`.
        """
        x_m, y_m = goal
        reach_m = self.map.parameters.tolerance_m
        is_inside = self.map.has_inside(x_m, y_m)
        if not is_inside:
            x_m, y_m = self._at_the_edge(robot, goal)
            reach_m = BEYOND_M
        points = self._search(robot, (x_m, y_m), max(reach_m / self.map.cell_m, 0.8), rectangle, ground, least_m)
        return None if points is None else Way(points, is_inside)

    def widest_gap(self, robot: Planar, goal: tuple[float, float], rectangle: Rectangle | None) -> Gap | None:
        """What is too narrow on the way to a goal that is the least narrow of all; None where not even a slit leads there."""
        low_m, high_m = 0.5 * self.map.cell_m, self.passes_m
        best = self.to_goal(robot, goal, rectangle, least_m=low_m)
        if best is None:
            return None
        while high_m - low_m > GAP_M:
            least_m = 0.5 * (low_m + high_m)
            way = self.to_goal(robot, goal, rectangle, least_m=least_m)
            best, low_m, high_m = (best, low_m, least_m) if way is None else (way, least_m, high_m)
        rooms_m = self.map.clearances_m(best.points)
        at = int(np.argmin(rooms_m))
        return Gap(float(best.points[at, 0]), float(best.points[at, 1]), 2.0 * float(rooms_m[at]))

    def to_new_ground(self, robot: Planar, rectangle: Rectangle | None) -> Way | None:
        """The way to the nearest place that is not covered yet; None if all that can be reached is. It is not worth squeezing for."""
        points = self._search(robot, robot[:2], -1.0, rectangle, least_m=self.least_m)
        return None if points is None else Way(points)

    def _at_the_edge(self, robot: Planar, goal: tuple[float, float]) -> tuple[float, float]:
        """The last point inside the map on the straight line from the robot to the goal."""
        dx, dy = goal[0] - robot[0], goal[1] - robot[1]
        low, high = self.map.middle_m(2, 2), self.map.middle_m(CELLS - 3, CELLS - 3)
        share = 1.0
        for at, step, least, most in ((robot[0], dx, low[0], high[0]), (robot[1], dy, low[1], high[1])):
            if step:
                share = min(share, ((most if step > 0.0 else least) - at) / step)
        return robot[0] + max(0.0, share) * dx, robot[1] + max(0.0, share) * dy

    def _search(
        self, robot: Planar, goal: tuple[float, float], reach_cells: float, rectangle: Rectangle | None, ground: Ground | None = None,
        least_m: float | None = None,
    ) -> Array | None:  # fmt: skip
        map, p = self.map, self.map.parameters
        least, half = (self.passes_m if least_m is None else least_m) / map.cell_m, max(p.path_half_width_m, self.least_m + 0.05) / map.cell_m
        wide, relaxed = max(map.far_cells, half), RELAXED_M / map.cell_m
        evidence, clearance = (map.evidence, map.clearance) if ground is None else ground
        end = search(
            evidence, map.covered, clearance, map.cell(robot[0], robot[1]), map.cell(*goal), reach_cells, self._in_cells(rectangle),
            least, half, wide, relaxed, self.room_m / map.cell_m, GREED, self._cost, self._came, self._keys, self._places,
        )  # fmt: skip
        return None if end < 0 else self._traced(end)

    def _in_cells(self, rectangle: Rectangle | None) -> Array:
        if rectangle is None:
            return np.zeros(7)
        x, y = self.map.place(rectangle.home[0], rectangle.home[1])
        theta = rectangle.home[2]
        sizes = np.array([rectangle.base_m, rectangle.height_m, self.map.parameters.edge_m + rectangle.doubt_m]) / self.map.cell_m
        return np.array([x, y, math.cos(theta), math.sin(theta), *sizes])

    def _traced(self, end: int) -> Array:
        places = [end]
        while (before := int(self._came[places[-1]])) != places[-1]:
            places.append(before)
        cells = np.array(places[::-1])
        i, j = cells // CELLS, cells % CELLS
        return np.column_stack(((i + self.map.i0 + 0.5) * self.map.cell_m, (j + self.map.j0 + 0.5) * self.map.cell_m))
