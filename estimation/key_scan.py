"""A scan with the place it was taken from, and what comparing two of them tells: the same place or another one, and how it was come from."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimation.reckoning import Motion, Sums
from estimation.scan_match import ScanStep, match_scans
from estimation.se2 import IDENTITY, Pose2, between, compose

FARTHEST_M = 20.0  # what is farther off is not compared: there a sixth of a degree is more than a point may lie off its line
GOOD_FIT, LEAST_POINTS = 0.6, 40  # a share of the points on their lines, of so many: the match is good
LEAST_ODD_POINTS = 25  # fewer tell nothing
BETTER_FIT = 0.1  # so much more than where localisation believes to be, another guess must explain
NO_FIT, ONE_SIDED, SIDES = 0.4, 0.08, 0.12  # another place: fewer fit and both sides differ, or hardly any fits at all …
POOR_FIT, MUCH = 0.55, 0.22  # … or many differ to both sides
HIDDEN_FIT, ALL_HIDDEN_FIT = 0.2, 0.03  # a crowd hides much and shows nothing farther; only a closed ring of people hides all
CROWDED, CROWD_M = 0.4, 1.2  # who stands so near fills so much of a scan that it says nothing of the place


class KeyScan(NamedTuple):
    """The scan that others are compared with; `arm`: the laser seen from the robot."""

    at: Sums
    ranges_m: NDArray[np.float64]
    arm: Pose2

    @property
    def is_crowded(self) -> bool:
        """True if something near fills much of the scan."""
        return bool(np.count_nonzero(self.ranges_m < CROWD_M) > CROWDED * len(self.ranges_m))


def best_match(key: KeyScan, scan: KeyScan, motion: Motion, first_rad: float, step_rad: float, max_range_m: float) -> ScanStep:
    """How a scan fits to the key scan, `motion` later.

    Looked for from where localisation believes to be; if that fits badly also from where the wheels' turn leads, and from no motion at all.

    Args:
        first_rad, step_rad: bearings of the beams of both. max_range_m: of the laser.
    """
    x, y, _ = motion.pose
    best: ScanStep | None = None
    for pose in (motion.pose, (x, y, motion.wheels_rad), IDENTITY):
        guess = between(key.arm, compose(pose, scan.arm))
        match = match_scans(key.ranges_m, scan.ranges_m, first_rad, step_rad, guess, min(max_range_m, FARTHEST_M))
        if best is None:
            best = match
        elif match.fits > best.fits + BETTER_FIT:
            best = match._replace(fits_as_guessed=best.fits_as_guessed)
        if best.fits >= GOOD_FIT:
            break
    assert best is not None
    return best


def is_good(match: ScanStep) -> bool:
    """True if a match is believed."""
    return match.points >= LEAST_POINTS and match.fits >= GOOD_FIT


def is_odd(match: ScanStep, crowd_before: bool = False, crowd_now: bool = False) -> bool:
    """True if the scans are of two places: few points fit, and both sides differ, or hardly any fits at all.

    Args:
        crowd_before, crowd_now: something near filled much of the one scan or the other. It may be people, and those hide a place; but who
            comes lets nobody see farther than before.
    """
    if match.points < LEAST_ODD_POINTS:
        return False
    both = min(match.longer, match.shorter)
    if crowd_before or crowd_now:
        return not crowd_before and (match.fits < ALL_HIDDEN_FIT or (match.fits < HIDDEN_FIT and both > SIDES))
    return match.fits < ONE_SIDED or (match.fits < NO_FIT and both > SIDES) or (match.fits < POOR_FIT and both > MUCH)


def difference(reckoned: Pose2, seen: Pose2) -> tuple[float, float, float]:
    """What the laser saw more than was reckoned: m along the way, m to the left of it, rad."""
    heading_rad = 0.5 * reckoned[2]
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    x, y = seen[0] - reckoned[0], seen[1] - reckoned[1]
    return c * x + s * y, c * y - s * x, math.remainder(seen[2] - reckoned[2], math.tau)
