"""The heading regulator of `cmdFlags` 1 and 11: turn smoothly to an angle, then hold the straight line at the given speed."""

from __future__ import annotations

import math

from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.skills.limits import Limits, Twist, clamp

GAIN_PER_S = 2.0  # turn rate for each radian of error: settles in about 1.5 s without overshoot behind a 0.1 s lag
BRAKING_SHARE = 0.6  # of the turn acceleration is planned for, the rest is in reserve for the lag of the motors
SLOW_ANGLE_RAD = math.radians(50.0)  # at this error the robot turns on the spot; half of it halves the forward speed
CAR_CREEP = 0.3  # share of the speed that a car keeps, since it turns only while it rolls
LOOK_AHEAD_M = 1.0  # a sideways offset is steered out over about this distance
MAX_BACK_RAD = math.radians(15.0)  # the steepest way back onto the line
ON_COURSE_RAD = math.radians(2.0)  # the turn has ended
NEW_LINE_RAD = math.radians(2.0)  # a target that moves more than this begins a new line


def regulate(error_rad: float, speed_mps: float, limits: Limits, max_turn_rate_radps: float = 0.0) -> Twist:
    """The twist that turns `error_rad` (target minus heading) away while driving at up to `speed_mps`.

    Args:
        max_turn_rate_radps: lowers the limit where > 0.
    """
    size_rad = abs(error_rad)
    most_radps = min(max_turn_rate_radps or math.inf, limits.turn_rate_radps)
    braking_radps = math.sqrt(2.0 * BRAKING_SHARE * limits.turn_acceleration_radps2 * size_rad)
    turn_rate_radps = math.copysign(min(GAIN_PER_S * size_rad, braking_radps, most_radps), error_rad)
    share = max(0.0, 1.0 - size_rad / SLOW_ANGLE_RAD)
    if limits.min_turn_radius_m > 0.0:
        share = max(share, CAR_CREEP)
    return speed_mps * share, turn_rate_radps


class Line:
    """The straight line that is held: how far the robot has come off it sideways since it was on course."""

    def __init__(self) -> None:
        self._target_rad: float | None = None
        self._distance_m = 0.0
        self._is_on_course = False
        self.offset_m = 0.0  # to the left of the line

    def error_rad(self, target_rad: float, heading_rad: float, distance_m: float) -> float:
        """The heading error that leads back onto the line.

        Args:
            target_rad, heading_rad: in the same frame.
            distance_m: the odometer; it counts down when the robot backs.
        """
        error_rad = wrap_angle(target_rad - heading_rad)
        driven_m, self._distance_m = distance_m - self._distance_m, distance_m
        is_new = self._target_rad is None or abs(wrap_angle(target_rad - self._target_rad)) > NEW_LINE_RAD
        self._target_rad = target_rad
        if is_new or abs(error_rad) > SLOW_ANGLE_RAD / 2.0:
            self.offset_m, self._is_on_course = 0.0, False
        self._is_on_course = self._is_on_course or abs(error_rad) < ON_COURSE_RAD
        if not self._is_on_course:
            return error_rad  # the line begins where the turn ends
        self.offset_m -= driven_m * math.sin(error_rad)
        back_rad = clamp(math.atan2(self.offset_m, LOOK_AHEAD_M), MAX_BACK_RAD)
        return error_rad - math.copysign(back_rad, back_rad * driven_m) if driven_m else error_rad
