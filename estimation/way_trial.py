"""Wheels against laser: how far has the robot come? Wheels that slip count a way that the laser does not see.

Wheels that are believed are asked whether they slip. From then on the share of their way that is believed, the grip, is followed by a Kalman
filter: each comparison tells of it as well as the laser sees along the way, so a bare street or a turn on the spot teaches nothing, and
what nobody has seen since makes the position less sure.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from estimation.debt import Debt
from estimation.news import WHEEL_SLIP, WHEELS_GRIP, News
from estimation.reckoning import Motion

LEAST_M, SHARE = 0.08, 0.1  # slip: the laser sees so much less, and such a share of the way …
LEAST_GAIN = 0.06  # … and so many more of the scan's points fit where the laser sees the robot than where the wheels do
WONDER_GAIN = 0.03  # fewer, and somebody who walks beside the robot would explain them too
ASLANT_M, ASLANT_GAIN = 0.04, 0.2  # a bare wall, a little aslant, that much of a scan sees so far aside: who knows how far the robot came along it
SIGMAS = 5.0
MOST_GRIP = 1.5
NEW_SIGMA = 0.3  # of a grip that was found just now, or has changed
WANDERS = 0.15  # of a grip after one second: the ground changes
SEEN_M = 0.007  # noise of a comparison besides what it says of itself
SURPRISING = 3.0  # standard deviations: the grip has changed
GRIPS_AGAIN, SURE, IN_A_ROW = 0.05, 0.1, 3
MAKE_UP_MPS = 0.3


class Seen(NamedTuple):
    """What a comparison of two scans tells of the way.

    Attributes:
        off_m: what the laser saw more than was reckoned; `sigma_m`: its standard deviation.
        aside_m: what it saw besides, sideways; a robot on wheels cannot go there.
        gain: share of the scan that fits where the laser sees the robot, but not where it was reckoned to be.
    """

    off_m: float
    sigma_m: float
    aside_m: float
    gain: float


class Farther(NamedTuple):
    """What a finding adds to what was reckoned: the way until the scan, m, and the share of the wheels' way since then."""

    way_m: float = 0.0
    share: float = 0.0


class WayTrial:
    """Attributes: `grip`, the share of the wheels' way that is believed; `debt`, the way still to be made up for, m."""

    def __init__(self, news: list[News]) -> None:
        self.grip = 1.0
        self.debt = Debt(MAKE_UP_MPS)
        self._news = news
        self._grip_var = 0.0
        self._wheels_m = self._unseen_m = 0.0  # the wheels' way at the last comparison; what they have counted since
        self._wonder_m = self._given_up_m2 = 0.0  # what was seen too little of to be believed; what nobody will ever know
        self._gripped = 0

    @property
    def is_slipping(self) -> bool:
        """True while the wheels' way is not believed as it is."""
        return self.grip != 1.0

    @property
    def doubt_m(self) -> float:
        """Standard deviation: so far off the robot may be by what is owed, by what nobody has seen of a slipping way, and by what is suspected."""
        if self.grip == 1.0 and not (self.debt.owed or self._wonder_m):
            return 0.0
        return math.sqrt(self._grip_var * self._unseen_m**2 + self.debt.owed**2 + self._wonder_m**2)

    def reckoned(self, dt_s: float, wheels_m: float) -> tuple[float, float]:
        """(way m to reckon with, variance m² that is added for good) of one step."""
        added_m2 = self._given_up_m2
        if added_m2:
            self._given_up_m2 = 0.0
        if self.grip == 1.0:
            return wheels_m, added_m2
        self._grip_var = min(self._grip_var + WANDERS**2 * dt_s, NEW_SIGMA**2)
        self._unseen_m += abs(wheels_m)
        return wheels_m * self.grip, added_m2

    def give_up(self, is_lost: bool) -> None:
        """What is doubted now nobody will find out. `is_lost`: neither what the wheels have slipped since the last comparison."""
        self._given_up_m2 += self._wonder_m**2
        self._wonder_m = 0.0
        if is_lost:
            self._given_up_m2 += self._grip_var * self._unseen_m**2
            self._unseen_m = 0.0

    def is_suspect(self, seen: Seen, motion: Motion) -> bool:
        """True if wheels that were believed till now would be found wrong. With fewer points than that takes they may be wrong all the same."""
        noise_m = max(LEAST_M, SHARE * abs(motion.wheels_m), SIGMAS * seen.sigma_m)
        is_off = not self.is_slipping and abs(seen.off_m) > noise_m
        self._wonder_m = 0.0
        if is_off and seen.gain >= WONDER_GAIN:
            self._wonder_m = seen.off_m
        elif not self.is_slipping and abs(seen.aside_m) > ASLANT_M and seen.gain >= ASLANT_GAIN:
            self._wonder_m = motion.wheels_m
        return is_off and seen.gain >= LEAST_GAIN

    def weigh(self, seen: Seen, motion: Motion, wheels_m: float) -> Farther | None:
        """What has to be put right; None if nothing is wrong.

        Args:
            motion: as reckoned, between the two scans. wheels_m: the way that the wheels have counted since the start.
        """
        since_m, self._wheels_m, grip = wheels_m - self._wheels_m, wheels_m, self.grip
        if self.is_slipping:
            way_m = self._follow(seen, since_m)
        elif self.is_suspect(seen, motion):
            way_m = self._find(seen, motion)
            self._wonder_m = 0.0
        else:
            return None
        return Farther(way_m, self.grip - grip)

    def _find(self, seen: Seen, motion: Motion) -> float:
        seen_m = motion.wheels_m + seen.off_m
        told = f"the wheels say {motion.wheels_m:.2f} m, the laser {seen_m:.2f} m in {motion.time_s:.1f} s"
        if abs(motion.wheels_m) > LEAST_M:
            self.grip, self._grip_var = min(max(seen_m / motion.wheels_m, 0.0), MOST_GRIP), NEW_SIGMA**2
            self._unseen_m, self._gripped = 0.0, 0
            self._news.append(News(WHEEL_SLIP, f"{told}: {self.grip:.0%} of their way is believed until they agree again"))
        else:
            self._news.append(News(WHEEL_SLIP, f"{told}: the robot was pushed, or the encoders stand still"))
        return seen.off_m

    def _follow(self, seen: Seen, since_m: float) -> float:
        """While the wheels slip: learn how much they grip; gives the part of the difference that is believed.

        Symbols: with v the variance of the grip, w the wheels' way since the last comparison and R the comparison's variance, the difference
        has the variance v w² + R, and the gains are v w² / (v w² + R) for the way and v w / (v w² + R) for the grip.
        """
        noise_var = seen.sigma_m**2 + SEEN_M**2
        if abs(seen.off_m) > SURPRISING * math.sqrt(self._grip_var * since_m**2 + noise_var):
            self._grip_var = NEW_SIGMA**2
            if abs(since_m) < 0.5 * LEAST_M and seen.gain >= LEAST_GAIN:
                return seen.off_m  # wheels that hardly turn do not tell: the robot was pushed
        sum_var = self._grip_var * since_m**2 + noise_var
        share = self._grip_var * since_m**2 / sum_var
        self.grip = min(max(self.grip + self._grip_var * since_m / sum_var * seen.off_m, 0.0), MOST_GRIP)
        self._grip_var *= 1.0 - share
        self._unseen_m *= 1.0 - share
        is_whole = abs(1.0 - self.grip) < GRIPS_AGAIN and self._grip_var < SURE**2
        self._gripped = self._gripped + 1 if is_whole and since_m else 0
        if self._gripped >= IN_A_ROW or self.grip == 1.0:
            self.grip, self._unseen_m = 1.0, 0.0
            self._news.append(News(WHEELS_GRIP, "wheels and laser agree again about the way"))
        return share * seen.off_m
