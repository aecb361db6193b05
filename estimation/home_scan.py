"""The place where the robot surely was: a scan of it, to be held against what the laser sees later.

People who stand round a robot hide so much that a scan looks like another place. Nobody was carried whose laser sees the place before again,
just where it must be.
"""

from __future__ import annotations

import math

from estimation.key_scan import KeyScan, difference, is_good
from estimation.reckoning import motion_between
from estimation.scan_match import ScanStep
from estimation.se2 import compose, inverse

NEAR_M, NEAR_RAD = 0.1, 0.05  # so near to where it must be …
IN_A_ROW = 3  # … and in so many scans
ROUGHLY_M, ASIDE_M, ROUGHLY_RAD = 0.5, 0.2, 0.2  # a robot that only seemed elsewhere is so near, though its wheels slip or its gyro drifts


class Home:
    """`key`: the scan of the place before the robot seemed elsewhere; None if it never did."""

    def __init__(self, key: KeyScan | None = None) -> None:
        self.key = key
        self._count = 0

    def is_back(self, scan: KeyScan, match: ScanStep | None) -> bool:
        """True if one scan after the other fits here. `match`: how the new one does, None if it was not compared."""
        off = self._off(scan, match)
        is_here = off is not None and math.hypot(*off[:2]) < NEAR_M and abs(off[2]) < NEAR_RAD
        self._count = self._count + 1 if is_here else 0
        return self._count >= IN_A_ROW

    def is_near(self, scan: KeyScan, match: ScanStep | None) -> bool:
        """True if one scan fits roughly where it must."""
        off = self._off(scan, match)
        return off is not None and abs(off[0]) < ROUGHLY_M and abs(off[1]) < ASIDE_M and abs(off[2]) < ROUGHLY_RAD

    def _off(self, scan: KeyScan, match: ScanStep | None) -> tuple[float, float, float] | None:
        """How far from where it must be a scan is seen (m along the way, m to the left, rad); None if that cannot be told."""
        if self.key is None or match is None or not is_good(match):
            return None
        seen = compose(compose(self.key.arm, match.step), inverse(scan.arm))
        return difference(motion_between(self.key.at, scan.at).pose, seen)
