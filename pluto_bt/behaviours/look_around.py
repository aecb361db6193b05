"""LookAround: stands and looks to the sides and to the ground; what it sees stays in the local map."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from py_trees.common import Status

from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.paths import SIDES
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.behaviours.wrist_tour import AHEAD, NEAR, Look, WristTour, ground
from pluto_bt.blackboard.codes import CommandType
from pluto_bt.blackboard.messages import ActuatorState

REST_S: Final = 4.0  # a robot that does not come to rest keeps nobody waiting longer
STILL_MPS, STILL_RADPS = 0.02, 0.03
HOLD_S: Final = 1.0
NEAREST_DEG: Final = 28.0  # who stands and looks to both sides may not know the ground before his feet


class LookAround(MotionLeaf):
    """Waits until the robot stands, then looks to the sides and to the ground ahead. A robot without a wrist only looks ahead.

    A look needs a laser that can be trusted and a place to draw what it sees: while one is missing it waits, and fails with that reason.
    """

    INPUT_PORTS = {
        "side": Port(str, False, "where to look; `none` = only ahead", "both", choices=SIDES),
        "pan_deg": Port(float, False, "how far to the sides, at most as far as the wrist goes", 55.0, unit="deg", ge=0.0, le=180.0),
        "tilt_deg": Port(float, False, "how far down", 10.0, unit="deg", ge=0.0, le=90.0),
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def avoidance(self) -> str:
        """It stands and looks: for the laser alone, whatever `avoid` says."""
        return "laser"

    def initialise(self) -> None:
        """Nothing is pointed yet."""
        super().initialise()
        self._tour: WristTour | None = None
        self._is_over = False

    def begin(self, robot: Robot) -> Status | None:
        """Command the robot to stand."""
        self._begun_s = self._last_s
        self._hold(robot)
        return self.follow(robot)

    def follow(self, robot: Robot) -> Status:
        """Stand, look, done."""
        if self._last_s - self._held_s >= HOLD_S:
            self._hold(robot)
        trouble = self.chain_trouble(robot, self.chain_status(robot))
        if trouble is not None:
            return trouble
        if not robot.surroundings.look(robot, self.now_s()):
            return self.placeless(robot)
        if self._tour is None:
            if self._moves_on(robot) and self._last_s - self._begun_s < REST_S:
                return self.wait("coming to rest")
            self._tour = WristTour(self._targets(robot), self.now_s())
        if self.is_blind:
            self._tour.pause(self.now_s(), self._gap_s)
            return self.wait("waiting for the laser")
        self._is_over = self._is_over or self._tour.go_on(robot, self.now_s())
        if not self._is_over or self._held:  # who is held back here is so wherever he drives next
            return self.wait("looking around")
        return self.succeed("looked around")

    def resume(self, robot: Robot) -> None:
        """Stand again; the look goes on."""
        self._hold(robot)

    def terminate(self, new_status: Status) -> None:
        """The laser looks ahead again."""
        super().terminate(new_status)
        if self.robot is not None and self._tour is not None:
            self._tour.end(self.robot)

    def _targets(self, robot: Robot) -> Sequence[Look]:
        """The sides, the ground, and ahead."""
        wrist, side = robot.platform.devices.wrist, self.get_input("side")
        if wrist is None or side == "none":
            return [AHEAD]
        pan = math.radians(min(float(self.get_input("pan_deg")), wrist.pan_limit_deg))
        tilt = math.radians(min(float(self.get_input("tilt_deg")), wrist.tilt_limit_deg))
        panned = [Look(angle, 0.0) for angle, word in ((pan, "left"), (-pan, "right")) if side in (word, "both")]
        nearest = math.radians(min(NEAREST_DEG, wrist.tilt_limit_deg)) if side == "both" else NEAR * tilt
        return [*panned, *ground(tilt, max(tilt, nearest)), AHEAD]

    def _moves_on(self, robot: Robot) -> bool:
        raw = robot.newest("ATRV2/Drive/Raw")
        return isinstance(raw, ActuatorState) and (abs(raw.velocity[0]) > STILL_MPS or abs(raw.velocity[1]) > STILL_RADPS)

    def _hold(self, robot: Robot) -> None:
        """Command the robot to stand, again and again, so that drive does not time out."""
        self._held_s = self._last_s
        self.post(robot, CommandType.VELOCITY)
