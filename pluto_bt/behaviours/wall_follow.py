"""WallFollow: along a wall at a constant distance, the laser turned to the wall."""

from __future__ import annotations

import math
from typing import ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.behaviours.way_driven import WayDriven
from pluto_bt.blackboard.codes import CommandType
from pluto_bt.skills.wall_follow import AT_WALL

SIDES: Final = {"left": 1.0, "right": -1.0}
WRIST_DPS, WRIST_DPS2 = 40.0, 80.0
PAN_DEG: Final = 45.0  # shows the wall beside the camera, and still what comes from ahead on the other side
HEADWAY_M: Final = 0.05
HELD_S, GLANCE_S = 3.0, 2.5  # who is held for so long looks straight ahead for so long: what held him may have gone where the turned laser cannot see


class WallFollow(MotionLeaf):
    """Follows the nearest wall so that the camera, held out to the back and the side, keeps `distance_m` from it; SUCCESS after `length_m`.

    Goes round inner and outer corners and past doors and gaps. Fails with `no-wall` if there is none in reach, with `wall-lost` if it goes away.
    """

    DEVICES: ClassVar = ("laser", "sonar")
    INPUT_PORTS = {
        "side": Port(str, False, "where the wall is", "left", choices=tuple(SIDES)),
        "distance_m": Port(float, False, "between camera and wall; 0 = the platform's", 0.0, unit="m", ge=0.0, le=5.0),
        "length_m": Port(float, False, "how far to drive along the wall; the way to it does not count", math.inf, unit="m", ge=0.0),
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def begin(self, robot: Robot) -> Status | None:
        """Post the command; avoidance does the rest. `force[1..2]` carry distance and side."""
        if lack := self.lacks(robot.platform.devices):
            return self.fail("no-device", lack)
        self._side = SIDES[self.get_input("side")]
        self._length_m, self._from_m, self._way_m = float(self.get_input("length_m")), math.inf, 0.0
        self._way = WayDriven(robot)
        self._at_m, self._came_s, self._glances = math.inf, self.now_s(), False
        velocity = (self.max_speed_mps(robot), math.radians(robot.platform.limits.max_turn_rate_dps))
        self.post(robot, CommandType.WALL_FOLLOW, velocity=velocity, force=(0.0, float(self.get_input("distance_m")), self._side))
        self._point(robot, self._side * math.radians(PAN_DEG))
        return None

    def follow(self, robot: Robot) -> Status:
        """Over, in trouble, or on the way."""
        status = self.chain_status(robot)
        trouble = self.chain_trouble(robot, status)
        if trouble is not None:
            return trouble
        if status is None:
            return self.wait("starting")
        if status.reason == "stuck":
            return self.fail("stuck", status.text)
        driven_m = self._way.step(robot)
        if self._from_m == math.inf and status.text == AT_WALL:
            self._from_m = driven_m
        self._way_m = max(self._way_m, driven_m - self._from_m)
        self._glance(robot, driven_m)
        if self._way_m >= self._length_m:
            return self.succeed(f"{self._way_m:.2f} m along the wall")
        return self.wait(f"{self._way_m:.2f} m along the wall")

    def resume(self, robot: Robot) -> None:
        """The wrist too."""
        super().resume(robot)
        if self._ticket is not None:
            self._point(robot, self._side * math.radians(PAN_DEG))

    def terminate(self, new_status: Status) -> None:
        """Stand, and look ahead again."""
        moved, robot = self._moves, self.robot
        super().terminate(new_status)
        if moved and robot is not None:
            self._point(robot, 0.0)

    def _glance(self, robot: Robot, driven_m: float) -> None:
        """Held for a while, look ahead, and back at the wall, until there is headway."""
        if abs(driven_m - self._at_m) > HEADWAY_M:
            self._at_m, self._came_s = driven_m, self._last_s
        glances = (self._last_s - self._came_s) % (HELD_S + GLANCE_S) > HELD_S
        if glances != self._glances:
            self._glances = glances
            self._point(robot, 0.0 if glances else self._side * math.radians(PAN_DEG))

    def _point(self, robot: Robot, pan_rad: float) -> None:
        wrist = robot.platform.devices.wrist
        if wrist is not None:
            limit_rad = math.radians(wrist.pan_limit_deg)
            rate, acceleration = math.radians(min(WRIST_DPS, wrist.max_rate_dps)), math.radians(min(WRIST_DPS2, wrist.max_acceleration_dps2))
            robot.point_wrist(max(-limit_rad, min(limit_rad, pan_rad)), 0.0, rate, acceleration)
