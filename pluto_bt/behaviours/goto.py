"""GoTo: straight to a point with simple avoidance (T = 2)."""

from __future__ import annotations

import math
from typing import ClassVar

from py_trees.common import Status

from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot, pose_of
from pluto_bt.blackboard.codes import CommandType, GotoStatus, LinkStatus
from pluto_bt.skills.map_area import MapArea


class GoTo(MotionLeaf):
    """Drives to `goal` in the frame of Localization/Pose. Fails with `stuck` when avoidance comes no nearer."""

    WAY: ClassVar = "straight"
    INPUT_PORTS = {
        "goal": Port(tuple[float, float], True, "where to", unit="m"),
        "force": Port(float, False, "weight of the goal: above 1 avoidance is weaker, below 1 stronger", 1.0, ge=0.0),
        "tolerance_m": Port(float, False, "how near counts as reached", 0.3, unit="m", ge=0.01),
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def begin(self, robot: Robot) -> Status | None:
        """One command; goto refreshes itself."""
        self._goal: tuple[float, float] = self.get_input("goal")
        if not MapArea.of(robot.map).has_point(*self._goal):
            return self.fail("outside-map", f"goal {self._goal[0]:g};{self._goal[1]:g} is outside the mapped area")
        turn_radps = math.radians(robot.platform.limits.max_turn_rate_dps)
        velocity = (self.max_speed_mps(robot), turn_radps)
        self.post(robot, CommandType.GOTO, self._goal, velocity, float(self.get_input("tolerance_m")), float(self.get_input("force")))
        return None

    def follow(self, robot: Robot) -> Status:
        """Reached, stuck, or on the way."""
        status = self.chain_status(robot)
        if status is not None and status.element[1] == GotoStatus.REACHED:
            return self.succeed(self._to_go(robot))
        if status is not None and status.element[1] == GotoStatus.STUCK:
            return self.fail("bumper" if status.element[0] in (LinkStatus.FRONT_BUMPER, LinkStatus.BACK_BUMPER) else "stuck", status.text)
        trouble = self.chain_trouble(robot, status)
        if trouble is not None:
            return trouble
        return self.wait(self._to_go(robot))

    def _to_go(self, robot: Robot) -> str:
        pose = pose_of(robot)
        return "no pose" if pose is None else f"{math.hypot(self._goal[0] - pose[0], self._goal[1] - pose[1]):.2f} m to go"
