"""Nav2's planner actions by our planner: ComputePathToPose, ComputePathThroughPoses, SmoothPath."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from py_trees.common import Status
from py_trees.ports import NoDataAvailable

from pluto_bt.behaviours.destinations import Destination, Destinations
from pluto_bt.behaviours.leaf import Leaf
from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.behaviours.nav2.ports import ERRORS, SERVER, ActionLeaf, ignored
from pluto_bt.behaviours.navigation import GOAL_OCCUPIED, GOAL_OUTSIDE, NO_WAY, START_OUTSIDE, Plan
from pluto_bt.behaviours.plan_path import Planning
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.skills.outline import Planar

TOLERANCE_M: Final = 0.3  # a goal without room is reached so near to it
PATH_OUT: Final = {"path": Port(MapPath, False, "the way")}
START: Final = {"start": Port(Destination, False, "from where; without it from the robot")}
PLANNER_ID: Final = ignored("planner_id")
OFFSETS: Final = {START_OUTSIDE: 3, GOAL_OUTSIDE: 4, GOAL_OCCUPIED: 6, NO_WAY: 8}  # of the error numbers


class PathComputer(ActionLeaf, Planning):
    """What the two have in common."""

    def start_of(self, robot: Robot) -> Planar:
        """Where the way begins. Raises LookupError."""
        start = self.found_place("start", robot)
        return robot.surroundings.believed if start is None else (start.x_m, start.y_m, start.theta_rad or 0.0)

    def planned(self, robot: Robot, start: Planar, goal: Destination) -> Plan:
        """One leg."""
        return robot.navigation.plan(start, (goal.x_m, goal.y_m), goal.theta_rad, TOLERANCE_M, self.now_s())

    def refuse(self, plan: Plan) -> Status:
        """FAILURE with the number that tells why."""
        return self.fail_with(self.UNKNOWN + OFFSETS.get(plan.cause, 0), plan.reason, plan.text)

    def hand_over(self, path: MapPath) -> Status:
        """SUCCESS with a path."""
        self._set_output("path", path)
        return self.succeed(f"a path of {path.length_m:.1f} m")


class ComputePathToPose(PathComputer):
    """PlanPath under Nav2's name: the best way over the map to `goal`."""

    UNKNOWN, NUMBERS = 200, {"no-pose": 202}
    INPUT_PORTS = {
        "goal": Port(Destination, False, "where to"),
        **START,
        "use_start": Port(bool, False, "false: begin at the robot, whatever `start` says"),
        "viapoints": Port(Destinations, False, "places to pass on the way"),
        **PLANNER_ID,
        **SERVER,
    }
    OUTPUT_PORTS = {**PATH_OUT, **ERRORS}

    def plan(self, robot: Robot) -> Status:
        """One plan."""
        try:
            goal = self.found_place("goal", robot)
            start = self.start_of(robot) if value_of(self, "use_start", True) else robot.surroundings.believed
            via = [place.on(robot.map) for place in value_of(self, "viapoints", ())]
        except LookupError as error:
            return self.fail("no-path", str(error.args[0]))
        if goal is None:
            return self.fail("no-goal", "the port goal has no value; a navigation tree takes it by --port goal=VALUE")
        legs = joined(self, robot, start, [*via, goal])
        return self.hand_over(legs) if isinstance(legs, MapPath) else self.refuse(legs)


class ComputePathThroughPoses(PathComputer):
    """The best way over the map through all `goals` in order."""

    UNKNOWN, NUMBERS = 300, {"no-pose": 302}
    INPUT_PORTS = {"goals": Port(Destinations, False, "where to, one after the other"), **START, **PLANNER_ID, **SERVER}
    OUTPUT_PORTS = {**PATH_OUT, "last_reached_index": Port(int, False, "the last goal that the path reaches"), **ERRORS}

    def plan(self, robot: Robot) -> Status:
        """One plan a leg."""
        goals = value_of(self, "goals", Destinations())
        if not len(goals):
            return self.fail_with(self.UNKNOWN + 9, "no-goal", "the port goals has no value; a navigation tree takes it by --port goals=VALUE")
        try:
            legs = joined(self, robot, self.start_of(robot), [place.on(robot.map) for place in goals])
        except LookupError as error:
            return self.fail("no-path", str(error.args[0]))
        if not isinstance(legs, MapPath):
            return self.refuse(legs)
        self._set_output("last_reached_index", len(goals) - 1)
        return self.hand_over(legs)


class SmoothPath(ActionLeaf):
    """Rounds the corners of a path as far as the map leaves room."""

    UNKNOWN, NUMBERS = 500, {"no-path": 505}
    INPUT_PORTS = {
        "unsmoothed_path": Port(MapPath, False, "the path"),
        "max_smoothing_duration": Port(float, False, "of Nav2; ours takes a moment", 3.0, unit="s"),
        "check_for_collisions": Port(bool, False, "of Nav2; ours always does", "false"),
        **ignored("smoother_id"),
        **SERVER,
    }
    OUTPUT_PORTS = {
        "smoothed_path": Port(MapPath, False, "the smooth path"),
        "smoothing_duration": Port(float, False, "seconds it took", unit="s"),
        "was_completed": Port(bool, False, "always true"),
        **ERRORS,
    }

    def update(self) -> Status:
        """Answers at once."""
        path = value_of(self, "unsmoothed_path", MapPath.empty())
        if len(path) == 0 or self.robot is None:
            return self.fail("no-path", "there is no path to smooth")
        self._set_output("smoothed_path", self.robot.navigation.smoothed(path))
        self._set_output("smoothing_duration", 0.0)
        self._set_output("was_completed", True)
        return self.succeed(f"{path.length_m:.1f} m")


def joined(leaf: PathComputer, robot: Robot, start: Planar, goals: list[Destination]) -> MapPath | Plan:
    """The ways from goal to goal as one path, or the first plan that found none."""
    poses: list[Any] = []
    here, ends_turned = start, False
    for goal in goals:
        leg = leaf.planned(robot, here, goal)
        if leg.path is None:
            return leg
        poses.append(leg.path.poses if not poses else leg.path.poses[1:])
        here = (goal.x_m, goal.y_m, goal.theta_rad or 0.0)
        ends_turned = leg.path.ends_turned
    return MapPath(np.vstack(poses), round(leaf.now_s() * 1e9), ends_turned=ends_turned)


def value_of(leaf: Leaf, port: str, default: Any) -> Any:
    """The value of a port, or `default` where the mission gives none."""
    try:
        return leaf.get_input(port)
    except NoDataAvailable:
        return default
