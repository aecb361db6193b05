"""Each leg of a mission driven in thought through a world: does the outline fit, is it allowed there, how far and how long."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pluto_bt.inputs.ways_in_world import Ways
from pluto_bt.maps.clearance import Blocked, path_is_clear
from pluto_bt.maps.geometry import Pose, transform_points
from pluto_bt.maps.platform import Limits
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.script import At, Put, Remove, When
from pluto_bt.maps.world import Shape, World
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.skills.map_area import MapArea
from pluto_bt.source import Faults, Place
from pluto_bt.trees.checks.legs import Leg, Point
from pluto_bt.trees.checks.world_words import goals_of, tell_unknown_goal

HEADINGS = 24  # tried where the robot may stand in any direction


@dataclass(frozen=True)
class LegTold:
    """What there is to say of a leg; distance and time are None where its start is not known, infinite where there is no way."""

    name: str
    start: Point | None
    goal: Point
    distance_m: float | None
    time_s: float | None

    def as_text(self) -> str:
        """One line."""
        start = "?" if self.start is None else _shown(self.start)
        if self.distance_m is None or self.time_s is None:
            return f"{self.name}: {start} → {_shown(self.goal)}"
        if math.isinf(self.distance_m):
            return f"{self.name}: {start} → {_shown(self.goal)}: no way"
        return f"{self.name}: {start} → {_shown(self.goal)}: {self.distance_m:.1f} m, about {self.time_s:.0f} s"

    def as_json(self) -> dict[str, object]:
        """Numbers in metres and seconds; null where they are not known."""
        known = self.distance_m is not None and math.isfinite(self.distance_m)
        return {"leg": self.name, "start": self.start, "goal": self.goal, "distance_m": self.distance_m if known else None,
                "time_s": self.time_s if known else None}  # fmt: skip


class LegCheck:
    """The legs of one mission, robot and world, without the things that move."""

    def __init__(self, world: World, robot: RobotFile, faults: Faults) -> None:
        self._world, self._robot, self._faults = replace(world, actors=()), robot, faults
        self._outline = np.array(robot.body.outline_m, dtype=np.float64)
        solid = tuple(replace(shape, kind="polygon") if shape.kind == "hole" else shape for shape in world.shapes)
        self._scene = Scene(replace(self._world, shapes=solid))
        self._forbidden = Scene(World("forbidden", shapes=_forbidden_shapes(world)))
        self._area = MapArea.of(world)
        self._has_eyes = robot.devices.laser is not None or robot.devices.sonar is not None
        # a script that takes things away or puts them elsewhere may open ways that are not there at the start
        self._changes = any(isinstance(action, (Remove, Put)) for entry in world.script for action in _actions(entry))
        self._ways: Ways | None = None
        self._lost: set[Point] = set()  # goals that cannot be reached
        self._told: set[tuple[Place, str]] = set()  # a leg in a loop is told once

    def run(self, legs: Sequence[Leg]) -> list[LegTold]:
        """Check all legs; their faults stand at the goals. What is told: each leg of known start, and goals that are in none of these."""
        places = [place for leg in legs for place in (leg.start, self._point(leg)) if place is not None]
        self._ways = Ways(self._world, self._robot, self._robot.plan, places)
        told = [one for leg in legs if (one := self._leg(leg)) is not None]
        reached = [one.goal for one in told if one.start is not None]
        return [one for one in told if one.start is not None or one.goal not in reached]

    def _leg(self, leg: Leg) -> LegTold | None:
        goal = self._point(leg)
        if goal is None:
            return None
        name = f"{leg.plan.type_name}" + (f' "{leg.plan.name}"' if leg.plan.name != leg.plan.type_name else "")
        start = leg.start if leg.start not in self._lost else None  # the robot will not be there
        is_sound = self._check_goal(leg, start, goal)
        if not is_sound:
            self._lost.add(goal)
        if start is None:
            return LegTold(name, None, goal, None, None)
        length_m = math.dist(start, goal)
        if is_sound and length_m > leg.tolerance_m:
            length_m = self._length_m(leg, start, goal, length_m)
        return LegTold(name, start, goal, length_m, drive_time_s(length_m, leg.speed_mps, self._robot.limits))

    def _point(self, leg: Leg) -> Point | None:
        if not isinstance(leg.goal, str):
            return leg.goal
        goal = goals_of(self._world).get(leg.goal)
        if goal is None:
            tell_unknown_goal(leg.place, leg.goal, self._world, self._faults)
        return goal

    def _check_goal(self, leg: Leg, start: Point | None, goal: Point) -> bool:
        """Whether the robot may and can stand at the goal, or as near to it as counts."""
        shown = _shown(goal)
        if not self._area.has_point(*goal):
            self._error(leg, "outside-map", f"goal {shown} is outside the mapped area", "a goal inside", shown)
            return False
        if self._is_off_the_map(leg, goal):
            self._error(leg, "outside-map", f"goal {shown} is beyond the edge of the map", "a goal on the map", shown)
            return False
        at = _short_of(start, goal, leg.tolerance_m)
        for scene, code, what in ((self._scene, "goal-blocked", "cannot stand"), (self._forbidden, "forbidden", "must not be")):
            hit = self._hit_at(scene, at)
            if hit:
                what, mend = f"the robot {what} at {shown}", "choose a goal further away from it"
                may_be_free = self._changes and scene is self._scene
                self._error(leg, code, what, "a free place", f'"{hit}" is there', mend, is_warning=may_be_free)
                return False
        return True

    def _is_off_the_map(self, leg: Leg, goal: Point) -> bool:
        grid = self._world.grid
        if grid is None or (self._world.shapes and leg.way != "planned"):
            return False  # what stands around the grid may be part of the world too, but the planner knows the grid alone
        x, y, theta = grid.origin
        cos, sin = math.cos(theta), math.sin(theta)
        across, up = (goal[0] - x) * cos + (goal[1] - y) * sin, -(goal[0] - x) * sin + (goal[1] - y) * cos
        rows, columns = grid.occupied.shape
        return not (0.0 <= across <= columns * grid.resolution_m and 0.0 <= up <= rows * grid.resolution_m)

    def _hit_at(self, scene: Scene, at: Point) -> str:
        """What is in the way of the outline at a point whatever its heading; "" if it fits in one of them."""
        owner = ""
        for i in range(HEADINGS):
            nearest = scene.clearance(transform_points((*at, i * math.tau / HEADINGS), self._outline))
            if nearest.distance_m > 0.0:
                return ""
            owner = nearest.owner
        return owner

    def _length_m(self, leg: Leg, start: Point, goal: Point, straight_m: float) -> float:
        """The length of the way that is to be expected; a fault where there is none."""
        end = _short_of(start, goal, leg.tolerance_m)
        theta = math.atan2(goal[1] - start[1], goal[0] - start[0])
        line: tuple[Pose, Pose] = ((*start, theta), (*end, theta))
        if leg.way == "straight" and not self._area.has_line(*start, *goal):
            where = f"{_shown(start)} → {_shown(goal)}"  # who has no eyes is held by that area alone
            what = "the straight way leaves the mapped area"
            self._error(leg, "outside-map", what, "a way inside", where, "give a goal between", is_warning=self._has_eyes)
            return straight_m
        blocked, banned = path_is_clear(self._scene, self._outline, line), path_is_clear(self._forbidden, self._outline, line)
        if blocked is None and banned is None and leg.way != "planned":
            return straight_m
        if leg.way == "straight" and banned is not None:
            found = f'"{banned.nearest.owner}" at {_shown(banned.pose_map_robot)}'
            self._error(leg, "forbidden", "the straight way leads through what is forbidden", "an allowed way", found, "give a goal between")
        around_m = self._length_around_m(leg, start, goal, blocked or banned)
        if blocked is not None and leg.way == "straight" and around_m != math.inf:
            self._tell_blocked(leg, blocked)
        return straight_m if around_m is None else max(straight_m, around_m)

    def _length_around_m(self, leg: Leg, start: Point, goal: Point, hit: Blocked | None) -> float | None:
        """The length of a planned way, infinite and a fault where there is none; None where that is not sure."""
        ways = self._ways
        assert ways is not None  # run() has made it
        if not (ways.is_drawn(start) and ways.is_drawn(goal)):
            return None
        around_m = ways.length_m(start, goal, leg.tolerance_m)
        if around_m is not None or not (leg.way == "planned" or ways.is_cut_off(start, goal)):
            return around_m
        self._lost.add(goal)
        what = f"there is no way from {_shown(start)} to {_shown(goal)}" + (f" that is {ways.width_m:.2f} m wide" if leg.way == "planned" else "")
        found = f'"{hit.nearest.owner}" is in between' if hit is not None else "it is too narrow"
        self._error(leg, "no-way", what, "a goal that can be reached", found, is_warning=self._changes)
        return math.inf

    def _tell_blocked(self, leg: Leg, hit: Blocked) -> None:
        round_it = "it steers round single things; for a way round a building use MoveTo or NavigateTo, or goals between"
        what, mend = f"the straight way of <{leg.plan.type_name}> is blocked", round_it if self._has_eyes else "give a goal between"
        found = f'"{hit.nearest.owner}" in front of {_shown(hit.pose_map_robot)}'
        self._error(leg, "leg-blocked", what, "a free way", found, mend, is_warning=self._has_eyes)  # who sees nothing drives into it

    def _error(self, leg: Leg, code: str, message: str, expected: str, found: str, mend: str = "", is_warning: bool = False) -> None:
        if (leg.place, code) not in self._told:
            self._told.add((leg.place, code))
            tell = self._faults.warning if is_warning else self._faults.error
            tell(leg.place, code, message, expected=expected, found=found, mend=mend)


def drive_time_s(length_m: float, speed_mps: float, limits: Limits) -> float:
    """Time for a straight drive from standstill to standstill, with the platform's accelerations. Turns are not reckoned in."""
    v, up, down = min(speed_mps, limits.max_speed_mps), limits.acceleration_mps2, limits.deceleration_mps2
    ramps_m = v * v / 2.0 * (1.0 / up + 1.0 / down)
    if length_m >= ramps_m:
        return length_m / v + v / 2.0 * (1.0 / up + 1.0 / down)
    return math.sqrt(2.0 * length_m * (1.0 / up + 1.0 / down))


def _short_of(start: Point | None, goal: Point, tolerance_m: float) -> Point:
    """Where the robot may stop: that much before the goal."""
    if start is None or (length_m := math.dist(start, goal)) <= tolerance_m:
        return goal
    share = 1.0 - tolerance_m / length_m
    return start[0] + share * (goal[0] - start[0]), start[1] + share * (goal[1] - start[1])


def _forbidden_shapes(world: World) -> tuple[Shape, ...]:
    areas = [Shape(area.id or f"forbidden area {i}", "polygon", area.points) for i, area in enumerate(world.areas, 1) if area.kind == "forbidden"]
    lines = [Shape(line.id or f"forbidden line {i}", "wall", line.points) for i, line in enumerate(world.lines, 1) if line.kind == "forbidden"]
    return (*areas, *lines)


def _actions(entry: At | When) -> tuple[object, ...]:
    return tuple(entry.actions)


def _shown(point: Sequence[float]) -> str:
    return ";".join(f"{round(value, 2):g}" for value in point[:2])


def sum_of(legs: Sequence[LegTold]) -> str:
    """The last line under the legs: how much of the way is known, and how long it is."""
    known = [leg for leg in legs if leg.distance_m is not None and leg.time_s is not None and math.isfinite(leg.distance_m)]
    distance_m, time_s = sum(leg.distance_m or 0.0 for leg in known), sum(leg.time_s or 0.0 for leg in known)
    rest = f"; {len(legs) - len(known)} more of unknown length" if len(known) < len(legs) else ""
    count = "1 leg" if len(known) == 1 else f"{len(known)} legs"
    return f"{count}, {distance_m:.1f} m, about {time_s:.0f} s of driving{rest}"
