"""Gyro against wheels and laser: how far has the robot turned? Whoever stands alone is not believed.

A gyro whose bias has jumped says another turn than laser *and* wheels. The difference is taken off from now on. Skidding wheels turn a robot
5 – 15 % more or less than they say (fact sheet of the ATRV-2), so they are asked no more exactly than that. Where a laser sees nothing to hold
on to, a gyro that turns a robot whose wheels run straight is judged by the wheels alone (Borenstein and Feng, Gyrodometry, 1996).
"""

from __future__ import annotations

import math
from collections import deque
from itertools import islice

from estimation.debt import Debt
from estimation.news import GYRO_DRIFT, GYRO_REFUSED, News
from estimation.reckoning import Motion, together

LEAST_RAD = 0.04  # a difference between two scans that counts; twice what 100 quiet runs show
LEAST_SUM_RAD, SUM_S = 0.05, 12.0  # and one that grew over the scans of the last seconds
LEAST_OF_LIAR_RAD = 0.025  # the same for a gyro that is known to drift
WHEELS_SHARE, WHEELS_RAD = 0.2, 0.02  # wheels and gyro agree about a turn: skidding, and counts
ALONE_RADPS, STRAIGHT_RADPS = 0.15, 0.03  # without laser: a turn of the gyro, and of wheels that run straight
STRIKES, STRIKES_S, JUMP_RADPS = 3, 15.0, math.radians(2.5)  # so many jumps of so much within such a time: this is no bias
REST_S = 4.5  # put right from outside, a car should stand so long: it rolls to a stop, and at rest the gyro's bias is found anew
SMALL_RADPS = 0.005  # what is left of a drift after the bias was measured anew
MAKE_UP_RADPS, SETTLING_RAD = 1.0, 0.3


class TurnTrial:
    """Attributes: `drift_radps` is taken off the sensor's turn; `trusts_gyro`: False = the wheels stand in; `debt`: turn still owed, rad;
    `lag_rad`: the part of the last finding that is for the time since its scan; `rests_until_s`: till then a car should stand.
    """

    def __init__(self, news: list[News], asks_wheels: bool) -> None:
        self.drift_radps, self.trusts_gyro = 0.0, True
        self.debt = Debt(MAKE_UP_RADPS)
        self.lag_rad = 0.0
        self.rests_until_s = -math.inf
        self._news, self._asks_wheels = news, asks_wheels
        self._pieces: deque[tuple[float, float, Motion]] = deque()  # stamp s, laser's turn − reckoned turn, motion: the last comparisons
        self._strikes: deque[float] = deque(maxlen=STRIKES)

    @property
    def is_settling(self) -> bool:
        """True while so much of the heading is owed that nobody should steer by it."""
        return abs(self.debt.owed) > SETTLING_RAD

    def reckoned(self, dt_s: float, wheel_turn_rad: float, turn_rad: float, is_measured: bool) -> tuple[float, bool]:
        """(turn rad to reckon with, whether a sensor measured it)."""
        if not self.trusts_gyro:
            return wheel_turn_rad, False
        return (turn_rad - self.drift_radps * dt_s if is_measured else turn_rad), is_measured

    def is_suspect(self, off_rad: float, noise_rad: float, motion: Motion) -> bool:
        """True if one comparison alone would find the heading's source wrong."""
        return abs(off_rad) > max(LEAST_RAD, noise_rad) and self._is_alone(motion)

    def weigh(self, stamp_s: float, off_rad: float, noise_rad: float, motion: Motion, lag_s: float) -> bool:
        """True if the heading's source was found wrong: at once, or little by little.

        Args:
            off_rad: what the laser saw more than was reckoned; `noise_rad`: so much says nothing.
            lag_s: so long ago that was; what was reckoned since is wrong too.
        """
        while self._pieces and stamp_s - self._pieces[0][0] > SUM_S:
            self._pieces.popleft()
        before_rad = sum(piece[1] for piece in self._pieces)
        if self.is_suspect(off_rad, noise_rad, motion):
            self.debt.owed += before_rad  # proved nothing till now
            self._accuse(off_rad, motion, lag_s, f"so do {motion.time_s:.1f} s of scans" if self._asks_wheels else "the laser denies it")
            return True
        return self._weigh_sums(off_rad, noise_rad, motion, lag_s)

    def _weigh_sums(self, off_rad: float, noise_rad: float, motion: Motion, lag_s: float) -> bool:
        """Over the shortest time in which the differences have grown enough: what was before a drift began does not water it down."""
        least_rad = max(LEAST_OF_LIAR_RAD if self.drift_radps else LEAST_SUM_RAD, noise_rad)
        sum_rad = off_rad
        for k in range(len(self._pieces) - 1, -1, -1):
            sum_rad += self._pieces[k][1]
            if abs(sum_rad) <= least_rad:
                continue
            whole = together([*(piece[2] for piece in islice(self._pieces, k, None)), motion])
            if self._is_alone(whole):
                self.debt.owed += sum(piece[1] for piece in islice(self._pieces, k))  # proved nothing till now
                self._accuse(sum_rad, whole, lag_s, f"so do the scans of {whole.time_s:.0f} s")
                return True
        return False

    def keep(self, stamp_s: float, off_rad: float, motion: Motion) -> None:
        """A comparison that is over, and proved nothing by itself."""
        self._pieces.append((stamp_s, off_rad, motion))

    def weigh_alone(self, motion: Motion) -> None:
        """The gyro against wheels that run straight, while no laser can say more."""
        is_straight = abs(motion.wheels_rad) < STRAIGHT_RADPS * motion.time_s and motion.wheels_m != 0.0
        if is_straight and motion.measured_s > 0.9 * motion.time_s and abs(motion.turn_rad) > ALONE_RADPS * motion.time_s:
            self._accuse(motion.wheels_rad - motion.turn_rad, motion, 0.0, "no laser is there to ask")

    def put_right(self, stamp_s: float, off_rad: float) -> None:
        """Somebody who sees where a car points has moved the heading by so much. What a drift there is shows at rest; too often, and it is none."""
        if stamp_s < self.rests_until_s or not self.trusts_gyro:
            return
        self.rests_until_s = stamp_s + REST_S
        if self._strike(stamp_s):
            self.refuse(f"the heading had to be put right, this time by {math.degrees(off_rad):+.0f} deg, again and again")

    def bias_moved(self, by_radps: float) -> None:
        """The gyro's own bias was measured anew, higher by so much: what was taken off here for it is not needed any more."""
        left_radps = self.drift_radps - by_radps
        self.drift_radps = left_radps if self.drift_radps and abs(left_radps) > SMALL_RADPS else 0.0
        if not self.trusts_gyro:
            self.trusts_gyro, self.drift_radps = True, 0.0
        if abs(by_radps) > SMALL_RADPS:
            self._pieces.clear()

    def refuse(self, why: str) -> None:
        """The wheels stand in."""
        self._strikes.clear()
        self.trusts_gyro, self.drift_radps = False, 0.0
        self._news.append(News(GYRO_REFUSED, f"{why}: the wheels stand in until its bias is measured anew"))

    def _is_alone(self, motion: Motion) -> bool:
        """True if the wheels do not side with the heading's source, or are that source themselves."""
        if not motion.is_measured or not self._asks_wheels:
            return True
        return abs(motion.wheels_rad - motion.turn_rad) > max(WHEELS_RAD, WHEELS_SHARE * abs(motion.wheels_rad))

    def _accuse(self, off_rad: float, motion: Motion, lag_s: float, others: str) -> None:
        """Make up for the turn, and take the drift off from now on."""
        self._pieces.clear()
        is_drift = motion.is_measured and motion.time_s < 2.0 * SUM_S  # wheels are wrong by a share; and who knows when it was, in a long gap
        by_radps = -off_rad / motion.time_s if is_drift else 0.0
        self.lag_rad = -by_radps * lag_s
        self.debt.owed = math.remainder(self.debt.owed + off_rad + self.lag_rad, math.tau)
        if not is_drift:
            return
        self.drift_radps += by_radps
        told = f"the gyro turns by {math.degrees(by_radps):+.1f} deg/s more than the robot: "
        told += f"the wheels say {motion.wheels_rad:.2f} rad, it says {motion.turn_rad:.2f}; {others}"
        self._tell_drift(told, motion.until_s if abs(by_radps) > JUMP_RADPS else None)

    def _tell_drift(self, told: str, strike_s: float | None) -> None:
        """A drift was found; `strike_s`: it was a jump, at this time."""
        if strike_s is not None and self._strike(strike_s):
            self.refuse(f"{told}. Again and again")
        else:
            self._news.append(News(GYRO_DRIFT, f"{told}. It is taken off from now on"))

    def _strike(self, stamp_s: float) -> bool:
        """True if that was one too many."""
        self._strikes.append(stamp_s)
        return len(self._strikes) == STRIKES and self._strikes[-1] - self._strikes[0] < STRIKES_S
