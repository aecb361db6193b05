"""What honest sensors are off by all the same: a gyro's bias that creeps, the scale of the wheels; learned little by little from the laser.

A gyro that creeps by 0.02 deg/s and wheels that count 1 % too much are found wrong by nobody, and put a robot 10 m off after 400 m of street.
Every good comparison of two scans says a little about both; a Kalman filter weighs it. What is too far off is left to the trials, and nothing is
touched until it is proven: the sensors alone are best over a short way.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

GATE = 4.0  # standard deviations: a comparison that is farther off than this tells of no creeping
PROVEN = 3.0  # the same: the sum of all differences must be so far off what the comparisons alone can come to


class Honesty(NamedTuple):
    """How wrong a sensor may be that is not found wrong. Its error grows with an extent: seconds for a gyro, metres for wheels.

    Attributes:
        rate: standard deviation of the error per extent. creep_var: growth of its variance per extent.
        noise_var: variance that an extent of one adds by chance. seen: noise of a comparison besides what it says of itself.
    """

    rate: float
    creep_var: float
    noise_var: float
    seen: float


# The DMU's figures in atrv2.toml: 0.1 deg/s of noise 50 times a second; creeping reckoned at twice its random walk; the bias as 1000 samples and
# the minutes since leave it. `seen`: the wrist's angles.
OF_GYRO: Final = Honesty(math.radians(0.02), math.radians(0.001) ** 2, math.radians(0.014) ** 2, math.radians(0.02))
# Wheels calibrated by a wall (1 %) or badly (2 – 5 %), on ground that changes.
OF_WHEELS: Final = Honesty(0.02, 0.0005**2, 0.004**2, 0.005)


class Trim:
    """Attributes: `rate`: what has to be added to the sensor's figure per extent; 0 until that is proven."""

    def __init__(self, honesty: Honesty) -> None:
        self._honesty = honesty
        self._begin()

    def _begin(self) -> None:
        self.rate = self._learned = 0.0
        self._var = self._honesty.rate**2
        self._held = self._held_var = 0.0  # the sum of what should have been put right, until it is proven, and how sure that is
        self._is_proven = False

    def take(self, off: float, sigma: float, extent: float) -> float:
        """Learn from one comparison; gives by how much the sum of the past should be put right.

        Args:
            off: what the laser saw more than was reckoned, with `rate` in it, over `extent`; `sigma`: how sure that is.

        Symbols: with R the variance of the rate, q of its creeping, g of the noise, the error e over the extent t has
        var(e) = R t² + g t + q t³/3 and cov(e, rate) = R t + q t²/2.
        """
        h, size = self._honesty, abs(extent)
        seen_var = sigma**2 + h.seen**2
        error_var = self._var * extent**2 + h.noise_var * size + h.creep_var * size**3 / 3.0
        shared = (self._var + 0.5 * h.creep_var * size) * extent
        expected = (self._learned - self.rate) * extent
        surprise, sum_var = off - expected, error_var + seen_var
        self._var = min(self._var + h.creep_var * size, h.rate**2)
        if abs(surprise) > GATE * math.sqrt(sum_var):
            return 0.0
        self._learned += shared / sum_var * surprise
        self._var -= shared**2 / sum_var
        self._held += expected + error_var / sum_var * surprise
        self._held_var += seen_var
        return self._due()

    def _due(self) -> float:
        """What is held back, once it is proven."""
        self._is_proven = self._is_proven or abs(self._held) > PROVEN * math.sqrt(self._held_var)
        if not self._is_proven:
            return 0.0
        self.rate, due, self._held = self._learned, self._held, 0.0
        return due

    def moved(self, by: float) -> None:
        """The sensor itself has been calibrated anew, and gives so much less per extent from now on."""
        if abs(by) > self._honesty.rate:
            self._begin()
            return
        self._learned += by
        self.rate = self._learned if self._is_proven else 0.0
