"""Nav2's conditions on goals, time, way and the robot. Those that measure from a beginning begin anew whenever a parent has reset them."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.destinations import Destination, Destinations
from pluto_bt.behaviours.leaf import NO_PORTS, Leaf
from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.behaviours.nav2.planning import value_of
from pluto_bt.behaviours.nav2.ports import FRAMES, ignored
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import pose_of
from pluto_bt.blackboard.messages import BatteryState

GOALS: Final = {
    "goal": Port(Destination, False, "the goal; without it the entry `goal`"),
    "goals": Port(Destinations, False, "the goals; without it the entry `goals`"),
}
REACHED_M: Final = 0.25
EARLY_S: Final = 1e-9


class Nav2Condition(Leaf):
    """Answers at once."""

    KIND = "Condition"

    @property
    def is_fresh(self) -> bool:
        """True if a parent has reset this node since it was ticked last."""
        return self.status is Status.INVALID

    def answer(self, is_so: bool, text: str = "") -> Status:
        """SUCCESS or FAILURE."""
        self.feedback_message = text
        return Status.SUCCESS if is_so else Status.FAILURE

    def here(self) -> tuple[float, float, float] | None:
        """Where the robot is, if that is known."""
        return pose_of(self.robot) if self.robot is not None else None


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


class TimeExpired(Nav2Condition):
    """SUCCESS when so much time has passed since it was begun, or since its last SUCCESS."""

    INPUT_PORTS = {"seconds": Port(float, False, "how long", 1.0, unit="s")}
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """Look at the clock."""
        now_s = self.now_s()
        if self.is_fresh:
            self._since_s = now_s
            return self.answer(False)
        is_over = now_s - self._since_s >= float(self.get_input("seconds")) - EARLY_S
        if is_over:
            self._since_s = now_s
        return self.answer(is_over, f"{now_s - self._since_s:.1f} s")


class DistanceTraveled(Nav2Condition):
    """SUCCESS when the robot is so far from where it was when this was begun, or when it succeeded last."""

    INPUT_PORTS = {"distance": Port(float, False, "how far, straight", 1.0, unit="m"), **FRAMES}
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """By interface 3."""
        pose = self.here()
        if pose is None:
            return self.answer(False, "no pose")
        if self.is_fresh:
            self._from = pose
        way_m = math.dist(pose[:2], self._from[:2])
        is_far = not self.is_fresh and way_m >= float(self.get_input("distance"))
        if is_far:
            self._from = pose
        return self.answer(is_far, f"{way_m:.2f} m")


class PathExpiringTimer(Nav2Condition):
    """SUCCESS when a path has been the same for so long; FAILURE on the first tick of all. Resets do not matter."""

    INPUT_PORTS = {"seconds": Port(float, False, "how long", 1.0, unit="s"), "path": Port(MapPath, False, "the path")}
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """Look at the clock, and at the path."""
        now_s, path = self.now_s(), value_of(self, "path", None)
        if not hasattr(self, "_since_s"):
            self._since_s, self._path = now_s, path
            return self.answer(False)
        if path is not None and path != self._path:
            self._since_s, self._path = now_s, path
        is_over = now_s - self._since_s >= float(self.get_input("seconds")) - EARLY_S
        if is_over:
            self._since_s = now_s
        return self.answer(is_over)


class IsBatteryLow(Nav2Condition):
    """The battery's share of its charge (0 to 1), or its voltage, is not above `min_battery`."""

    INPUT_PORTS = {
        "min_battery": Port(float, True, "the limit: a share, or volts"),
        **ignored("battery_topic"),
        "is_voltage": Port(bool, False, "the limit is in volts", "false"),
    }
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """By the base's voltmeter; the share is reckoned between the platform's full and empty voltages."""
        battery = self.robot.newest("ATRV2/Battery") if self.robot is not None else None
        if self.robot is None or not isinstance(battery, BatteryState) or self.robot.is_stale("ATRV2/Battery"):
            return self.answer(False, "no voltage")
        cell = self.robot.platform.devices.battery
        share = (battery.voltage_v - cell.empty_v) / (cell.full_v - cell.empty_v)
        level = battery.voltage_v if self.get_input("is_voltage") else min(1.0, max(0.0, share))
        return self.answer(level <= float(self.get_input("min_battery")), f"{battery.voltage_v:.1f} V")


class InitialPoseReceived(Nav2Condition):
    """SUCCESS if the flag is true."""

    INPUT_PORTS = {"initial_pose_received": Port(bool, False, "the flag; without it: a pose is known")}
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """The flag, or the pose."""
        return self.answer(bool(value_of(self, "initial_pose_received", self.here() is not None)))


class TransformAvailable(Nav2Condition):
    """SUCCESS if it is known where the robot is; there are no other frames to ask for."""

    INPUT_PORTS = {**ignored("child"), **ignored("parent")}
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """By interface 3."""
        return self.answer(self.here() is not None)


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


class IsWithinPathTrackingBounds(Nav2Condition):
    """The robot is near enough to the path that FollowPath follows. SUCCESS while nothing is followed."""

    INPUT_PORTS = {
        "max_error_left": Port(float, False, "farthest to the left of the path", 0.5, unit="m"),
        "max_error_right": Port(float, False, "farthest to the right of the path", 0.5, unit="m"),
        "max_error_heading": Port(float, False, "largest error of heading", 3.14, unit="rad"),
        "tracking_feedback": Port(list[float], False, "from FollowPath: metres to the left, radians"),
    }
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """By what FollowPath wrote last."""
        tracking = value_of(self, "tracking_feedback", [0.0, 0.0])
        left_m, turned_rad = tracking[0], abs(tracking[1])
        side = "max_error_left" if left_m >= 0.0 else "max_error_right"
        is_near = abs(left_m) <= abs(float(self.get_input(side))) and turned_rad <= abs(float(self.get_input("max_error_heading")))
        return self.answer(is_near, f"{left_m:+.2f} m, {math.degrees(turned_rad):.0f} deg")


class ErrorCondition(Nav2Condition, register=False):
    """SUCCESS if an error number is one of those that this condition is about."""

    HELPED: ClassVar[tuple[int, ...]] = ()
    INPUT_PORTS = {
        "error_code": Port(int, False, "the number, from error_code_id of an action"),
        "error_codes_to_check": Port(list[int], False, "other numbers than Nav2's"),
    }
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """A number that nobody has written yet is none of them."""
        number = value_of(self, "error_code", 0)
        return self.answer(number in (value_of(self, "error_codes_to_check", None) or self.HELPED), f"error {number}")


class AreErrorCodesPresent(ErrorCondition):
    """SUCCESS if an error number is one of `error_codes_to_check`."""


class WouldAControllerRecoveryHelp(ErrorCondition):
    """SUCCESS if a recovery may help after this error of FollowPath."""

    HELPED = (100, 104, 105, 106)


class WouldAPlannerRecoveryHelp(ErrorCondition):
    """SUCCESS if a recovery may help after this error of the planner."""

    HELPED = (200, 207, 208, 300, 307, 308)


class WouldASmootherRecoveryHelp(ErrorCondition):
    """SUCCESS if a recovery may help after this error of SmoothPath."""

    HELPED = (500, 502, 503, 504)


class WouldARouteRecoveryHelp(ErrorCondition):
    """SUCCESS if a recovery may help after this error of a route."""

    HELPED = (400, 404, 405)
