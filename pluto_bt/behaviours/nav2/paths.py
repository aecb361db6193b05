"""Nav2's leaves on paths: cut, join, take a pose, ask whether it is free."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from py_trees.common import Status

from pluto_bt.behaviours.destinations import Destination, Destinations
from pluto_bt.behaviours.leaf import Leaf, RobotLeaf
from pluto_bt.behaviours.map_path import Array, MapPath
from pluto_bt.behaviours.nav2.planning import value_of
from pluto_bt.behaviours.nav2.ports import FRAMES, SERVICE, ignored
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot, pose_of

INPUT: Final = {"input_path": Port(MapPath, False, "the path")}
OUTPUT: Final = {"output_path": Port(MapPath, False, "what is left of it")}


class TruncatePath(Leaf):
    """Cuts off the end of a path: all within `distance` of its last pose; the new last pose points to the old one."""

    INPUT_PORTS = {**INPUT, "distance": Port(float, False, "how much is cut off, straight", 1.0, unit="m")}
    OUTPUT_PORTS = dict(OUTPUT)

    def update(self) -> Status:
        """Answers at once."""
        path: MapPath = value_of(self, "input_path", MapPath.empty())
        if len(path):
            far = np.flatnonzero(np.hypot(*(path.points - path.poses[-1, :2]).T) >= float(self.get_input("distance")))
            count = max(min(2, len(path)), int(far[-1]) + 1 if len(far) else 0)
            poses, end = path.poses[:count].copy(), path.poses[-1]
            poses[-1, 2] = math.atan2(end[1] - poses[-1, 1], end[0] - poses[-1, 0])
            path = path.having(poses, ends_turned=False)
        self._set_output("output_path", path)
        return self.succeed(f"{path.length_m:.1f} m left")


class TruncatePathLocal(Leaf):
    """Keeps the part of a path near the robot."""

    INPUT_PORTS = {
        **INPUT,
        "distance_forward": Port(float, False, "how much is kept ahead", 8.0, unit="m"),
        "distance_backward": Port(float, False, "how much is kept behind", 4.0, unit="m"),
        "robot_base_frame": FRAMES["robot_base_frame"],
        **ignored("robot_frame"),
        "transform_tolerance": Port(float, False, "of Nav2; means nothing here", 0.2, unit="s"),
        "pose": Port(Destination, False, "near this pose instead of the robot's"),
        "angular_distance_weight": Port(float, False, "what a radian of heading counts when the nearest pose is looked for, in metres", 0.0),
        "max_robot_pose_search_dist": Port(float, False, "so far ahead of the last nearest pose the next one is looked for", math.inf),
    }
    OUTPUT_PORTS = dict(OUTPUT)

    def initialise(self) -> None:
        """The place on the path is kept from run to run."""
        if not hasattr(self, "_path"):
            self._path, self._place = MapPath.empty(), 0

    def update(self) -> Status:
        """Answers at once."""
        path: MapPath = value_of(self, "input_path", MapPath.empty())
        search_m = float(self.get_input("max_robot_pose_search_dist"))
        if not math.isfinite(search_m) or path != self._path:
            self._path, self._place = path, 0
        place = self._pose()
        if place is None:
            self.feedback_message = "no pose"
            return Status.FAILURE
        if len(path):
            path = self._part(path, place, search_m)
        self._set_output("output_path", path)
        return self.succeed(f"{path.length_m:.1f} m kept")

    def _pose(self) -> tuple[float, float, float] | None:
        given: Destination | None = value_of(self, "pose", None)
        if given is not None:
            return given.x_m, given.y_m, given.theta_rad or 0.0
        return pose_of(self.robot) if self.robot is not None else None

    def _part(self, path: MapPath, pose: tuple[float, float, float], search_m: float) -> MapPath:
        steps = np.hypot(*np.diff(path.points, axis=0).T)
        last = self._place + first_beyond(steps[self._place :], search_m)
        part = path.poses[self._place : last]
        turn = np.abs((part[:, 2] - pose[2] + math.pi) % math.tau - math.pi) * float(self.get_input("angular_distance_weight"))
        nearest = self._place + int(np.argmin(np.hypot(np.hypot(part[:, 0] - pose[0], part[:, 1] - pose[1]), turn)))
        if math.isfinite(search_m):
            self._place = nearest
        end = nearest + first_beyond(steps[nearest:], float(self.get_input("distance_forward")))
        begin = nearest + 1 - first_beyond(steps[:nearest][::-1], float(self.get_input("distance_backward")))
        return path.having(path.poses[begin:end], ends_turned=path.ends_turned and end == len(path))


def first_beyond(steps: Array, distance_m: float) -> int:
    """How many poses lie within `distance_m`, of a row whose neighbours are `steps` apart; the first one always does."""
    far = np.flatnonzero(np.cumsum(steps) > distance_m)
    return int(far[0]) + 1 if len(far) else len(steps) + 1


class ConcatenatePaths(Leaf):
    """Joins two paths; FAILURE if both are empty."""

    INPUT_PORTS = {"input_path1": Port(MapPath, False, "the first"), "input_path2": Port(MapPath, False, "the second")}
    OUTPUT_PORTS = dict(OUTPUT)

    def update(self) -> Status:
        """Answers at once."""
        first, second = (value_of(self, port, MapPath.empty()) for port in ("input_path1", "input_path2"))
        if not len(first) and not len(second):
            self.feedback_message = "both paths are empty"
            return Status.FAILURE
        head = first if len(first) else second
        ends_turned = (second if len(second) else first).ends_turned
        path = head.having(np.vstack([first.poses, second.poses]), ends_turned=ends_turned)
        self._set_output("output_path", path)
        return self.succeed(f"{path.length_m:.1f} m")


class GetPoseFromPath(Leaf):
    """One pose of a path, counted from the end if `index` is negative; FAILURE if the path has it not."""

    INPUT_PORTS = {"path": Port(MapPath, False, "the path"), "index": Port(int, False, "0 = the first, -1 = the last", 0)}
    OUTPUT_PORTS = {"pose": Port(Destination, False, "the pose")}

    def update(self) -> Status:
        """Answers at once."""
        path, index = value_of(self, "path", MapPath.empty()), int(self.get_input("index"))
        if not -len(path) <= index < len(path):
            self.feedback_message = f"the path has {len(path)} poses, none of number {index}"
            return Status.FAILURE
        self._set_output("pose", path.destination(index))
        return self.succeed()


class PathCheck(RobotLeaf):
    """SUCCESS if nothing stands on a path, from the robot on: neither on the map nor by what was seen."""

    KIND = "Condition"

    def act(self, robot: Robot) -> Status:
        """Answers at once. An empty path is not free."""
        path = value_of(self, "path", MapPath.empty())
        if not len(path):
            self.feedback_message = "the path is empty"
            return Status.FAILURE
        blocked = self._blocked(robot, path)
        if "collision_poses" in self.output_ports():
            self._set_output("collision_poses", Destinations(tuple(blocked)))
        self.feedback_message = f"blocked at {blocked[0].x_m:.2f};{blocked[0].y_m:.2f}" if blocked else "free"
        return Status.FAILURE if blocked else Status.SUCCESS

    def _blocked(self, robot: Robot, path: MapPath) -> list[Destination]:
        if not robot.surroundings.look(robot, self.now_s()):
            return []
        first = path.nearest(*robot.surroundings.believed[:2])
        reach_m = float(self.get_input("max_lookahead_distance")) if "max_lookahead_distance" in self.input_ports() else -1.0
        last = first + first_beyond(np.hypot(*np.diff(path.points[first:], axis=0).T), reach_m) if reach_m >= 0.0 else len(path)
        places = robot.navigation.blocked_places(path.points[first:last])
        return [path.destination(first + int(place)) for place in places]


COSTS: Final = {
    "path": Port(MapPath, False, "the path"),
    "max_cost": Port(int, False, "of Nav2; here the outline must fit", 254),
    "consider_unknown_as_obstacle": Port(bool, False, "of Nav2; what is unknown may be free here", "false"),
    **SERVICE,
}


class IsPathValid(PathCheck):
    """SUCCESS if nothing stands on a path (the older name of ValidatePath)."""

    INPUT_PORTS = dict(COSTS)
    OUTPUT_PORTS = {"collision_poses": Port(Destinations, False, "where it is blocked")}


class ValidatePath(PathCheck):
    """SUCCESS if nothing stands on a path, from the robot on."""

    KIND = "Action"
    INPUT_PORTS = {
        **COSTS,
        **ignored("layer_name"),
        **ignored("footprint"),
        "stop_at_first_collision": Port(bool, False, "of Nav2; here all are told", "true"),
        "max_lookahead_distance": Port(float, False, "so far ahead it is looked at; negative: to its end", -1.0),
    }
    OUTPUT_PORTS = dict(IsPathValid.OUTPUT_PORTS)
