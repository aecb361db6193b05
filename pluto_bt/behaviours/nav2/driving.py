"""Nav2's behaviours by our chain: Spin, BackUp, DriveOnHeading, Wait; NavigateToPose and NavigateThroughPoses."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import Any, Final

from py_trees.common import Status

from pluto_bt.behaviours.destinations import Destination, Destinations
from pluto_bt.behaviours.leaf import NO_PORTS
from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.nav2.planning import value_of
from pluto_bt.behaviours.nav2.ports import ERRORS, SERVER, ActionLeaf, ignored
from pluto_bt.behaviours.navigate_to import NavigateTo
from pluto_bt.behaviours.plan_path import TOLERANCE
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.behaviours.stepped_leaf import SteppedLeaf
from pluto_bt.behaviours.velocity import RefreshedLeaf
from pluto_bt.blackboard.codes import CommandType
from pluto_bt.skills.limits import clamp

SPIN_RADPS: Final = 0.6
SPUN_RAD: Final = math.radians(3.0)
ALLOWANCE: Final = {"time_allowance": Port(float, False, "fails with `timeout` after so long", 10.0, unit="s", ge=0.0)}
UNCHECKED: Final = {"disable_collision_checks": Port(bool, False, "true: as avoid=none; the stop filter stays", "false")}
OUTPUTS: Final = {**ERRORS, **MOTION_OUTPUTS}


class Behavior(ActionLeaf, MotionLeaf):
    """A motion leaf with Nav2's time allowance, and without avoidance where the collision checks are disabled."""

    def initialise(self) -> None:
        """The shorter of the two times counts."""
        super().initialise()
        self._timeout_s = min(self._timeout_s, float(self.get_input("time_allowance")))

    def avoidance(self) -> str:
        """`none` if nobody wants it."""
        return "none" if self.get_input("disable_collision_checks") else super().avoidance()


class Spin(Behavior, SteppedLeaf):
    """Turns in place by `spin_dist` radians, counter-clockwise positive."""

    UNKNOWN, NUMBERS = 700, {"timeout": 701, "no-pose": 702, "stuck": 703}
    INPUT_PORTS = {
        "spin_dist": Port(float, False, "by how much, counter-clockwise positive", 1.57, unit="rad"),
        **ALLOWANCE,
        "is_recovery": Port(bool, False, "of Nav2; means nothing here", "true"),
        **UNCHECKED,
        **SERVER,
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(OUTPUTS)

    def prepare(self, robot: Robot) -> Status | None:
        """A car cannot."""
        self._left_rad, self._heading_rad = float(self.get_input("spin_dist")), math.nan
        if robot.platform.body.kinematics == "ackermann":
            return self.fail("bad-command", "a car cannot turn in place")
        return None

    def decide(self, robot: Robot, pose: tuple[float, float, float]) -> Status:
        """Reckon what has been turned, turn on."""
        if not math.isnan(self._heading_rad):
            self._left_rad -= math.remainder(pose[2] - self._heading_rad, math.tau)
        self._heading_rad = pose[2]
        wanted_rad = float(self.get_input("spin_dist"))
        if self._left_rad * wanted_rad <= 0.0 or abs(self._left_rad) <= SPUN_RAD:
            return self.succeed(f"{math.degrees(self._left_rad):.0f} deg off")
        self.turn_in_place(robot, math.copysign(min(SPIN_RADPS, abs(self._left_rad) + 0.1), wanted_rad))
        return self.wait(f"{math.degrees(self._left_rad):.0f} deg to go")


class StraightLeaf(Behavior, RefreshedLeaf):
    """Drives so far with a speed, both signed."""

    @abstractmethod
    def wanted(self) -> tuple[float, float]:
        """(metres, metres a second), positive forwards."""

    def ends(self) -> tuple[float, float]:
        """Only the distance ends it."""
        return math.inf, abs(self.wanted()[0])

    def send(self, robot: Robot) -> None:
        """The speed, held within the limits."""
        self.post(robot, CommandType.VELOCITY, velocity=(clamp(self.wanted()[1], self.max_speed_mps(robot)), 0.0))


class BackUp(StraightLeaf):
    """Drives backwards."""

    UNKNOWN, NUMBERS = 710, {"timeout": 711, "no-pose": 712, "bad-command": 713, "bumper": 714}
    INPUT_PORTS = {
        "backup_dist": Port(float, False, "how far", 0.15, unit="m"),
        "backup_speed": Port(float, False, "how fast", 0.025, unit="m/s"),
        **ALLOWANCE,
        **UNCHECKED,
        **SERVER,
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(OUTPUTS)

    def wanted(self) -> tuple[float, float]:
        """Backwards, whatever the signs."""
        return -abs(float(self.get_input("backup_dist"))), -abs(float(self.get_input("backup_speed")))


class DriveOnHeading(StraightLeaf):
    """Drives straight on."""

    UNKNOWN, NUMBERS = 720, {"timeout": 721, "no-pose": 722, "bumper": 723, "bad-command": 724}
    INPUT_PORTS = {
        "dist_to_travel": Port(float, False, "how far, negative backwards", 0.15, unit="m"),
        "speed": Port(float, False, "how fast, of the same sign", 0.025, unit="m/s"),
        **ALLOWANCE,
        **UNCHECKED,
        **SERVER,
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(OUTPUTS)

    def begin(self, robot: Robot) -> Status | None:
        """Both must point the same way, as in Nav2."""
        distance_m, speed_mps = self.wanted()
        if distance_m * speed_mps < 0.0:
            return self.fail("bad-command", "dist_to_travel and speed have different signs")
        return super().begin(robot)

    def wanted(self) -> tuple[float, float]:
        """As it is written."""
        return float(self.get_input("dist_to_travel")), float(self.get_input("speed"))


class Wait(ActionLeaf):
    """Waits `wait_duration` seconds."""

    UNKNOWN = 740
    INPUT_PORTS = {"wait_duration": Port(float, False, "how long", 1.0, unit="s", ge=0.0), **SERVER}
    OUTPUT_PORTS = dict(ERRORS)

    def initialise(self) -> None:
        """Time counts from the first tick."""
        self._start_s = self.now_s()

    def update(self) -> Status:
        """Over, or not."""
        left_s = float(self.get_input("wait_duration")) - (self.now_s() - self._start_s)
        return self.succeed() if left_s <= 1e-9 else self.wait(f"{left_s:.1f} s to go")


class NavigateToPose(ActionLeaf, NavigateTo):
    """NavigateTo under Nav2's name."""

    UNKNOWN, NUMBERS = 9000, {"no-pose": 9002, "timeout": 9003}
    INPUT_PORTS = {**NavigateTo.INPUT_PORTS, **ignored("behavior_tree"), **SERVER}
    OUTPUT_PORTS = {**NavigateTo.OUTPUT_PORTS, **ERRORS}


class NavigateThroughPoses(ActionLeaf, NavigateTo):
    """NavigateTo to one of `goals` after the other."""

    UNKNOWN, NUMBERS = 9100, {"no-pose": 9102, "timeout": 9103}
    INPUT_PORTS = {
        "goals": Port(Destinations, True, "where to, one after the other"),
        "tolerance_m": TOLERANCE,
        **ignored("behavior_tree"),
        **SERVER,
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = {**NavigateTo.OUTPUT_PORTS, **ERRORS}

    def initialise(self) -> None:
        """Begin with the first."""
        super().initialise()
        self._at = 0

    def wanted(self) -> Destination | None:
        """The goal whose turn it is."""
        goals: Any = value_of(self, "goals", Destinations())
        return goals[self._at] if self._at < len(goals) else None

    def follow(self, robot: Robot) -> Status:
        """Where one goal is reached the next one's turn has come."""
        status = super().follow(robot)
        if status is not Status.SUCCESS:
            return status
        self._at += 1
        if self.wanted() is None:
            return status
        ended = self.begin(robot)
        return ended if ended is not None else self.wait("to the next goal")


class CancelControl(ActionLeaf):
    """Takes the command away from whoever drives: the robot stops."""

    INPUT_PORTS = dict(SERVER)
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """Zero velocity."""
        if self.robot is not None:
            self.robot.command(0)
        return self.succeed()


class CancelSpin(CancelControl):
    """As CancelControl."""


class CancelBackUp(CancelControl):
    """As CancelControl."""


class CancelDriveOnHeading(CancelControl):
    """As CancelControl."""
