"""Where the heading of dead reckoning comes from: a gyro's integrated theta, an absolute orientation sensor, or the wheels.

All three give the turn of one step. The wheels take over while the sensor is missing, and the heading never jumps when it comes back.
"""

from __future__ import annotations

import math
from typing import Protocol

from pluto_bt.maps.geometry import wrap_angle


class HeadingSource(Protocol):
    """Turns what wheels and sensor say into the turn of one step."""

    def turn(self, dt_s: float, wheel_turn_rad: float, theta_rad: float | None, bias_known: bool = True) -> tuple[float, bool]:
        """(turn in rad, True if the sensor measured it). `theta_rad` None = the sensor says nothing now."""


class WheelHeading:
    """The wheels alone: no sensor is asked (the jBot article with `yaw_enable` off)."""

    __slots__ = ()

    def turn(self, dt_s: float, wheel_turn_rad: float, theta_rad: float | None, bias_known: bool = True) -> tuple[float, bool]:
        """The wheels' turn, and False."""
        return wheel_turn_rad, False


class GyroHeading:
    """Heading since the start from an integrated gyro: its changes count, its value does not.

    While the gyro's bias is not known, the wheels teach it: a skidding robot's wheels are wrong about turns, by a share of the turn, but
    right about going straight; so whatever turn the gyro shows then is its bias. (After Borenstein and Feng, Gyrodometry, 1996.)
    Until a few such lessons are in, and wherever the wheels know of no turn (`teaches` False: the car), the wheels give the heading.
    """

    STRAIGHT_RADPS = 0.02  # the wheels turn by less: a lesson
    LESSONS = 5  # to begin with; each makes the bias better
    MEMORY = 1000  # lessons; then old ones fade, for the bias drifts

    __slots__ = ("_bias_radps", "_last_rad", "_lessons", "_teaches")

    def __init__(self, teaches: bool = True) -> None:
        self._last_rad: float | None = None
        self._teaches = teaches
        self._lessons = 0
        self._bias_radps = 0.0

    def turn(self, dt_s: float, wheel_turn_rad: float, theta_rad: float | None, bias_known: bool = True) -> tuple[float, bool]:
        """The change of theta since the last step; the wheels' turn in the first step with theta, and without it."""
        last, self._last_rad = self._last_rad, theta_rad
        if theta_rad is None or last is None:
            return wheel_turn_rad, False
        turn_rad = wrap_angle(theta_rad - last)
        if bias_known:
            return turn_rad, True
        if self._teaches and abs(wheel_turn_rad) < self.STRAIGHT_RADPS * dt_s:
            self._lessons = min(self._lessons + 1, self.MEMORY)
            self._bias_radps += ((turn_rad - wheel_turn_rad) / dt_s - self._bias_radps) / self._lessons
        if self._lessons < self.LESSONS:
            return wheel_turn_rad, False
        return turn_rad - self._bias_radps * dt_s, True


class AbsoluteHeading:
    """Heading from a sensor that knows its own (3DM-GX1), turned into the robot's frame by an offset taken while standing still.

    The article's `theta_offset`. A difference (after a drop-out, or noise) is made up at no more than `slew_radps`.
    """

    __slots__ = ("_averaged", "_offset_rad", "heading_rad", "slew_radps")

    AVERAGED_SAMPLES = 200  # of standstill; more would hardly lower the offset's error

    def __init__(self, start_rad: float, slew_radps: float = 1.0) -> None:
        self.heading_rad = start_rad
        self.slew_radps = slew_radps
        self._offset_rad = 0.0
        self._averaged = 0

    def turn(self, dt_s: float, wheel_turn_rad: float, theta_rad: float | None, bias_known: bool = True) -> tuple[float, bool]:
        """The turn that brings the heading to the sensor's, and True; without the sensor the wheels' turn, and False."""
        if theta_rad is None or not bias_known:
            self.heading_rad += wheel_turn_rad
            return wheel_turn_rad, False
        if self._average(wheel_turn_rad, theta_rad):
            return wheel_turn_rad, True
        error_rad = wrap_angle(theta_rad + self._offset_rad - self.heading_rad - wheel_turn_rad)
        reach_rad = self.slew_radps * dt_s + abs(wheel_turn_rad)
        turn_rad = wheel_turn_rad + math.copysign(min(abs(error_rad), reach_rad), error_rad)
        self.heading_rad += turn_rad
        return turn_rad, True

    def _average(self, wheel_turn_rad: float, theta_rad: float) -> bool:
        """Improve the offset while the robot has not turned yet. False once that is over."""
        seen_rad = wrap_angle(self.heading_rad - theta_rad)
        if self._averaged == 0:
            self._offset_rad, self._averaged = seen_rad, 1
            self.heading_rad += wheel_turn_rad
            return True
        if wheel_turn_rad != 0.0 or self._averaged >= self.AVERAGED_SAMPLES:
            self._averaged = self.AVERAGED_SAMPLES
            return False
        self._averaged += 1
        self._offset_rad += wrap_angle(seen_rad - self._offset_rad) / self._averaged
        return True
