"""SetPose: tell the robot where it is."""

from __future__ import annotations

import math
from typing import Final

from py_trees.common import Status

from pluto_bt.behaviours.leaf import RobotLeaf
from pluto_bt.behaviours.motion_leaf import MOTION_OUTPUTS
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.messages import Pose

WITHIN_S: Final = 1.0


class SetPose(RobotLeaf):
    """Posts the robot's pose on the map to localisation (setter −1); SUCCESS once it is believed. Does not touch the wheels.

    While another module keeps the pose (setter 1 or 2) it is refused: stop that module first, as the manual says (section 7.1).
    """

    INPUT_PORTS = {
        "pose": Port(tuple[float, float, float], True, '"x;y;theta_deg", counter-clockwise from x'),
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def initialise(self) -> None:
        """The post goes out in the first `update`."""
        self._posted: Pose | None = None

    def act(self, robot: Robot) -> Status:
        """Post once, then wait until localisation shows it as the last one accepted."""
        if self._posted is None:
            x_m, y_m, theta_deg = self.get_input("pose")
            if not all(map(math.isfinite, (x_m, y_m, theta_deg))):
                return self.fail("bad-command", "the pose is not finite")
            self._posted, self._posted_s = robot.post_pose(x_m, y_m, math.radians(theta_deg)), self.now_s()
            if self._posted is None:
                return self.fail("bad-command", "another module keeps the pose: stop it first")
        if robot.newest("Localization/Post_Pose") == self._posted:
            return self.succeed("believed")
        if self.now_s() - self._posted_s >= WITHIN_S:
            return self.fail("timeout", "localisation did not take it")
        return self.wait("posted")
