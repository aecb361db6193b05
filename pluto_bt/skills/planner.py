"""Ways over the map: a search through what is free, cheapest where there is room, then smoothed to what a person would drive."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.skills.outline import Array, Outline
from pluto_bt.skills.plan_map import PlanMap
from pluto_bt.skills.plan_parameters import PlanParameters
from pluto_bt.skills.smoothing import pulled, resampled, smoothed
from pluto_bt.skills.way_kernels import search

Point = tuple[float, float]
RELAXED_M = 0.8  # so near to its start and its goal a way may be tighter
LEAST_REACH_CELLS = 1.0
STEP_M = 0.1  # between the points of a way
GREED = 1.08  # steps go along the grid and its diagonals, which is up to 8 % longer than straight
_NO_RECTANGLE = np.zeros(7)


class Planner:
    """Plans on one map for one robot; keeps the working memory of the search."""

    def __init__(self, plan_map: PlanMap, outline: Outline, parameters: PlanParameters) -> None:
        self.map = plan_map
        cell_m, count = plan_map.frame.cell_m, plan_map.cells.size
        self.least_m = outline.side_m + parameters.gap_m  # from the middle of the robot to what stands
        self._half = (outline.side_m + max(parameters.room_m, parameters.gap_m + 0.05)) / cell_m
        self._wide = max((outline.side_m + parameters.wide_m) / cell_m, self._half + 1.0)
        self._cost = np.zeros(count, dtype=np.float32)
        self._came = np.zeros(count, dtype=np.int32)
        self._keys = np.zeros(2 * count, dtype=np.float32)
        self._places = np.zeros(2 * count, dtype=np.int32)

    def plan(self, start: Point, goal: Point, tolerance_m: float) -> Array | None:
        """Points (n, 2) of the map, `STEP_M` apart, from the start to the goal or to within `tolerance_m` of it; None if there is no way.

        Both ends must lie on the map.
        """
        frame = self.map.frame
        least = self.least_m / frame.cell_m
        goal_cell = self.map.cell(*goal)
        is_open = float(self.map.clearance[goal_cell]) > 1.0
        reach = LEAST_REACH_CELLS if is_open else max(tolerance_m / frame.cell_m, LEAST_REACH_CELLS)
        end = search(
            self.map.cells, self.map.cells, self.map.clearance, self.map.cell(*start), goal_cell, reach, _NO_RECTANGLE, least, self._half,
            self._wide, RELAXED_M / frame.cell_m, 0.0, GREED, self._cost, self._came, self._keys, self._places,
        )  # fmt: skip
        if end < 0:
            return None
        rough = self._traced(end)
        rough[0] = start
        if is_open:
            rough[-1] = goal
        return self._pleasant(rough)

    def _traced(self, end: int) -> Array:
        places = [end]
        while (before := int(self._came[places[-1]])) != places[-1]:
            places.append(before)
        cells = np.array(places[::-1])
        columns = self.map.frame.columns
        if len(cells) == 1:
            cells = np.repeat(cells, 2)
        return self.map.frame.to_map(np.column_stack((cells // columns + 0.5, cells % columns + 0.5)))

    def _pleasant(self, rough: Array) -> Array:
        """The same way without the corners of the grid."""
        wide_m = self._half * self.map.frame.cell_m
        straight = pulled(resampled(rough, STEP_M), self.map.clearances_m, wide_m)
        return smoothed(resampled(straight, STEP_M), self.map.clearances_m, wide_m)

    def is_free(self, points: Array) -> bool:
        """True if a way still has the room it needs, as far as the map and what lies over it tell."""
        return bool((self.map.clearances_m(points) > 0.8 * self.least_m).all()) if len(points) else True

    def length_m(self, points: Array) -> float:
        """From the first point to the last."""
        return float(math.fsum(np.hypot(*np.diff(points, axis=0).T).tolist()))
