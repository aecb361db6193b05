"""CarGoTo: the car's own goto, by steering towards the goal in rounds."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np
from py_trees.common import Status

from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import NO_POINTS, Robot
from pluto_bt.behaviours.stepped_leaf import SteppedLeaf, speed_of
from pluto_bt.skills.car_goto import REACHED, CarGoto, CarState
from pluto_bt.skills.car_steering import heading_deg
from pluto_bt.skills.map_area import MapArea


class CarGoTo(SteppedLeaf):
    """Drives the car to `goal` (x;y, the same in car and world frame). Needs an accepted marker where the platform has the camera."""

    NEEDS_MARKER = True
    WAY: ClassVar = "straight"
    INPUT_PORTS = {
        "goal": Port(tuple[float, float], True, "where to", unit="m"),
        "tolerance_m": Port(float, False, "nearer counts as reached", 1.0, unit="m", ge=0.01),
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def initialise(self) -> None:
        """Nothing is shown yet."""
        super().initialise()
        self._is_shown = False

    def prepare(self, robot: Robot) -> Status | None:
        """A goal outside the map is refused before anything moves."""
        x, y = self.get_input("goal")
        area = MapArea.of(robot.map)
        if not (math.isfinite(x) and math.isfinite(y)) or not area.has_point(x, y):
            return self.fail("outside-map", f"goal {x:g};{y:g} is outside the mapped area")
        self._skill = CarGoto(x, y, float(self.get_input("tolerance_m")), area.has_line)
        robot.show_path(np.array([(x, y)]))
        self._is_shown = True
        return None

    def restart(self) -> None:
        """Its rounds begin anew: the wheels stand still, and nothing hinders them."""
        self._skill = CarGoto(self._skill.x_m, self._skill.y_m, self._skill.tolerance_m, self._skill.line_is_inside)

    def terminate(self, new_status: Status) -> None:
        """The goal is no more."""
        if self.robot is not None and self._is_shown:
            self.robot.show_path(NO_POINTS)
        self._is_shown = False
        super().terminate(new_status)

    def decide(self, robot: Robot, pose: tuple[float, float, float]) -> Status:
        """One step of the skill."""
        x, y, theta = pose
        order = self._skill.step(CarState(x, y, heading_deg(theta), speed_of(robot), self.is_driven))
        if order.ended == REACHED:
            return self.succeed(order.text)
        if order.ended:
            return self.fail(order.ended, order.text)
        self.steer(robot, order.steering_percent)
        return self.wait(f"{math.hypot(self._skill.x_m - x, self._skill.y_m - y):.2f} m to go, round {self._skill.rounds}")
