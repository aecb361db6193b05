"""A scan with the place it was taken from, and what comparing two of them tells: the same place or another one, and how it was come from."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimation.reckoning import Motion, Sums
from estimation.scan_match import ScanStep, match_scans
from estimation.se2 import IDENTITY, Pose2, between, compose

FARTHEST_M = 20.0  # what is farther off is not compared: there a sixth of a degree is more than a point may lie off its line
GOOD_FIT, LEAST_POINTS = 0.6, 24  # a share of the points on their lines, of so many: the match is good
LEAST_ODD_POINTS, MANY_POINTS = 20, 40  # fewer tell nothing; so many tell by themselves
BETTER_FIT = 0.1  # so much more than where localisation believes to be, another guess must explain
LEAST_HINT_M, BETTER_HINT = 0.03, 0.04  # where the last comparison saw the robot is looked too, if that was so far away, and believed if more fits
SHORTER_M = (0.4, 0.8, 1.2)  # matching finds what is up to half a metre off
NO_FIT, ONE_SIDED, SIDES = 0.4, 0.12, 0.12  # another place: fewer fit and both sides differ, or hardly any fits at all …
POOR_FIT, MUCH = 0.55, 0.22  # … or many differ to both sides
NEVER_AS_GUESSED = 0.1  # … or hardly any fits where the robot must be, and nowhere near do most
DECISIVE_FIT, DECISIVE_GAIN = 0.8, 0.5  # no passer-by makes nearly all of a scan fit there, and hardly anything where the robot must be
HIDDEN_FIT, ALL_HIDDEN_FIT = 0.2, 0.03  # a crowd hides much and shows nothing farther; only a closed ring of people hides all
CROWDED, CROWD_M = 0.4, 1.2  # who stands so near fills so much of a scan that it says nothing of the place


class Beams(NamedTuple):
    """Bearing of the first beam, and from each to the next; the laser's range."""

    first_rad: float
    step_rad: float
    max_range_m: float


class KeyScan(NamedTuple):
    """The scan that others are compared with; `arm`: the laser seen from the robot."""

    at: Sums
    ranges_m: NDArray[np.float64]
    arm: Pose2

    @property
    def is_crowded(self) -> bool:
        """True if something near fills much of the scan."""
        return bool(np.count_nonzero(self.ranges_m < CROWD_M) > CROWDED * len(self.ranges_m))


def _elsewhere(motion: Motion) -> Iterator[Pose2]:
    """Where else a scan may be: where the wheels' turn leads, where it was, and less far, for wheels slip."""
    x, y, turn_rad = motion.pose
    yield x, y, motion.wheels_rad
    yield IDENTITY
    way_m = math.hypot(x, y)
    for shorter_m in SHORTER_M:
        if way_m > shorter_m:
            share = 1.0 - shorter_m / way_m
            yield share * x, share * y, turn_rad


def best_match(key: KeyScan, scan: KeyScan, motion: Motion, beams: Beams, hint_m: float = 0.0) -> ScanStep:
    """How a scan fits to the key scan, `motion` later: from where it is reckoned to be, or where another guess explains more.

    Args:
        hint_m: so much farther the last comparison with this key scan has seen the robot.
    """

    def matched(pose: Pose2) -> ScanStep:
        guess = between(key.arm, compose(pose, scan.arm))
        return match_scans(key.ranges_m, scan.ranges_m, beams.first_rad, beams.step_rad, guess, min(beams.max_range_m, FARTHEST_M))

    best = matched(motion.pose)
    if abs(hint_m) > LEAST_HINT_M:
        best = better(best, matched(farther(motion.pose, hint_m)), BETTER_HINT)
    if best.fits < GOOD_FIT:
        for pose in _elsewhere(motion):
            best = better(best, matched(pose), BETTER_FIT)
            if best.fits >= GOOD_FIT:
                break
    return best


def better(match: ScanStep, other: ScanStep, by: float) -> ScanStep:
    """The other one if it explains so much more; both are compared with what the first guess explained."""
    return other._replace(fits_as_guessed=match.fits_as_guessed) if other.fits > match.fits + by else match


def farther(pose: Pose2, way_m: float) -> Pose2:
    """A pose moved along the way that leads to it."""
    c, s = math.cos(0.5 * pose[2]), math.sin(0.5 * pose[2])
    return pose[0] + c * way_m, pose[1] + s * way_m, pose[2]


def is_good(match: ScanStep) -> bool:
    """True if a match is believed."""
    return match.points >= LEAST_POINTS and match.fits >= GOOD_FIT


def is_decisive(match: ScanStep) -> bool:
    """True if no second scan has to confirm what a match says."""
    return match.fits >= DECISIVE_FIT and match.fits - match.fits_as_guessed >= DECISIVE_GAIN


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
    is_one_sided = match.fits < ONE_SIDED and match.points >= MANY_POINTS
    is_unexplained = match.fits < GOOD_FIT and match.fits_as_guessed < NEVER_AS_GUESSED and match.points >= MANY_POINTS
    return is_one_sided or is_unexplained or (match.fits < NO_FIT and both > SIDES) or (match.fits < POOR_FIT and both > MUCH)


def difference(reckoned: Pose2, seen: Pose2) -> tuple[float, float, float]:
    """What the laser saw more than was reckoned: m along the way, m to the left of it, rad."""
    heading_rad = 0.5 * reckoned[2]
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    x, y = seen[0] - reckoned[0], seen[1] - reckoned[1]
    return c * x + s * y, c * y - s * x, math.remainder(seen[2] - reckoned[2], math.tau)
