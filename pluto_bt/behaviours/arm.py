"""UnfoldArm: the arm of the robot."""

from __future__ import annotations

from typing import ClassVar

from py_trees.common import Status

from pluto_bt.behaviours.leaf import RobotLeaf
from pluto_bt.behaviours.motion_leaf import MOTION_OUTPUTS
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.messages import ActuatorState

THERE = 0.01


class UnfoldArm(RobotLeaf):
    """Unfolds the arm, or folds it again; SUCCESS when it has come to its end. Does not touch the wheels."""

    DEVICES: ClassVar = ("arm",)
    INPUT_PORTS = {
        "folded": Port(bool, False, "true: fold it", False),
        "optional": Port(bool, False, "true: a robot without an arm does nothing instead of failing", False),
        "timeout_s": Port(float, False, "fails with `timeout` after so long", 30.0, unit="s", ge=0.0),
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def initialise(self) -> None:
        """The command goes out in the first `update`."""
        self._start_s, self._is_sent = self.now_s(), False

    def act(self, robot: Robot) -> Status:
        """Send once, then watch the arm."""
        if robot.platform.devices.arm is None:
            return self.succeed("no arm") if self.get_input("optional") else self.fail("no-device", self.lacks(robot.platform.devices))
        target = 0.0 if self.get_input("folded") else 1.0
        if not self._is_sent:
            self._is_sent = True
            robot.move_arm(target)
            return self.wait("moving the arm")
        state = robot.newest("arm/state")
        if isinstance(state, ActuatorState) and not robot.is_stale("arm/state") and abs(state.position[0] - target) < THERE:
            return self.succeed("folded" if target == 0.0 else "unfolded")
        if self.now_s() - self._start_s >= float(self.get_input("timeout_s")):
            return self.fail("timeout", "the arm does not get there")
        return self.wait("moving the arm")
