"""Start poses and goals drawn at random in any world, such that goto can be asked to drive them: straight ahead, or around one thing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pluto_bt.maps.clearance import outline_radius_m, path_is_clear
from pluto_bt.maps.geometry import Pose, transform_points
from pluto_bt.maps.platform import Point
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import OccupancyGrid, World

CORNERS = 16  # of the disc that stands for the outline turned any way
MARGIN_M = 0.15  # beside the robot on a straight way …
STEP_M = 0.05
WIDE_M = 0.4  # … and on a way around something
SHORTEST_M, LONGEST_M = 1.5, 15.0
DETOURS_M = (0.6, 0.9, 1.2, 1.6, 2.0)  # how far beside the straight line a way around may lead
STARTS, GOALS, POINTS = 40, 60, 400  # tries before a world counts as too narrow


@dataclass(frozen=True, slots=True)
class Course:
    """A start pose, goals one after another, and the length of the shortest way that was found through them."""

    start: Pose
    goals: tuple[Point, ...]
    length_m: float

    @property
    def goals_text(self) -> str:
        """As `--port goals=` takes them."""
        return ";".join(f"{x:.3f},{y:.3f}" for x, y in self.goals)


class Surveyor:
    """Finds room for one robot in one world as it stands at the start."""

    def __init__(self, world: World, outline_m: tuple[Point, ...]) -> None:
        self._scene, self._grid, self._box = Scene(world), world.grid, world.bounds_m()
        self._outline = np.array(outline_m)
        angles = np.arange(CORNERS) * math.tau / CORNERS
        radius_m = outline_radius_m(self._outline) / math.cos(math.pi / CORNERS)
        self._disc = radius_m * np.column_stack((np.cos(angles), np.sin(angles)))

    def course(self, rng: np.random.Generator, legs: int, around: bool) -> Course | None:
        """A course of so many legs; None if the world has no room for one.

        Args:
            around: every leg has something in its straight way, and a way around it; else every straight way is free.
        """
        for _ in range(STARTS):
            at = self._free_point(rng)
            if at is None:
                continue
            start = (*at, float(rng.uniform(-math.pi, math.pi)))
            goals: list[Point] = []
            length_m = 0.0
            for _ in range(GOALS):
                goal = self._free_point(rng, at)
                leg_m = math.inf if goal is None else self._leg_m(at, goal, around)
                if goal is not None and leg_m < math.inf:
                    goals.append(goal)
                    at, length_m = goal, length_m + leg_m
                if len(goals) == legs:
                    return Course(start, tuple(goals), length_m)
        return None

    def _free_point(self, rng: np.random.Generator, near: Point | None = None) -> Point | None:
        """A point where the robot can turn on the spot, known to the map, in reach of `near`."""
        x_min, y_min, x_max, y_max = self._box
        for _ in range(POINTS):
            if near is None:
                x, y = float(rng.uniform(x_min, x_max)), float(rng.uniform(y_min, y_max))
            else:
                way_m, bearing = float(rng.uniform(SHORTEST_M, LONGEST_M)), float(rng.uniform(-math.pi, math.pi))
                x, y = near[0] + way_m * math.cos(bearing), near[1] + way_m * math.sin(bearing)
            if not (x_min < x < x_max and y_min < y < y_max and _is_known(self._grid, x, y)):
                continue
            if self._has_room(x, y, MARGIN_M):
                return round(x, 3), round(y, 3)
        return None

    def _leg_m(self, a: Point, b: Point, around: bool) -> float:
        """Length of the way from a to b; infinite if there is none of the kind that is asked for."""
        if self._is_free((a, b), MARGIN_M):
            return math.inf if around else math.dist(a, b)
        return self._way_around_m(a, b) if around else math.inf

    def _way_around_m(self, a: Point, b: Point) -> float:
        """The shortest way around what stands between; infinite unless it can be passed on either side: a wall is a planner's job."""
        left_m, right_m = (self._way_beside_m(a, b, side) for side in (1.0, -1.0))
        return min(left_m, right_m) if max(left_m, right_m) < math.inf else math.inf

    def _way_beside_m(self, a: Point, b: Point, side: float) -> float:
        """The shortest way over one point on that side of the straight line."""
        dx, dy = (b[0] - a[0]) / math.dist(a, b), (b[1] - a[1]) / math.dist(a, b)
        for detour_m in DETOURS_M:
            for share in (0.3, 0.5, 0.7):
                x, y = a[0] + share * (b[0] - a[0]) - side * detour_m * dy, a[1] + share * (b[1] - a[1]) + side * detour_m * dx
                if self._has_room(x, y, WIDE_M) and self._is_free((a, (x, y), b), WIDE_M):
                    return math.dist(a, (x, y)) + math.dist((x, y), b)
        return math.inf

    def _has_room(self, x_m: float, y_m: float, margin_m: float) -> bool:
        """Whether the robot can turn on the spot there."""
        return self._scene.clearance(transform_points((x_m, y_m, 0.0), self._disc)).distance_m > margin_m

    def _is_free(self, points: tuple[Point, ...], margin_m: float) -> bool:
        """Whether the robot can drive from point to point, turning on the spot at each."""
        poses: list[Pose] = []
        for (x0, y0), (x1, y1) in pairwise(points):
            bearing = math.atan2(y1 - y0, x1 - x0)
            poses += [(x0, y0, bearing), (x1, y1, bearing)]
        return path_is_clear(self._scene, self._outline, poses, margin_m, STEP_M) is None


def _is_known(grid: OccupancyGrid | None, x_m: float, y_m: float) -> bool:
    """Whether the map says that there is ground; outside of a map nobody knows."""
    if grid is None:
        return True
    x0, y0, theta = grid.origin
    dx, dy = x_m - x0, y_m - y0
    column = math.floor((math.cos(theta) * dx + math.sin(theta) * dy) / grid.resolution_m)
    row = math.floor((math.cos(theta) * dy - math.sin(theta) * dx) / grid.resolution_m)
    rows, columns = grid.unknown.shape
    return 0 <= row < rows and 0 <= column < columns and not grid.unknown[row, column]
