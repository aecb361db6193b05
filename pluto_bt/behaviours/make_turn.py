"""MakeTurn: the car's own maketurn; a differential robot turns in place by the same rule."""

from __future__ import annotations

import math
from typing import ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.behaviours.stepped_leaf import SteppedLeaf
from pluto_bt.skills.car_steering import heading_deg
from pluto_bt.skills.make_turn import LIMIT_S
from pluto_bt.skills.make_turn import MakeTurn as Turn

IN_PLACE_RADPS: Final = math.radians(30.0)


class MakeTurn(SteppedLeaf):
    """Turns by `angle_deg` relative to the present heading, clockwise positive (the only such angle in missions), to within 10°; 30 s: `timeout`."""

    WAY: ClassVar = "stays"
    INPUT_PORTS = {
        "angle_deg": Port(float, True, "by how much, clockwise positive", unit="deg", ge=-3600.0, le=3600.0),
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def prepare(self, robot: Robot) -> Status | None:
        """0 is done at once, whatever the robot knows."""
        self._turn: Turn | None = None
        self._turning_s = 0.0
        return self.succeed("nothing to turn") if self.get_input("angle_deg") == 0.0 else None

    def decide(self, robot: Robot, pose: tuple[float, float, float]) -> Status:
        """Full steering until the target is near."""
        heading = heading_deg(pose[2])
        if self._turn is None:
            self._turn, self._turning_s = Turn.begin(heading, float(self.get_input("angle_deg"))), self.elapsed_s
        to_go = self._turn.to_go_deg(heading)
        if self._turn.is_done(heading):
            return self.succeed(f"{to_go:.0f} deg off")
        if self.elapsed_s - self._turning_s >= LIMIT_S:
            held = self._heard
            why = f"; {held.reason}: {held.text}" if held is not None and held.reason else ""
            return self.fail("timeout", f"not turned within {LIMIT_S:g} s, {to_go:.0f} deg off{why}")
        if robot.platform.body.kinematics == "ackermann":
            self.steer(robot, self._turn.steering_percent)
        else:
            self.turn_in_place(robot, -math.copysign(IN_PLACE_RADPS, self._turn.angle_deg))
        return self.wait(f"{to_go:.0f} deg to go")
