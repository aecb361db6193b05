"""A gyro while the robot stands: it does not turn, so whatever the gyro shows is its bias. Found anew at every rest.

Unless somebody turns the robot by hand: then the rates scatter more than the gyro's noise. So what the gyro shows at rest is held back for a
second and judged: steady, then it was bias and nothing has turned. Not steady: either the bias jumped in that second, then the next one is steady
and shows it; or the robot was turned, and the turn is given out after all, bit by bit.
"""

from __future__ import annotations

import math


class GyroRest:
    """Attributes: `bias_radps`; `jumped`: the last judgement found another bias, not only a better figure of the same."""

    __slots__ = (
        "_doubted_rad", "_held_rad", "_max_spread_radps", "_mean", "_memory", "_owed_rad", "_squares", "_still_s", "_taken", "bias_radps", "jumped",
    )  # fmt: skip

    SETTLE_S = 0.3  # after the wheels have come to rest: motors' lag and filter die away
    JUDGED, LEAST = 50, 10  # samples: judged after so many; fewer than the least say nothing
    SIGMAS = 5.0
    PAY_RADPS = 1.0  # what was held back is given out no faster
    SLACK_RADPS = 0.001  # of drift since the last rest

    def __init__(self, bias_radps: float, spread_radps: float, memory: int) -> None:
        """`spread_radps`: standard deviation of the gyro at rest. `memory`: so many samples the present bias is worth."""
        self.bias_radps, self._memory = bias_radps, memory
        self._max_spread_radps = max(3.0 * spread_radps, self.SLACK_RADPS)
        self.jumped = False
        self._still_s = self._owed_rad = self._doubted_rad = 0.0
        self._begin()

    def step(self, dt_s: float, rate_radps: float, turn_rad: float, is_still: bool) -> float:
        """The turn to believe in, rad. `rate_radps`: as measured; `turn_rad`: what it came to without the bias."""
        self.jumped = False
        self._still_s = self._still_s + dt_s if is_still else 0.0
        if is_still and self._still_s >= self.SETTLE_S:
            self._hold(rate_radps, turn_rad)
            turn_rad = 0.0
        elif not is_still and (self._taken or self._doubted_rad):
            self._judge()
            self._owed_rad, self._doubted_rad = self._owed_rad + self._doubted_rad, 0.0
        if not self._owed_rad:
            return turn_rad
        pay_rad = math.copysign(min(abs(self._owed_rad), self.PAY_RADPS * dt_s), self._owed_rad)
        self._owed_rad -= pay_rad
        return turn_rad + pay_rad

    def _hold(self, rate_radps: float, turn_rad: float) -> None:
        """One sample at rest."""
        self._taken += 1
        change = rate_radps - self._mean
        self._mean += change / self._taken
        self._squares += change * (rate_radps - self._mean)
        self._held_rad += turn_rad
        if self._taken >= self.JUDGED:
            self._judge()

    def _judge(self) -> None:
        """Was it bias, or did the robot turn?"""
        taken, mean, held_rad = self._taken, self._mean, self._held_rad
        spread_radps = math.sqrt(self._squares / max(1, taken))
        self._begin()
        if taken < self.LEAST or spread_radps > self._max_spread_radps:
            self._owed_rad += self._doubted_rad
            self._doubted_rad = held_rad
            return
        off_radps = mean - self.bias_radps
        self.jumped = abs(off_radps) > self.SIGMAS * spread_radps / math.sqrt(taken) + self.SLACK_RADPS
        self.bias_radps += off_radps if self.jumped else off_radps * taken / (taken + self._memory)
        if not self.jumped:
            self._owed_rad += self._doubted_rad  # the second before was no jump of the bias
        self._doubted_rad = 0.0

    def _begin(self) -> None:
        self._taken, self._mean, self._squares, self._held_rad = 0, 0.0, 0.0, 0.0
