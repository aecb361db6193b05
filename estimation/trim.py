"""What honest sensors are off by all the same: a gyro's bias that creeps, and the scale of the wheels; learned little by little from the laser.

A gyro that creeps by 0.02 deg/s and wheels that count 1 % too much are found wrong by nobody, and put a robot 10 m off after 400 m of street.
Every good comparison of two scans says a little about both. Two Kalman filters weigh it; what is too far off for them is left to the trials.
"""

from __future__ import annotations

import math

GATE = 4.0  # standard deviations: what is farther off is no creeping
GYRO_VAR = math.radians(0.02) ** 2  # rad²/s: the turn, after one second; twice the DMU's white noise (atrv2.toml) at 50 readings a second, squared
BIAS_RADPS = math.radians(0.02)  # how well the bias is known when it was just measured: 1000 samples, and the minutes since
CREEP_VAR = math.radians(0.001) ** 2  # (rad/s)²/s: random walk of the bias, twice the DMU's
TURN_NOISE_RAD = math.radians(0.02)  # of a comparison, whatever it says of itself: the wrist's angles
SCALE, SCALE_VAR_PER_M = 0.02, 0.0005**2  # wheels: how well the way is calibrated, and how the ground changes
WAY_NOISE_M, WAY_VAR_PER_M = 0.005, 0.005**2  # of a comparison; of the wheels' way after a metre
SEES_ALONG_M, LEAST_WAY_M = 0.008, 0.3  # along a bare street a laser sees no way; of a shorter one nothing is learned
MOST_SCALE = 0.05


class TurnTrim:
    """Attributes: `bias_radps`, by which the gyro turns more than the robot."""

    def __init__(self) -> None:
        self.bias_radps = 0.0
        self._bias_var = BIAS_RADPS**2

    def take(self, off_rad: float, sigma_rad: float, time_s: float) -> float:
        """Learn from one comparison; gives the part of it by which the heading should be put right at once.

        Args:
            off_rad: what the laser saw more than was reckoned, `sigma_rad` how sure that is, `time_s` over how long.

        The heading was right where the comparison began, so with B the variance of the bias, g and q those of gyro noise and creeping, its
        error e at the end has var(e) = B t² + g t + q t³/3, cov(e, bias) = B t + q t²/2.
        """
        bias_var = self._bias_var + CREEP_VAR * time_s
        turn_var = self._bias_var * time_s**2 + GYRO_VAR * time_s + CREEP_VAR * time_s**3 / 3.0
        cross = self._bias_var * time_s + 0.5 * CREEP_VAR * time_s**2
        sum_var = turn_var + sigma_rad**2 + TURN_NOISE_RAD**2
        self._bias_var = bias_var
        if abs(off_rad) > GATE * math.sqrt(sum_var):
            return 0.0
        self.bias_radps -= cross / sum_var * off_rad
        self._bias_var = bias_var - cross**2 / sum_var
        return turn_var / sum_var * off_rad

    def bias_moved(self, by_radps: float) -> None:
        """The gyro's own bias was measured anew, higher by so much."""
        self.bias_radps -= by_radps
        if abs(by_radps) > BIAS_RADPS:
            self.bias_radps, self._bias_var = 0.0, BIAS_RADPS**2


class WayTrim:
    """Attributes: `scale`, by which the wheels' way is multiplied."""

    def __init__(self) -> None:
        self.scale = 1.0
        self._var = SCALE**2

    def take(self, off_m: float, sigma_m: float, way_m: float) -> float:
        """Learn from one comparison; gives the part of it by which the position should be put right at once.

        Args:
            off_m: what the laser saw more than the `way_m` that was reckoned with the present scale; `sigma_m`: how sure that is.
        """
        self._var = min(self._var + SCALE_VAR_PER_M * abs(way_m), SCALE**2)
        if sigma_m > SEES_ALONG_M or abs(way_m) < LEAST_WAY_M:
            return 0.0
        noise_var = WAY_VAR_PER_M * abs(way_m)
        way_var = self._var * way_m**2 + noise_var
        sum_var = way_var + sigma_m**2 + WAY_NOISE_M**2
        if abs(off_m) > GATE * math.sqrt(sum_var):
            return 0.0
        gain = self._var * way_m / sum_var
        self.scale = min(max(self.scale * (1.0 + gain * off_m), 1.0 - MOST_SCALE), 1.0 + MOST_SCALE)
        self._var -= gain * way_m * self._var
        return way_var / sum_var * off_m
