"""Nav2's conditions on time, way and the robot. Those that measure from a beginning begin anew whenever a parent has reset them."""

from __future__ import annotations

import math
from typing import Final

from py_trees.common import Status

from pluto_bt.behaviours.leaf import NO_PORTS
from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.behaviours.nav2.condition import Nav2Condition
from pluto_bt.behaviours.nav2.planning import value_of
from pluto_bt.behaviours.nav2.ports import FRAMES, ignored
from pluto_bt.behaviours.ports import Port
from pluto_bt.blackboard.messages import BatteryState

EARLY_S: Final = 1e-9  # the difference of two times may be rounded down by so much


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
