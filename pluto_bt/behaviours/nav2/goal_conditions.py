"""Nav2's conditions on goals: has one changed, is one near."""

from __future__ import annotations

import math
from typing import Any, Final

from py_trees.common import Status

from pluto_bt.behaviours.destinations import Destination, Destinations
from pluto_bt.behaviours.leaf import NO_PORTS
from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.behaviours.nav2.condition import Nav2Condition
from pluto_bt.behaviours.nav2.planning import value_of
from pluto_bt.behaviours.nav2.ports import FRAMES
from pluto_bt.behaviours.ports import Port

GOALS: Final = {
    "goal": Port(Destination, False, "the goal; without it the entry `goal`"),
    "goals": Port(Destinations, False, "the goals; without it the entry `goals`"),
}
REACHED_M: Final = 0.25


class GoalCondition(Nav2Condition, register=False):
    """What GoalUpdated and GlobalUpdatedGoal have in common."""

    INPUT_PORTS = dict(GOALS)
    OUTPUT_PORTS = NO_PORTS

    def goals_now(self) -> tuple[Any, ...]:
        """By the ports, else by the entries of these names."""
        return tuple(value_of(self, name, self._store.get(name)) if name in self.given_ports() else self._store.get(name) for name in GOALS)

    def given_ports(self) -> tuple[str, ...]:
        """The ports that the mission gives a value."""
        return tuple(name for name in GOALS if value_of(self, name, None) is not None)


class GoalUpdated(GoalCondition):
    """SUCCESS if the goal has changed since the last tick; FAILURE on the first."""

    def update(self) -> Status:
        """Look, and remember."""
        before, self._goals = getattr(self, "_goals", ()), self.goals_now()
        return self.answer(not self.is_fresh and before != self._goals)


class GlobalUpdatedGoal(GoalCondition):
    """SUCCESS on the first tick of all, then if the goal has changed since the last one; resets do not matter."""

    def update(self) -> Status:
        """Look, and remember."""
        before, self._goals = getattr(self, "_goals", None), self.goals_now()
        return self.answer(before != self._goals)


class GoalReached(Nav2Condition):
    """The robot is within 0.25 m of a goal."""

    INPUT_PORTS = {"goal": Port(Destination, True, "the goal"), "robot_base_frame": FRAMES["robot_base_frame"]}
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """By interface 3."""
        pose = self.here()
        if self.robot is None or pose is None:
            return self.answer(False, "no pose")
        goal = self.get_input("goal").on(self.robot.map)
        away_m = math.hypot(goal.x_m - pose[0], goal.y_m - pose[1])
        return self.answer(away_m <= REACHED_M, f"{away_m:.2f} m away")


class ArePosesNear(Nav2Condition):
    """Two poses are within `tolerance` of each other."""

    INPUT_PORTS = {
        "ref_pose": Port(Destination, False, "one of them"),
        "target_pose": Port(Destination, False, "the other"),
        "global_frame": FRAMES["global_frame"],
        "tolerance": Port(float, False, "how near", 0.5, unit="m"),
    }
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """FAILURE if one of them is missing."""
        one, other = value_of(self, "ref_pose", None), value_of(self, "target_pose", None)
        if one is None or other is None:
            return self.answer(False, "a pose is missing")
        world = self.robot.map if self.robot is not None else None
        a, b = one.on(world), other.on(world)
        away_m = math.hypot(a.x_m - b.x_m, a.y_m - b.y_m)
        return self.answer(away_m <= float(self.get_input("tolerance")), f"{away_m:.2f} m")


class IsGoalNearby(Nav2Condition):
    """What is left of a path is shorter than `proximity_threshold`."""

    INPUT_PORTS = {
        "path": Port(MapPath, False, "the path"),
        "proximity_threshold": Port(float, False, "how short", 1.0, unit="m"),
        "max_robot_pose_search_dist": Port(float, False, "so far ahead of the last place the robot is looked for; negative: on all of it", -1.0),
        **FRAMES,
    }
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """By interface 3."""
        path, pose = value_of(self, "path", MapPath.empty()), self.here()
        if pose is None or not len(path):
            return self.answer(False, "no pose" if len(path) else "the path is empty")
        search_m = float(self.get_input("max_robot_pose_search_dist"))
        if search_m < 0.0 or path != getattr(self, "_path", None):
            self._path, self._place = path, 0
        last = len(path)
        if search_m >= 0.0:
            last = next((i for i in range(self._place + 1, len(path)) if path.left_m(self._place) - path.left_m(i) > search_m), len(path))
        self._place = path.nearest(pose[0], pose[1], self._place, last)
        left_m = path.left_m(self._place)
        return self.answer(left_m < float(self.get_input("proximity_threshold")), f"{left_m:.2f} m left")
