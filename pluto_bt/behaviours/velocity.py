"""DriveVelocity (T = 0) and HoldHeading (T = 1): leaves that refresh one command, so that drive's 4 s timeout does not fire."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import Final

from py_trees.common import Status

from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.behaviours.standstill import Standstill
from pluto_bt.behaviours.way_driven import WayDriven
from pluto_bt.blackboard.codes import CommandType
from pluto_bt.skills.limits import STILL, clamp

REFRESH_S: Final = 1.0
STUCK_S: Final = 8.0  # who has a way to drive and comes nowhere for so long is stuck; a drive that only has a duration ends by that


class RefreshedLeaf(MotionLeaf):
    """Posts the same command every second until `duration_s` is over or `distance_m` is driven; fails with `stuck` where the way comes to no end."""

    @abstractmethod
    def send(self, robot: Robot) -> None:
        """Post the command."""

    def ends(self) -> tuple[float, float]:
        """(seconds, metres) after which it is over."""
        return float(self.get_input("duration_s")), float(self.get_input("distance_m"))

    def begin(self, robot: Robot) -> Status | None:
        """First post. A duration of 0 is over before anything moves."""
        self._duration_s, self._distance_m = self.ends()
        self._way, self._standstill = WayDriven(robot), Standstill(self.now_s())
        self._sent_s = self.elapsed_s
        if self._duration_s <= 0.0 or self._distance_m <= 0.0:
            return self.succeed("nothing to drive")
        self.send(robot)
        return None

    @property
    def _stands(self) -> bool:
        """True for a robot that is told to stand, which it can do without seeing anything."""
        command = None if self._ticket is None else self._ticket.command
        return self.is_blind and command is not None and command.flags % 10 == CommandType.VELOCITY and command.velocity == STILL

    def resume(self, robot: Robot) -> None:
        """Drive on."""
        self._was_accepted, self._sent_s = True, self.elapsed_s
        self._standstill = Standstill(self.now_s())
        self.send(robot)

    def follow(self, robot: Robot) -> Status:
        """Over, or refresh."""
        status = self.chain_status(robot)
        trouble = None if self._stands else self.chain_trouble(robot, status)
        if trouble is not None:
            return trouble
        way_m = abs(self._way.step(robot))
        if way_m >= self._distance_m or self.elapsed_s >= self._duration_s - 1e-6:
            return self.succeed(f"{way_m:.2f} m driven")
        stood_s = self._standstill.step(robot, self.now_s(), is_held=status is None or bool(status.reason))
        if stood_s > STUCK_S and self._distance_m < math.inf:
            return self.fail("stuck", f"came nowhere for {STUCK_S:g} s, {self._distance_m - way_m:.2f} m to go")
        if self.elapsed_s - self._sent_s >= REFRESH_S - 1e-6:
            self._sent_s = self.elapsed_s
            self.send(robot)
        return self.wait(f"{way_m:.2f} m driven")


ENDS: Final = {
    "duration_s": Port(float, False, "succeeds after so long", math.inf, unit="s", ge=0.0),
    "distance_m": Port(float, False, "succeeds after so much way, either direction", math.inf, unit="m", ge=0.0),
}


class DriveVelocity(RefreshedLeaf):
    """Drives with a speed (backwards negative) and a turn rate (counter-clockwise positive). With a `distance_m` it fails with `stuck` where
    the robot comes nowhere for 8 s although nothing holds it; without one it drives on."""

    INPUT_PORTS = {
        "speed_mps": Port(float, False, "forward speed, negative backwards", 0.0, unit="m/s"),
        "turn_rate_dps": Port(float, False, "turn rate, counter-clockwise positive", 0.0, unit="deg/s"),
        **ENDS,
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def send(self, robot: Robot) -> None:
        """The velocity, held within the limits; a car keeps its curvature."""
        speed, turn = float(self.get_input("speed_mps")), math.radians(float(self.get_input("turn_rate_dps")))
        limit, turn_limit = self.max_speed_mps(robot), math.radians(robot.platform.limits.max_turn_rate_dps)
        share = limit / abs(speed) if abs(speed) > limit else 1.0
        keeps_curvature = robot.platform.body.kinematics == "ackermann"
        turn = clamp(turn * share if keeps_curvature else turn, turn_limit)
        self.post(robot, CommandType.VELOCITY, velocity=(speed * share, turn))


class HoldHeading(RefreshedLeaf):
    """Turns to a heading of the map (counter-clockwise from x) and holds it at a speed. With a `distance_m` it fails with `stuck` as
    DriveVelocity does."""

    INPUT_PORTS = {
        "heading_deg": Port(float, True, "heading in the map, counter-clockwise from x", unit="deg"),
        "speed_mps": Port(float, False, "forward speed", 0.0, unit="m/s"),
        **ENDS,
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def send(self, robot: Robot) -> None:
        """Regulator mode: position[1] is the angle, velocity[0] the speed."""
        speed = clamp(float(self.get_input("speed_mps")), self.max_speed_mps(robot))
        self.post(robot, CommandType.REGULATOR, (0.0, math.radians(float(self.get_input("heading_deg")))), (speed, 0.0))
