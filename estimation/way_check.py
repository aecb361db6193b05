"""What the laser says of the robot's way: whether the wheels slip, how far they grip, and what honest ones count too much.

What is found is put right in the sums at once, so that later scans are compared with what is known, and owed to dead reckoning, which never jumps.
"""

from __future__ import annotations

import math

from estimation.doubt import Doubt
from estimation.key_scan import KeyScan, is_decisive
from estimation.news import News
from estimation.reckoning import Motion, Reckoning
from estimation.scan_match import ScanStep
from estimation.trim import OF_WHEELS, Trim
from estimation.way_trial import Seen, WayTrial

SEES_ALONG_M, LEAST_WAY_M = 0.008, 0.3  # along a bare street a laser sees no way; nothing is learned there, nor from less of a way


class WayCheck:
    """Attributes: `trial` of the wheels; `since_m`: so much farther than reckoned the last scan has seen the robot."""

    def __init__(self, news: list[News], reckoning: Reckoning) -> None:
        self.trial = WayTrial(news)
        self.doubt = Doubt()
        self.since_m = 0.0
        self._trim = Trim(OF_WHEELS)
        self._reckoning = reckoning
        self._has_slipped = False  # since this key scan: nothing is learned of honest wheels

    def counted_m(self, way_m: float) -> float:
        """The wheels' way with what they count too much taken off."""
        return way_m + self._trim.rate * way_m

    def place(self, scan: KeyScan, key: KeyScan, motion: Motion, match: ScanStep, off: tuple[float, float]) -> KeyScan | None:
        """The scan with its place put right; None if the next one has to confirm it first.

        Args:
            off: what the laser saw more than was reckoned, m along the way and m to the left of it.
        """
        seen = seen_of(key, motion, match, *off)
        self.since_m = seen.off_m
        if self.trial.is_suspect(seen, motion) and not (self.doubt.is_confirmed(scan.at.stamp_s) or is_decisive(match)):
            return None
        farther = self.trial.weigh(seen, motion, scan.at.wheels_m)
        if farther is None:
            return scan
        self._has_slipped = True
        self.since_m -= farther.way_m
        heading_rad = key.at.pose[2] + 0.5 * motion.pose[2]
        self.trial.debt.owed += self._reckoning.put_right(scan.at, heading_rad, *farther)
        x, y, theta = scan.at.pose
        x, y = x + math.cos(heading_rad) * farther.way_m, y + math.sin(heading_rad) * farther.way_m
        return scan._replace(at=scan.at._replace(pose=(x, y, theta)))

    def learn(self, key: KeyScan, motion: Motion, match: ScanStep, off: tuple[float, float]) -> None:
        """A comparison that is over, and found nothing wrong."""
        seen = seen_of(key, motion, match, *off)
        if not self._has_slipped and seen.sigma_m < SEES_ALONG_M and abs(motion.wheels_m) > LEAST_WAY_M:
            self.trial.debt.owed += self._trim.take(seen.off_m, seen.sigma_m, motion.wheels_m)

    def renew(self, is_lost: bool) -> None:
        """Another scan is the key scan now. `is_lost`: nobody knows how the robot came there from the one before."""
        self.trial.give_up(is_lost)
        self._has_slipped, self.since_m = self.trial.is_slipping, 0.0


def seen_of(key: KeyScan, motion: Motion, match: ScanStep, off_m: float, aside_m: float) -> Seen:
    """What a comparison says of the way of a robot that cannot go aside."""
    bearing_rad = 0.5 * motion.pose[2] - key.arm[2]
    c, s = math.cos(bearing_rad), math.sin(bearing_rad)
    along_m, sigma_m = match.along(bearing_rad, c * off_m - s * aside_m, s * off_m + c * aside_m)
    return Seen(along_m, sigma_m, aside_m, match.fits - match.fits_as_guessed)
