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


class Home:
    """`key`: the scan of the place before the robot seemed elsewhere; None if it never did."""

    def __init__(self, key: KeyScan | None = None) -> None:
        self.key = key
        self._count = 0

    def is_back(self, scan: KeyScan, match: ScanStep | None) -> bool:
        """True if one scan after the other fits here. `match`: how the new one does, None if it was not compared."""
        is_here = False
        if self.key is not None and match is not None and is_good(match):
            seen = compose(compose(self.key.arm, match.step), inverse(scan.arm))
            off_m, aside_m, off_rad = difference(motion_between(self.key.at, scan.at).pose, seen)
            is_here = math.hypot(off_m, aside_m) < NEAR_M and abs(off_rad) < NEAR_RAD
        self._count = self._count + 1 if is_here else 0
        return self._count >= IN_A_ROW
