"""Conditions on the robot: SUCCESS if it is so, FAILURE if not, or if it cannot be told (no robot, no value, value too old)."""

from __future__ import annotations

import math
from abc import abstractmethod

from py_trees.common import Status

from pluto_bt.behaviours.leaf import NO_PORTS, RobotLeaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot, pose_of
from pluto_bt.blackboard.codes import GotoStatus
from pluto_bt.blackboard.messages import AlarmState, BatteryState, BumperState, FVectorState, Pose
from pluto_bt.skills.map_area import MapArea


class Condition(RobotLeaf):
    """Answers at once."""

    KIND = "Condition"  # for `pluto nodes` and Groot2

    @abstractmethod
    def ask(self, robot: Robot) -> tuple[bool, str]:
        """(is it so, a short text)."""

    def act(self, robot: Robot) -> Status:
        """SUCCESS or FAILURE."""
        is_so, self.feedback_message = self.ask(robot)
        self.reason = ""
        return Status.SUCCESS if is_so else Status.FAILURE


class IsAt(Condition):
    """The robot is within `tolerance_m` of a point of the map."""

    INPUT_PORTS = {
        "goal": Port(tuple[float, float], True, "the point", unit="m"),
        "tolerance_m": Port(float, False, "how near", 0.3, unit="m", ge=0.0),
    }
    OUTPUT_PORTS = NO_PORTS

    def ask(self, robot: Robot) -> tuple[bool, str]:
        """By interface 3."""
        pose, goal = pose_of(robot), self.get_input("goal")
        if pose is None:
            return False, "no pose"
        distance_m = math.hypot(goal[0] - pose[0], goal[1] - pose[1])
        return distance_m <= float(self.get_input("tolerance_m")), f"{distance_m:.2f} m away"


class IsStuck(Condition):
    """The robot does not get on: the last goto ended stuck, its wheels turn and it does not (stasis), or its wheels cannot turn.

    The alarms of stasis and wheels stay until the Escape tree (or ReadAlarms) has read them.
    """

    INPUT_PORTS = {"sign": Port(str, False, "which sign counts", "any", choices=("any", "goto", "stasis", "wheels"))}
    OUTPUT_PORTS = NO_PORTS

    def ask(self, robot: Robot) -> tuple[bool, str]:
        """By motion's status and the alarms."""
        sign = self.get_input("sign")
        status, alarms = robot.newest("motion/status"), robot.newest("imu/alarms")
        if isinstance(alarms, AlarmState) and not robot.is_stale("imu/alarms"):
            if alarms.stasis and sign in ("any", "stasis"):
                return True, "the wheels turn, the robot does not"
            if alarms.wheels_stuck and sign in ("any", "wheels"):
                return True, "the wheels are commanded and stand still"
        elif sign in ("stasis", "wheels"):
            return False, "no alarms known"
        if sign not in ("any", "goto"):
            return False, "free"
        if not isinstance(status, FVectorState) or robot.is_stale("motion/status"):
            return False, "no status"
        return status.element[1] == GotoStatus.STUCK, status.reason


class IsTilted(Condition):
    """The robot leans from the vertical, in any direction, by more than `limit_deg`."""

    INPUT_PORTS = {"limit_deg": Port(float, False, "the limit; 0 = the platform's (alarms.tilt_limit_deg)", 0.0, unit="deg", ge=0.0, le=180.0)}
    OUTPUT_PORTS = NO_PORTS

    def ask(self, robot: Robot) -> tuple[bool, str]:
        """By the orientation sensor."""
        alarms, limit_deg = robot.newest("imu/alarms"), float(self.get_input("limit_deg"))
        if not isinstance(alarms, AlarmState) or robot.is_stale("imu/alarms"):
            return False, "no tilt known"
        tilt_deg = math.degrees(alarms.tilt_rad)
        return (tilt_deg > limit_deg if limit_deg > 0.0 else alarms.tilted), f"leans by {tilt_deg:.0f} deg"


class BumperPressed(Condition):
    """A bumper is pressed."""

    INPUT_PORTS = {"which": Port(str, False, "which panel", "any", choices=("any", "front", "back"))}
    OUTPUT_PORTS = NO_PORTS

    def ask(self, robot: Robot) -> tuple[bool, str]:
        """By the base's bumpers."""
        bumper, which = robot.newest("ATRV2/Bumper"), self.get_input("which")
        if not isinstance(bumper, BumperState) or robot.is_stale("ATRV2/Bumper"):
            return False, "no bumpers"
        front, back = bumper.front and which != "back", bumper.back and which != "front"
        return front or back, " ".join(word for word, is_in in (("front", bumper.front), ("back", bumper.back)) if is_in) or "open"


class BatteryAbove(Condition):
    """The main battery has more than `voltage_v`."""

    INPUT_PORTS = {"voltage_v": Port(float, True, "the limit", unit="V")}
    OUTPUT_PORTS = NO_PORTS

    def ask(self, robot: Robot) -> tuple[bool, str]:
        """By the base's voltmeter."""
        battery = robot.newest("ATRV2/Battery")
        if not isinstance(battery, BatteryState) or robot.is_stale("ATRV2/Battery"):
            return False, "no voltage"
        return battery.voltage_v > float(self.get_input("voltage_v")), f"{battery.voltage_v:.1f} V"


class PoseQualityAbove(Condition):
    """The pose is known well enough: 1 / (1 + s) is above `quality`, s being the position's standard deviation in metres.

    Of all directions the worst counts; 1 = exact, 0.5 = one metre.
    """

    INPUT_PORTS = {"quality": Port(float, False, "the limit", 0.5, ge=0.0, le=1.0)}
    OUTPUT_PORTS = NO_PORTS

    def ask(self, robot: Robot) -> tuple[bool, str]:
        """By the covariance of interface 3."""
        pose = robot.newest("Localization/Pose")
        if not isinstance(pose, Pose) or robot.is_stale("Localization/Pose"):
            return False, "no pose"
        quality = 1.0 / (1.0 + position_sigma_m(pose))
        return quality > float(self.get_input("quality")), f"quality {quality:.2f}"


def position_sigma_m(pose: Pose) -> float:
    """The largest standard deviation of the position in any direction: the root of the larger eigenvalue of its 2 × 2 covariance."""
    xx, xy, yy = pose.covariance[0], pose.covariance[1], pose.covariance[4]
    return math.sqrt(max(0.0, 0.5 * (xx + yy) + math.hypot(0.5 * (xx - yy), xy)))


class InsideArea(Condition):
    """The robot's centre is inside an area of the map."""

    INPUT_PORTS = {"area": Port(str, True, "id of the area", names="area")}
    OUTPUT_PORTS = NO_PORTS

    def ask(self, robot: Robot) -> tuple[bool, str]:
        """By interface 3."""
        pose, wanted = pose_of(robot), self.get_input("area")
        areas = () if robot.map is None else robot.map.areas
        polygons = tuple(tuple((float(x), float(y)) for x, y in area.points) for area in areas if area.id == wanted)
        if not polygons:
            return False, f'no area "{wanted}" in the map'
        if pose is None:
            return False, "no pose"
        is_in = MapArea(polygons).has_point(pose[0], pose[1])
        return is_in, "inside" if is_in else "outside"
