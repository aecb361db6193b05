"""The place where the robot surely was: a scan of it, to be held against what the laser sees later.

People who stand round a robot hide so much that a scan looks like another place. Nobody was carried whose laser sees the place before again,
just where it must be.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimation.reckoning import Sums, motion_between
from estimation.scan_match import ScanStep
from estimation.se2 import Pose2, compose, inverse

LEAST_POINTS, GOOD_FIT = 40, 0.6  # of a match that is believed
NEAR_M, NEAR_RAD = 0.1, 0.05  # so near to where it must be …
IN_A_ROW = 3  # … and in so many scans


class KeyScan(NamedTuple):
    """The scan that others are compared with; `arm`: the laser seen from the robot."""

    at: Sums
    ranges_m: NDArray[np.float64]
    arm: Pose2


class Home:
    """`key`: the scan of the place before the robot seemed elsewhere; None if it never did."""

    def __init__(self, key: KeyScan | None = None) -> None:
        self.key = key
        self._count = 0

    def is_back(self, scan: KeyScan, match: ScanStep | None) -> bool:
        """True if one scan after the other fits here. `match`: how the new one does, None if it was not compared."""
        is_here = False
        if self.key is not None and match is not None and match.points >= LEAST_POINTS and match.fits >= GOOD_FIT:
            seen = compose(compose(self.key.arm, match.step), inverse(scan.arm))
            off_m, aside_m, off_rad = difference(motion_between(self.key.at, scan.at).pose, seen)
            is_here = math.hypot(off_m, aside_m) < NEAR_M and abs(off_rad) < NEAR_RAD
        self._count = self._count + 1 if is_here else 0
        return self._count >= IN_A_ROW


def difference(reckoned: Pose2, seen: Pose2) -> tuple[float, float, float]:
    """What the laser saw more than was reckoned: m along the way, m to the left of it, rad."""
    heading_rad = 0.5 * reckoned[2]
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    x, y = seen[0] - reckoned[0], seen[1] - reckoned[1]
    return c * x + s * y, c * y - s * x, math.remainder(seen[2] - reckoned[2], math.tau)
