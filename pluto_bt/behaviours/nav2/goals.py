"""Nav2's leaves on goals and poses."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
from py_trees.common import Status

from pluto_bt.behaviours.destinations import Destination, Destinations
from pluto_bt.behaviours.leaf import Leaf, RobotLeaf
from pluto_bt.behaviours.nav2.planning import value_of
from pluto_bt.behaviours.nav2.ports import FRAMES, SERVICE
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot, pose_of, why_no_pose
from pluto_bt.blackboard.messages import ActuatorState

GOALS: Final = {"input_goals": Port(Destinations, False, "the goals")}
OUTPUT: Final = {"output_goals": Port(Destinations, False, "what is left of them")}
STATUSES_IN: Final = {"input_waypoint_statuses": Port(Any, False, "of Nav2; passed on as they are")}
STATUSES_OUT: Final = {"output_waypoint_statuses": Port(Any, False, "as they came in")}
COSTS: Final = {
    "cost_threshold": Port(float, False, "of Nav2; here the outline must fit", 254.0),
    "use_footprint": Port(bool, False, "of Nav2; the outline always counts here", "true"),
    "consider_unknown_as_obstacle": Port(bool, False, "of Nav2; what is unknown may be free here", "false"),
    **SERVICE,
}


class GoalsLeaf(Leaf):
    """Takes goals, gives goals."""

    def hand_over(self, goals: Destinations) -> Status:
        """SUCCESS with what is left."""
        self._set_output("output_goals", goals)
        statuses = value_of(self, "input_waypoint_statuses", None) if "input_waypoint_statuses" in self.input_ports() else None
        if statuses is not None:
            self._set_output("output_waypoint_statuses", statuses)
        return self.succeed(f"{len(goals)} goals")


class RemovePassedGoals(GoalsLeaf):
    """Drops the first goals as long as the robot is within `radius` of them; the last one stays."""

    INPUT_PORTS = {**GOALS, "radius": Port(float, False, "nearer counts as passed", 0.5, unit="m"), **FRAMES, **STATUSES_IN}
    OUTPUT_PORTS = {**OUTPUT, **STATUSES_OUT}

    def update(self) -> Status:
        """Answers at once; FAILURE without a pose."""
        goals: Destinations = value_of(self, "input_goals", Destinations())
        if not len(goals):
            return self.hand_over(goals)
        pose = pose_of(self.robot) if self.robot is not None else None
        if self.robot is None or pose is None:
            self.feedback_message = "no pose"
            return Status.FAILURE
        left, radius_m = list(goals), float(self.get_input("radius"))
        while len(left) > 1 and _distance_m(left[0].on(self.robot.map), pose) <= radius_m:
            left.pop(0)
        return self.hand_over(goals.having(left))


class RemoveInCollisionGoals(GoalsLeaf, RobotLeaf):
    """Drops the goals at which something stands, on the map or seen."""

    INPUT_PORTS = {**GOALS, **COSTS, **STATUSES_IN}
    OUTPUT_PORTS = {**OUTPUT, **STATUSES_OUT}

    def act(self, robot: Robot) -> Status:
        """Answers at once."""
        goals = value_of(self, "input_goals", Destinations())
        return self.hand_over(goals.having([goal for goal in goals if not is_occupied(robot, goal)]))


class CheckPoseOccupancy(RobotLeaf):
    """SUCCESS if nothing stands at a pose, neither on the map nor by what was seen."""

    INPUT_PORTS = {"pose": Port(Destination, True, "the pose"), **COSTS}
    OUTPUT_PORTS: Any = {}

    def act(self, robot: Robot) -> Status:
        """Answers at once."""
        return Status.FAILURE if is_occupied(robot, self.get_input("pose")) else Status.SUCCESS


class AppendGoalPoseToGoals(GoalsLeaf):
    """Puts a goal behind the others; FAILURE without one."""

    INPUT_PORTS = {"goal_pose": Port(Destination, False, "the goal"), **GOALS}
    OUTPUT_PORTS = dict(OUTPUT)

    def update(self) -> Status:
        """Answers at once."""
        goals, goal = value_of(self, "input_goals", Destinations()), value_of(self, "goal_pose", None)
        if goal is None:
            self.feedback_message = "there is no goal to append"
            return Status.FAILURE
        return self.hand_over(goals.having([*goals, goal]))


class GetNextFewGoals(GoalsLeaf):
    """The first `num_goals` goals; FAILURE if there is none."""

    INPUT_PORTS = {"num_goals": Port(int, True, "how many", ge=0.0), **GOALS}
    OUTPUT_PORTS = dict(OUTPUT)

    def update(self) -> Status:
        """Answers at once."""
        goals: Destinations = value_of(self, "input_goals", Destinations())
        if not len(goals):
            self.feedback_message = "there are no goals"
            return Status.FAILURE
        return self.hand_over(goals.having(goals[: int(self.get_input("num_goals"))]))


class GetCurrentPose(RobotLeaf):
    """Where the robot is; FAILURE if that is not known."""

    INPUT_PORTS = dict(FRAMES)
    OUTPUT_PORTS = {"current_pose": Port(Destination, False, "the robot's pose")}

    def act(self, robot: Robot) -> Status:
        """Answers at once."""
        pose = pose_of(robot)
        if pose is None:
            return self.fail(*why_no_pose(robot))
        self._set_output("current_pose", Destination(pose[0], pose[1], math.degrees(pose[2]), "", round(self.now_s() * 1e9), "map"))
        return self.succeed(f"{pose[0]:.2f};{pose[1]:.2f}")


class CheckStopStatus(Leaf):
    """RUNNING until the robot has stood for so long, then SUCCESS."""

    INPUT_PORTS = {
        "velocity_threshold": Port(float, False, "slower counts as standing", 0.01, unit="m/s", ge=0.0),
        "duration_stopped": Port(int, False, "for how long", 1000, unit="ms", ge=0.0),
    }
    OUTPUT_PORTS: Any = {}

    def initialise(self) -> None:
        """Time counts from the first tick."""
        self._since_s = self.now_s()

    def update(self) -> Status:
        """Look at the base's velocities."""
        raw, limit = self.robot.newest("ATRV2/Drive/Raw") if self.robot is not None else None, float(self.get_input("velocity_threshold"))
        if not isinstance(raw, ActuatorState) or max(abs(raw.velocity[0]), abs(raw.velocity[1])) > limit:
            self._since_s = self.now_s()
        stood_s = self.now_s() - self._since_s
        return self.succeed() if 1000.0 * stood_s >= int(self.get_input("duration_stopped")) - 1e-6 else self.wait(f"standing for {stood_s:.1f} s")


def is_occupied(robot: Robot, goal: Destination) -> bool:
    """True if the outline does not fit at a goal, by the map or by what was seen."""
    place = goal.on(robot.map)
    return bool(len(robot.navigation.blocked_places(np.array([[place.x_m, place.y_m]]))))


def _distance_m(place: Destination, pose: tuple[float, float, float]) -> float:
    return math.hypot(place.x_m - pose[0], place.y_m - pose[1])
