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
RELAXED_M = 0.8  # so near to its start and its goal a way may be as tight as they are
REACH_CELLS = 1.0
CORNER_GAP_M = 0.1  # left beside the corners of a robot in a bend
TURNING_GAP_M = 0.08  # a way with so much around a robot that turns on the spot costs no more: doors are then approached straight
STEP_M = 0.1  # between the points of a way
GREED = 1.08  # steps go along the grid and its diagonals, which is up to 8 % longer than straight
_NO_RECTANGLE = np.zeros(7)


class Planner:
    """Plans on one map for one robot; keeps the working memory of the search."""

    def __init__(self, plan_map: PlanMap, outline: Outline, parameters: PlanParameters) -> None:
        self.map = plan_map
        cell_m, count = plan_map.frame.cell_m, plan_map.cells.size
        self._side_m = outline.side_m
        self._corners_m = [(x, y) for x in (outline.front_m, -outline.back_m) for y in (outline.side_m, -outline.side_m)]
        self.least_m = outline.side_m + parameters.gap_m  # from the middle of the robot to what stands
        room_m = max(outline.side_m + parameters.room_m, outline.reach_m + TURNING_GAP_M, self.least_m + 0.05)
        self._half = room_m / cell_m
        self._wide = max((outline.side_m + parameters.wide_m) / cell_m, self._half + 1.0)
        self._cost = np.zeros(count, dtype=np.float32)
        self._came = np.zeros(count, dtype=np.int32)
        self._keys = np.zeros(2 * count, dtype=np.float32)
        self._places = np.zeros(2 * count, dtype=np.int32)

    def plan(self, start: Point, goal: Point, tolerance_m: float) -> Array | None:
        """Points (n, 2) of the map, `STEP_M` apart, from the start to the goal, or where it is too tight for the robot to a place within
        `tolerance_m` of it; None if there is no way. Both ends must lie on the map.
        """
        cell_m, place = self.map.frame.cell_m, self.standable(goal, tolerance_m)
        if place is None:
            return None
        end = search(
            self.map.cells, self.map.cells, self.map.clearance, self.map.cell(*start), self.map.cell(*place), REACH_CELLS, _NO_RECTANGLE,
            self.least_m / cell_m, self._half, self._wide, RELAXED_M / cell_m, 0.0, GREED, self._cost, self._came, self._keys, self._places,
        )  # fmt: skip
        if end < 0:
            return None
        rough = self._traced(end)
        rough[0], rough[-1] = start, place
        return self._pleasant(rough)

    def standable(self, goal: Point, tolerance_m: float) -> Point | None:
        """The place nearest to a goal, at most `tolerance_m` away, where the robot has room to stand; None if there is none."""
        frame = self.map.frame
        if self.map.clearances_m(np.array([goal]))[0] >= self._side_m:
            return goal
        reach = math.floor(tolerance_m / frame.cell_m)
        offsets = np.arange(-reach, reach + 1) * frame.cell_m
        around = np.array(goal) + np.array([(x, y) for x in offsets for y in offsets])
        away_m = np.hypot(*(around - goal).T)
        away_m[(self.map.clearances_m(around) < self._side_m) | (away_m > tolerance_m)] = np.inf
        best = int(np.argmin(away_m))
        return (float(around[best, 0]), float(around[best, 1])) if math.isfinite(away_m[best]) else None

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
        return smoothed(resampled(straight, STEP_M), self.map, wide_m)

    def tight_place(self, points: Array) -> Point | None:
        """The first place of a way (n, 2) where the corners of a robot that drives along it come too near to something, its start and
        goal left out: there its bend is too tight for a long robot."""
        headings = np.arctan2(*np.gradient(points, axis=0).T[::-1])
        c, s = np.cos(headings), np.sin(headings)
        corners = (points + np.column_stack((c * x - s * y, s * x + c * y)) for x, y in self._corners_m)
        room_m = np.min([self.map.clearances_m(corner) for corner in corners], axis=0)
        skipped = math.ceil(RELAXED_M / STEP_M)
        tight = np.flatnonzero(room_m[skipped:-skipped] < CORNER_GAP_M)
        return None if not len(tight) else (float(points[skipped + tight[0], 0]), float(points[skipped + tight[0], 1]))

    def length_m(self, points: Array) -> float:
        """From the first point to the last."""
        return float(math.fsum(np.hypot(*np.diff(points, axis=0).T).tolist()))
