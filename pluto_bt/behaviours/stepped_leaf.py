"""Leaves that decide anew every 0.1 s and post velocities (T = 0): the car's skills and turning in place."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import Final

from py_trees.common import Status

from pluto_bt.behaviours.motion_leaf import MotionLeaf
from pluto_bt.behaviours.robot import Robot, pose_doubt, pose_of
from pluto_bt.blackboard.codes import CommandType
from pluto_bt.blackboard.messages import ActuatorState, FVectorState, ImuState, MarkerState, SpeedState
from pluto_bt.skills.car_goto import STEP_S
from pluto_bt.skills.car_steering import turn_rate
from pluto_bt.skills.limits import STILL, clamp
from pluto_bt.skills.reasons import NO_POSE

GYRO_WAIT_S: Final = 90.0  # the bias takes 1000 samples, 20 s at 50 Hz, and starts again when the car is moved
MARKER_WAIT_S: Final = 5.0
ELSEWHERE_WAIT_S: Final = 10.0  # so far (m) the gate lets a car have been carried in that time, and it believes then
POSE_WAIT_S: Final = 3.0
REST_WAIT_S: Final = 6.0  # the heading was wrong: it rolls to a stop, and finds its gyro's bias at rest


class SteppedLeaf(MotionLeaf):
    """Waits until it knows where the robot points, then calls `decide` every 0.1 s; early ticks change nothing."""

    NEEDS_MARKER = False
    PATIENCE_S = {"lost": ELSEWHERE_WAIT_S}  # as `_missing` says

    def begin(self, robot: Robot) -> Status | None:
        """Nothing moves before the first decision."""
        self._next_step_s = self._ready_since_s = self._last_s
        self._waits_for = self._doing = ""
        self.is_driven = True  # False while the chain holds it back
        return self.prepare(robot) or self.follow(robot)

    def prepare(self, robot: Robot) -> Status | None:
        """Look at the ports. A status ends the leaf before anything moves."""
        return None

    def restart(self) -> None:
        """The robot stood by order or for want of a sensor, and goes on."""

    @abstractmethod
    def decide(self, robot: Robot, pose: tuple[float, float, float]) -> Status:
        """One step of 0.1 s at `pose` (x m, y m, theta rad)."""

    def resume(self, robot: Robot) -> None:
        """The next step posts anyway."""
        self.restart()
        self._next_step_s, self._was_accepted, self._posted_s = self._last_s, False, self._last_s
        self._ready_since_s = self._last_s
        self._ticket = None

    def follow(self, robot: Robot) -> Status:
        """A step if one is due."""
        if self._last_s < self._next_step_s - 1e-6:
            return self.wait(self._doing)
        self._next_step_s = max(self._next_step_s + STEP_S, self._last_s + 0.5 * STEP_S)
        status = self.chain_status(robot)
        trouble = None if self._ticket is None else self.chain_trouble(robot, status)
        if trouble is not None:
            return trouble
        self.is_driven = status is None or not status.reason or status.data != STILL
        pose = pose_of(robot)
        missing, patience_s = self._missing(robot, pose)
        if missing or pose is None:
            return self._stand(robot, missing, patience_s)
        if self._waits_for:
            self._waits_for, self._heard = "", None
            self.restart()
        return self.decide(robot, pose)

    def _missing(self, robot: Robot, pose: tuple[float, float, float] | None) -> tuple[str, float]:
        """What is still needed before it can move, and for how long to wait for it."""
        devices = robot.platform.devices
        if robot.platform.body.kinematics == "ackermann" and devices.dmu is not None:  # its wheels know of no heading
            gyro = robot.newest("dmu/state")
            if not isinstance(gyro, ImuState) or not gyro.bias_known:
                return "waiting for the gyro's bias", GYRO_WAIT_S
        marker = robot.newest("car/marker") if devices.marker is not None else None
        is_seen = isinstance(marker, MarkerState) and marker.accepted_count > 0
        if self.NEEDS_MARKER and devices.marker is not None and not is_seen:
            return "waiting for an accepted marker", MARKER_WAIT_S
        if pose is None and isinstance(marker, MarkerState) and marker.is_elsewhere:
            return pose_doubt(robot).text or "the markers see it elsewhere", ELSEWHERE_WAIT_S
        if pose is not None:
            return "", 0.0
        doubt = pose_doubt(robot)
        return doubt.text or "waiting for a pose", REST_WAIT_S if doubt.reason == NO_POSE and devices.marker is not None else POSE_WAIT_S

    def _stand(self, robot: Robot, missing: str, patience_s: float) -> Status:
        if missing != self._waits_for:
            self._waits_for, self._ready_since_s = missing, self._last_s
        if self._last_s - self._ready_since_s >= patience_s:
            return self.fail(pose_doubt(robot).reason or "no-pose", f"{missing}, {patience_s:g} s in vain")
        if self._moves:
            self.post(robot, CommandType.VELOCITY)
        self._heard = pose_doubt(robot)
        if not self._heard.reason:
            self._heard = FVectorState(self._last_s, reason="no-pose", text=missing)
        return self.wait("stands")

    def wait(self, text: str) -> Status:
        """RUNNING; an early tick says the same again."""
        self._doing = text
        return super().wait(text)

    def steer(self, robot: Robot, steering_percent: float) -> None:
        """Drive with the car's steering (percent, + = right) at the port's speed."""
        speed_mps = self.max_speed_mps(robot)
        self.post(robot, CommandType.VELOCITY, velocity=(speed_mps, turn_rate(speed_mps, steering_percent, robot.platform.body)))

    def turn_in_place(self, robot: Robot, rate_radps: float) -> None:
        """Turn without driving, counter-clockwise positive."""
        limit = math.radians(robot.platform.limits.max_turn_rate_dps)
        self.post(robot, CommandType.VELOCITY, velocity=(0.0, clamp(rate_radps, limit)))


def speed_of(robot: Robot) -> float:
    """How fast the wheels turn, unsigned: the car's own sensor where there is one, else the odometry. NaN while it says nothing."""
    if robot.platform.devices.speed is not None:
        speed = robot.newest("car/speed")
        return speed.speed_mps if isinstance(speed, SpeedState) and not robot.is_stale("car/speed") else math.nan
    raw = robot.newest("ATRV2/Drive/Raw")
    return abs(raw.velocity[0]) if isinstance(raw, ActuatorState) and not robot.is_stale("ATRV2/Drive/Raw") else math.nan
