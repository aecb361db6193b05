"""The car's `goto(x, y)` (seed 002, with the decisions of DESIGN.md, section 9). One call of `step` is 0.1 s.

A round turns towards the goal until the heading error is below the angle limit, but at least one step and at most a hundred more.
Steering is proportional to the error and held until the next step. The first round steers up to 90 % and ends at 20°, later ones 50 %
and 10°. The straight line to the goal must stay in the map; it is looked at in each round.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple

from pluto_bt.skills.car_steering import bearing_deg, wrap180

STEP_S: Final = 0.1
TURN_STEPS: Final = 100
HINDERED_ROUNDS: Final = 10
HINDERED_S: Final = 3.0
PERCENT_PER_DEG: Final = 4.0

REACHED, HINDERED, OUTSIDE_MAP = "reached", "hindered", "outside-map"


class CarState(NamedTuple):
    """What the skill sees: the car frame; the wheels' speed (unsigned, NaN = not known); whether the chain lets the car drive."""

    x_m: float
    y_m: float
    heading_deg: float
    speed_mps: float
    is_driven: bool = True


class CarOrder(NamedTuple):
    """What the skill wants: steering in percent (+ = right), or its end: `reached`, `hindered`, `outside-map`."""

    steering_percent: float = 0.0
    ended: str = ""
    text: str = ""


LineTest = Callable[[float, float, float, float], bool]  # (x, y) to (x, y) stays in the map


@dataclass(slots=True)
class CarGoto:
    """One goto. `line_is_inside` says whether a straight line stays in the mapped area; a point is a line from itself to itself."""

    x_m: float
    y_m: float
    tolerance_m: float
    line_is_inside: LineTest
    rounds: int = 0
    _is_turning: bool = False
    _turn_steps: int = 0
    _steps_at_rest: int = 0

    def step(self, car: CarState) -> CarOrder:
        """The order for the next 0.1 s."""
        if self.rounds == 0 and not self.line_is_inside(self.x_m, self.y_m, self.x_m, self.y_m):
            return CarOrder(ended=OUTSIDE_MAP, text=f"goal {self.x_m:g};{self.y_m:g} is outside the mapped area")
        distance_m = math.hypot(self.x_m - car.x_m, self.y_m - car.y_m)
        if distance_m < self.tolerance_m:
            return CarOrder(ended=REACHED, text=f"{distance_m:.2f} m from the goal")
        if not self._is_turning:
            if not self.line_is_inside(car.x_m, car.y_m, self.x_m, self.y_m):
                return CarOrder(ended=OUTSIDE_MAP, text="the straight way to the goal leaves the mapped area")
            self.rounds, self._is_turning, self._turn_steps = self.rounds + 1, True, 0
        return self._hindered(car) or self._steer(car)

    def _steer(self, car: CarState) -> CarOrder:
        is_first = self.rounds == 1
        error_deg = wrap180(bearing_deg(car.x_m, car.y_m, self.x_m, self.y_m) - car.heading_deg)
        percent = min(PERCENT_PER_DEG * abs(error_deg), 90.0 if is_first else 50.0)
        if abs(error_deg) < (20.0 if is_first else 10.0):
            self._is_turning = False
        else:
            self._turn_steps += 1
            self._is_turning = self._turn_steps <= TURN_STEPS
        return CarOrder(math.copysign(percent, error_deg))

    def _hindered(self, car: CarState) -> CarOrder | None:
        """Ten rounds are over and the speed is 0 now; or it has been 0 for 3 s of driving."""
        if car.speed_mps != 0.0 or not car.is_driven:  # who is held back by his own software is not hindered by an obstacle
            self._steps_at_rest = 0
            return None
        self._steps_at_rest += 1
        rounds_over = self.rounds - 1
        if rounds_over >= HINDERED_ROUNDS and self._turn_steps == 0:
            return CarOrder(ended=HINDERED, text=f"told to drive and the wheels stand still, {rounds_over} rounds after the start")
        if self._steps_at_rest > round(HINDERED_S / STEP_S):
            return CarOrder(ended=HINDERED, text=f"told to drive for {HINDERED_S:g} s and the wheels stand still")
        return None
