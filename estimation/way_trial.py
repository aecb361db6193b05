"""Wheels against laser: how far has the robot come? Wheels that slip count a way that the laser does not see."""

from __future__ import annotations

from estimation.debt import Debt
from estimation.news import WHEEL_SLIP, WHEELS_GRIP, News
from estimation.reckoning import Motion

LEAST_M, SHARE = 0.08, 0.2  # slip: the laser sees so much less, and such a share of the way …
LEAST_GAIN = 0.08  # … and so many more of the scan's points fit where the laser sees the robot than where the wheels do
MOST_GRIP = 1.5
SLIPPING_S = 0.35  # while wheels slip they are judged anew after so long
GRIPS_AGAIN, IN_A_ROW = 0.1, 2
MAKE_UP_MPS = 0.3


class WayTrial:
    """Attributes: `grip`, the share of the wheels' way that is believed; `debt`, the way still to be made up for, m."""

    def __init__(self, news: list[News]) -> None:
        self.grip = 1.0
        self.debt = Debt(MAKE_UP_MPS)
        self._news = news
        self._gripped = 0

    def is_suspect(self, off_m: float, noise_m: float, gain: float, motion: Motion) -> bool:
        """True if wheels that were believed till now would be found wrong."""
        return self.grip == 1.0 and abs(off_m) > max(LEAST_M, SHARE * abs(motion.wheels_m), noise_m) and gain >= LEAST_GAIN

    def weigh(self, off_m: float, noise_m: float, gain: float, motion: Motion) -> bool:
        """True if the next comparison should begin anew.

        Args:
            off_m: what the laser saw more than was reckoned; `noise_m`: so much says nothing.
            gain: share of the scan that fits where the laser sees the robot, but not where the wheels do.
        """
        seen_m = motion.wheels_m * self.grip + off_m
        if self.grip != 1.0:
            return motion.time_s > SLIPPING_S and self._follow(off_m, seen_m, motion)
        if not self.is_suspect(off_m, noise_m, gain, motion):
            return False
        self.debt.owed += off_m
        told = f"the wheels say {motion.wheels_m:.2f} m, the laser {seen_m:.2f} m in {motion.time_s:.1f} s"
        if abs(motion.wheels_m) > LEAST_M:
            self.grip, self._gripped = _share(seen_m, motion), 0
            self._news.append(News(WHEEL_SLIP, f"{told}: {self.grip:.0%} of their way is believed until they agree again"))
        else:
            self._news.append(News(WHEEL_SLIP, f"{told}: the robot was pushed, or the encoders stand still"))
        return True

    def _follow(self, off_m: float, seen_m: float, motion: Motion) -> bool:
        """While the wheels slip: the laser's way counts, and how much of theirs it is."""
        self.debt.owed += off_m
        if abs(motion.wheels_m) < 0.5 * LEAST_M:
            return True
        self.grip = _share(seen_m, motion)
        self._gripped = self._gripped + 1 if abs(1.0 - self.grip) < GRIPS_AGAIN else 0
        if self._gripped >= IN_A_ROW:
            self.grip = 1.0
            self._news.append(News(WHEELS_GRIP, "wheels and laser agree again about the way"))
        return True


def _share(seen_m: float, motion: Motion) -> float:
    return min(max(seen_m / motion.wheels_m, 0.0), MOST_GRIP)
