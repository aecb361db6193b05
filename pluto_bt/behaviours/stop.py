"""Stop and Release: let go of the robot."""

from __future__ import annotations

from typing import ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.codes import CommandType, MotionCommand, MotionStatus
from pluto_bt.blackboard.messages import ActuatorState, FVectorState

AT_REST_MPS: Final = 0.01
AT_REST_RADPS: Final = 0.02
REST_WITHIN_S: Final = 10.0


class Stop(MotionLeaf):
    """Zero velocity; SUCCESS once the wheels stand still."""

    DRIVES: ClassVar = False
    INPUT_PORTS = dict(MOTION_INPUTS)
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def begin(self, robot: Robot) -> Status | None:
        """Command it."""
        self.post(robot, CommandType.VELOCITY)
        return None

    def follow(self, robot: Robot) -> Status:
        """At rest yet? A chain that is in trouble brings the robot to rest too, so only the wheels are asked."""
        raw = robot.newest("ATRV2/Drive/Raw")
        if isinstance(raw, ActuatorState) and not robot.is_stale("ATRV2/Drive/Raw"):
            speed, turn = abs(raw.velocity[0]), abs(raw.velocity[1])
            if raw.stamp_s > self._posted_s and speed < AT_REST_MPS and turn < AT_REST_RADPS:
                return self.succeed("at rest")
            text = f"{speed:.2f} m/s"
        else:
            text = "no odometry"
        return self.fail("timeout", f"not at rest after {REST_WITHIN_S:g} s: {text}") if self.elapsed_s >= REST_WITHIN_S else self.wait(text)


class Release(MotionLeaf):
    """cmdFlags −1: stops the threads of motion and avoidance, so that somebody else may command the drive."""

    DRIVES: ClassVar = False
    INPUT_PORTS = dict(MOTION_INPUTS)
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def begin(self, robot: Robot) -> Status | None:
        """Command it; no zero velocity follows, for the robot is let go."""
        refused = robot.command(MotionCommand.RELEASE).refused
        return self.fail(refused, "motion's inbox belongs to another") if refused else None

    def follow(self, robot: Robot) -> Status:
        """Released once motion's thread has stopped."""
        status = robot.newest("motion/status")
        if isinstance(status, FVectorState) and len(status.element) > 3 and status.element[3] == MotionStatus.STOPPED_THREAD:
            return self.succeed("released")
        return self.fail("timeout", "motion goes on") if self.elapsed_s >= 1.0 else self.wait("releasing")

    def resume(self, robot: Robot) -> None:
        """Nothing to repeat."""
