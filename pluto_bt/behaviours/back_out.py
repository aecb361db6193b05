"""BackOut: back out of a place in which the robot cannot turn round."""

from __future__ import annotations

import math
from typing import ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.robot import Robot, pose_of, why_no_pose
from pluto_bt.blackboard.codes import CommandType, GotoStatus
from pluto_bt.skills.backing import MOST_M

TURNED_RAD: Final = math.radians(60.0)  # who turns so far can turn round: his corners have been as far aside as they come
TOLERANCE_M: Final = 0.3


class BackOut(MotionLeaf):
    """Backs out until the robot can turn round, and proves it by turning. A goto to a place far behind does the work: it knows what stands around,
    backs as long as that keeps it from turning, and then turns. Fails with `stuck` where it can neither turn nor go any farther back."""

    DEVICES: ClassVar = ("laser", "sonar")
    INPUT_PORTS = dict(MOTION_INPUTS)
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def begin(self, robot: Robot) -> Status | None:
        """Go where it came from."""
        if lack := self.lacks(robot.platform.devices):
            return self.fail("no-device", lack)
        pose = pose_of(robot)
        if pose is None:
            return self.fail(*why_no_pose(robot))
        self._last_rad, self._turned_rad = pose[2], 0.0
        goal = (pose[0] - MOST_M * math.cos(pose[2]), pose[1] - MOST_M * math.sin(pose[2]))
        turn_radps = math.radians(robot.platform.limits.max_turn_rate_dps)
        self.post(robot, CommandType.GOTO, goal, (self.max_speed_mps(robot), turn_radps), TOLERANCE_M)
        return None

    def follow(self, robot: Robot) -> Status:
        """Until it has turned."""
        status, pose = self.chain_status(robot), pose_of(robot)
        if status is not None and status.element[1] == GotoStatus.STUCK:
            return self.fail("stuck", f"there is no room to turn round: {status.text}")
        trouble = self.chain_trouble(robot, status)
        if trouble is not None:
            return trouble
        if pose is not None:
            self._turned_rad += math.remainder(pose[2] - self._last_rad, math.tau)
            self._last_rad = pose[2]
        turned = f"turned by {math.degrees(abs(self._turned_rad)):.0f} deg"
        is_there = status is not None and status.element[1] == GotoStatus.REACHED
        return self.succeed(turned) if abs(self._turned_rad) >= TURNED_RAD or is_there else self.wait(turned)
