"""PointWrist: point the laser."""

from __future__ import annotations

import math
from typing import ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.leaf import RobotLeaf
from pluto_bt.behaviours.motion_leaf import MOTION_OUTPUTS
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.messages import ActuatorState

THERE_RAD: Final = math.radians(1.0)


class PointWrist(RobotLeaf):
    """Turns the wrist; SUCCESS when both axes are within 1° of the target. Does not touch the wheels."""

    DEVICES: ClassVar = ("wrist",)
    INPUT_PORTS = {
        "pan_deg": Port(float, False, "to the left positive", 0.0, unit="deg"),
        "tilt_deg": Port(float, False, "down positive", 0.0, unit="deg"),
        "rate_dps": Port(float, False, "turn rate of both axes", 30.0, unit="deg/s", ge=0.1),
        "acceleration_dps2": Port(float, False, "acceleration of both axes", 60.0, unit="deg/s²", ge=0.1),
        "timeout_s": Port(float, False, "fails with `timeout` after so long", 15.0, unit="s", ge=0.0),
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def initialise(self) -> None:
        """The command goes out in the first `update`."""
        self._start_s, self._is_sent = self.now_s(), False

    def act(self, robot: Robot) -> Status:
        """Send once, then watch the wrist."""
        target = (math.radians(float(self.get_input("pan_deg"))), math.radians(float(self.get_input("tilt_deg"))))
        if not self._is_sent:
            self._is_sent = True
            return self._send(robot, target)
        state = robot.newest("wrist/state")
        if isinstance(state, ActuatorState) and not robot.is_stale("wrist/state"):
            off_rad = max(abs(state.position[i] - target[i]) for i in (0, 1))
            if off_rad < THERE_RAD:
                return self.succeed("pointed")
            self.feedback_message = f"{math.degrees(off_rad):.0f} deg to go"
        if self.now_s() - self._start_s >= float(self.get_input("timeout_s")):
            return self.fail("timeout", self.feedback_message)
        return Status.RUNNING

    def _send(self, robot: Robot, target: tuple[float, float]) -> Status:
        wrist = robot.platform.devices.wrist
        if wrist is None:
            return self.fail("no-device", self.lacks(robot.platform.devices))
        pan_limit, tilt_limit = math.radians(wrist.pan_limit_deg), math.radians(wrist.tilt_limit_deg)
        if not (abs(target[0]) <= pan_limit and abs(target[1]) <= tilt_limit):
            return self.fail("bad-command", f"beyond the wrist's limits of {wrist.pan_limit_deg:g} and {wrist.tilt_limit_deg:g} deg")
        rate, acceleration = math.radians(float(self.get_input("rate_dps"))), math.radians(float(self.get_input("acceleration_dps2")))
        robot.point_wrist(*target, rate, acceleration)
        return self.wait("turning")
