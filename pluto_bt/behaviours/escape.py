"""Leaves of the library's Escape tree: ReadAlarms and TryTurn."""

from __future__ import annotations

import math
from typing import Final

from py_trees.common import Status

from pluto_bt.behaviours.leaf import NO_PORTS, RobotLeaf
from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.codes import CommandType
from pluto_bt.blackboard.messages import ActuatorState, AlarmState, ImuState

TRY_RADPS: Final = math.radians(40.0)
FOLLOWS_SHARE: Final = 0.5  # of the wheels' turn; skidding alone loses less
PATIENCE_S: Final = 3.0  # beyond the time that the turn should take


class ReadAlarms(RobotLeaf):
    """Takes back the alarms of stasis and stuck wheels, so that new ones can be raised; SUCCESS once they are gone."""

    INPUT_PORTS = NO_PORTS
    OUTPUT_PORTS = NO_PORTS

    def initialise(self) -> None:
        """The letter goes out in the first `update`."""
        self._words = ""
        self._posted_s: float | None = None

    def act(self, robot: Robot) -> Status:
        """Read, then wait for a newer state, so that the next leaf does not see the old alarm."""
        alarms = robot.newest("imu/alarms")
        if not isinstance(alarms, AlarmState) or robot.is_stale("imu/alarms"):
            return self.succeed("no alarms known")
        if self._posted_s is None:
            self._posted_s, self._words = self.now_s(), alarm_words(alarms)
            robot.read_alarms()
        return self.succeed(self._words) if alarms.stamp_s > self._posted_s else self.wait(self._words)


class TryTurn(MotionLeaf):
    """Turns its wheels by `angle_deg` (clockwise positive) and looks whether the body follows.

    SUCCESS: the robot is free. FAILURE `stuck`: the wheels turn alone, or not at all; `tilted`: it leans too far.
    Without an orientation sensor only the wheels are asked.
    """

    INPUT_PORTS = {
        "angle_deg": Port(float, False, "by how much, clockwise positive", 20.0, unit="deg", ge=-180.0, le=180.0),
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def begin(self, robot: Robot) -> Status | None:
        """Turn, unless that would be dangerous."""
        alarms = robot.newest("imu/alarms")
        if isinstance(alarms, AlarmState) and alarms.tilted and not robot.is_stale("imu/alarms"):
            return self.fail("tilted", f"leans by {math.degrees(alarms.tilt_rad):.0f} deg")
        self._asked_rad = -math.radians(float(self.get_input("angle_deg")))
        self._wheels_rad = self._body_rad = 0.0
        self._last = _headings(robot)
        self._send(robot)
        return None

    def resume(self, robot: Robot) -> None:
        """What turned during the pause does not count."""
        self._last = _headings(robot)
        self._send(robot)

    def follow(self, robot: Robot) -> Status:
        """Add up both turns until the wheels are round."""
        trouble = self.chain_trouble(robot, self.chain_status(robot))
        if trouble is not None:
            return trouble
        now, last = _headings(robot), self._last
        self._last = now
        self._wheels_rad += _step(last[0], now[0])
        self._body_rad += _step(last[1], now[1])
        wheels_deg, body_deg = math.degrees(self._wheels_rad), math.degrees(self._body_rad)
        if abs(self._wheels_rad) >= abs(self._asked_rad):
            if now[1] is None or self._body_rad * self._wheels_rad >= FOLLOWS_SHARE * self._wheels_rad**2:
                return self.succeed("free: the body turns with the wheels")
            return self.fail("stuck", f"the wheels say {wheels_deg:.0f} deg, the body {body_deg:.0f} deg")
        if self.elapsed_s >= abs(self._asked_rad) / TRY_RADPS + PATIENCE_S:
            return self.fail("stuck", f"the wheels turned by {wheels_deg:.0f} deg only")
        return self.wait(f"wheels {wheels_deg:.0f} deg, body {body_deg:.0f} deg")

    def _send(self, robot: Robot) -> None:
        limit_radps = math.radians(robot.platform.limits.max_turn_rate_dps)
        self.post(robot, CommandType.VELOCITY, velocity=(0.0, math.copysign(min(TRY_RADPS, limit_radps), self._asked_rad)))


def alarm_words(alarms: AlarmState) -> str:
    """The alarms in force, as a person would say them."""
    words = ("stasis", alarms.stasis), ("wheels stuck", alarms.wheels_stuck), (f"leans by {math.degrees(alarms.tilt_rad):.0f} deg", alarms.tilted)
    return ", ".join(word for word, is_on in words if is_on) or "no alarm"


def _headings(robot: Robot) -> tuple[float | None, float | None]:
    """(wheels', body's) heading in rad; None for what is missing or stale."""
    raw = robot.newest("ATRV2/Drive/Raw")
    wheels = raw.position[1] if isinstance(raw, ActuatorState) and not robot.is_stale("ATRV2/Drive/Raw") else None
    imu = robot.platform.devices.imu
    topic = "imu/state" if imu is not None and imu.absolute else "dmu/state"
    body = robot.newest(topic)
    return wheels, body.theta_rad if isinstance(body, ImuState) and not robot.is_stale(topic) else None


def _step(last: float | None, now: float | None) -> float:
    """The change of an angle, 0 across a gap."""
    return 0.0 if last is None or now is None else math.remainder(now - last, math.tau)
