"""What the leaves that navigate share: the planner of the robot's map, and what the sensors have found in the way."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.behaviours.surroundings import Surroundings
from pluto_bt.maps.platform import Platform
from pluto_bt.maps.world import World
from pluto_bt.skills.map_area import MapArea
from pluto_bt.skills.outline import Array, Planar, outline_of
from pluto_bt.skills.plan_map import PlanMap
from pluto_bt.skills.plan_parameters import PlanParameters
from pluto_bt.skills.planner import STEP_M, Planner
from pluto_bt.skills.smoothing import resampled, smoothed

Point = tuple[float, float]
MOST_AVOIDED: Final = 5  # bends too tight for a long robot, before the best way is taken as it is
SEEN_FOR_PLAN_M: Final = 15.0  # what was seen farther away is not laid over the map: it will be seen again from nearer


NO_MAP, START_OUTSIDE, GOAL_OUTSIDE, GOAL_OCCUPIED, NO_WAY = "no-map", "start-outside", "goal-outside", "goal-occupied", "no-way"


class Plan(NamedTuple):
    """A path; or the reason (a word of the list), a sentence, and the `cause` why there is none."""

    path: MapPath | None
    reason: str = ""
    text: str = ""
    cause: str = ""


class Navigation:
    """One robot's. The map is drawn when the first way over it is asked for, and again if a way leads beyond it."""

    def __init__(self, platform: Platform, world: World | None, surroundings: Surroundings, parameters: PlanParameters) -> None:
        self.parameters, self.world = parameters, world
        self.around = surroundings
        self._outline = outline_of(platform.body.outline_m)
        self._area = MapArea.of(world)
        self._planner: Planner | None = None
        self.least_m = self._outline.side_m + parameters.gap_m

    def planner(self, *points: Point) -> Planner | None:
        """The planner on a map that holds `points`, as far as they can be on it; None without a map."""
        if self.world is None:
            return None
        planner = self._planner
        is_too_small = planner is not None and self.world.grid is None and not all(planner.map.frame.has(*point) for point in points)
        if planner is None or is_too_small:
            planner = self._planner = Planner(PlanMap(self.world, points), self._outline, self.parameters)
        return planner

    def plan(self, start: Planar, goal: Point, goal_rad: float | None, tolerance_m: float, now_s: float) -> Plan:
        """The best way over the map and around what was seen."""
        planner = self.planner(start[:2], goal)
        if planner is None:
            return Plan(None, "no-path", "there is no map to plan on; give one with --map", NO_MAP)
        for name, point, cause in (("goal", goal, GOAL_OUTSIDE), ("start", start[:2], START_OUTSIDE)):
            if not (planner.map.frame.has(*point) and self._area.has_point(*point)):
                return Plan(None, "outside-map", f"the {name} {point[0]:.2f};{point[1]:.2f} is outside the map", cause)
        points = self._roomy(planner, start[:2], goal, tolerance_m)
        if points is None:
            return self._why(planner, start[:2], goal, tolerance_m)
        return Plan(MapPath.along(points, goal_rad, round(now_s * 1e9)))

    def _roomy(self, planner: Planner, start: Point, goal: Point, tolerance_m: float) -> Array | None:
        """The best way whose bends the robot can take; if there is none after a few tries the best way at all."""
        seen = self.seen()
        planner.map.lay_over(seen)
        best = points = planner.plan(start, goal, tolerance_m)
        avoided: list[Point] = []
        while points is not None and len(avoided) < MOST_AVOIDED and (tight := planner.tight_place(points)) is not None:
            avoided.append(tight)
            planner.map.lay_over(np.vstack((seen, avoided)))
            points = planner.plan(start, goal, tolerance_m)
        if avoided:
            planner.map.lay_over(seen)
        return best if points is None or len(avoided) == MOST_AVOIDED else points

    def _why(self, planner: Planner, start: Point, goal: Point, tolerance_m: float) -> Plan:
        room_m = float(planner.map.clearances_m(np.array([goal]))[0])
        if planner.standable(goal, tolerance_m) is None:
            text = f"there is no room for the robot at the goal {goal[0]:.2f};{goal[1]:.2f}: {room_m:.2f} m to the next obstacle"
            return Plan(None, "no-path", text, GOAL_OCCUPIED)
        text = f"the map has no way from {start[0]:.2f};{start[1]:.2f} to {goal[0]:.2f};{goal[1]:.2f} that is {2 * self.least_m:.2f} m wide"
        return Plan(None, "no-path", text, NO_WAY)

    def seen(self) -> Array:
        """Points (n, 2) of the map where the sensors have seen something stand, near the robot."""
        points = self.around.fine.standing()
        near = np.hypot(points[:, 0] - self.around.robot[0], points[:, 1] - self.around.robot[1]) < SEEN_FOR_PLAN_M
        return moved(points[near], self.around.robot, self.around.believed)

    def blocking(self) -> Array:
        """Points (n, 2) of the map that the sensors have seen and the map does not show."""
        return np.zeros((0, 2)) if self._planner is None else self._planner.map.unexplained()

    def is_blocked(self, points: Array) -> bool:
        """True if the sensors see something in a stretch (k, 2) of a path over the map."""
        if not len(points):
            return False
        here = moved(points, self.around.believed, self.around.robot)
        return bool((self.around.fine.clearances_m(here) < self._outline.side_m).any())

    def blocked_places(self, points: Array) -> NDArray[np.intp]:
        """The indices of those of points (n, 2) of the map where the outline does not fit, by the map or by what was seen."""
        rooms_m = np.full(len(points), np.inf)
        if self.world is not None and len(points):
            planner = self.planner(tuple(points[0]), tuple(points[-1]))
            assert planner is not None  # there is a map
            planner.map.lay_over(self.seen())
            rooms_m = planner.map.clearances_m(points)
        rooms_m = np.minimum(rooms_m, self.around.fine.clearances_m(moved(points, self.around.believed, self.around.robot)))
        return np.flatnonzero(rooms_m < self._outline.side_m)

    def smoothed(self, path: MapPath) -> MapPath:
        """The same way with rounder corners, as far as there is room."""
        if self._planner is None or len(path) < 3:
            return path
        points = smoothed(resampled(path.points, STEP_M), self._planner.map, self.least_m + self.parameters.room_m)
        return MapPath.along(points, float(path.poses[-1, 2]) if path.ends_turned else None, path.stamp_ns)

    def rooms_m(self) -> Callable[[Array], Array] | None:
        """How far points of the map are from what the map shows and what was laid over it; None if there is no planner yet."""
        return None if self._planner is None else self._planner.map.clearances_m

    def forget(self) -> None:
        """What was seen in the way is not believed any more."""
        self.around.forget()
        if self._planner is not None:
            self._planner.map.lay_over(np.zeros((0, 2)))

    def forget_square(self, middle: Point, side_m: float, *, inside: bool) -> None:
        """The same inside a square round a point of the map, or outside of it."""
        if not self.around.is_empty:
            self.around.forget_square(self.around.to_dead_reckoning(middle), side_m, inside=inside)


def moved(points: Array, before: Planar, after: Planar) -> Array:
    """Points (n, 2) given beside `before` as they lie beside `after`; both are the same robot in two frames."""
    c, s = math.cos(after[2] - before[2]), math.sin(after[2] - before[2])
    x, y = points[:, 0] - before[0], points[:, 1] - before[1]
    return np.column_stack((after[0] + c * x - s * y, after[1] + s * x + c * y))
