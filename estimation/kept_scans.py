"""Good scans of a moment ago: where the wrist has turned the laser away from what the key scan shows, one of them shows more of the same.

A laser that looks to the left and then to the right sees hardly anything twice; who carries the robot away in between would not be noticed.
"""

from __future__ import annotations

import math
from collections import deque

from estimation.key_scan import KeyScan

MOST_PAN_RAD = 1.6  # a laser that was panned farther sees too little of the same
KEPT = 16  # scans, three seconds


class KeptScans:
    """Of one place, as far as anybody knows."""

    def __init__(self) -> None:
        self._scans: deque[KeyScan] = deque(maxlen=KEPT)

    def keep(self, scan: KeyScan) -> None:
        """One that fitted."""
        self._scans.append(scan)

    def forget(self) -> None:
        """The robot is elsewhere, or what was reckoned since is known to be wrong."""
        self._scans.clear()

    def to_compare(self, scan: KeyScan, key: KeyScan) -> list[KeyScan]:
        """What a scan is best held against: the key scan, and the kept one whose laser looked nearest, if those show enough of the same."""
        kept = min(reversed(self._scans), key=lambda one: pan_between(scan, one), default=key)
        candidates = (key,) if kept is key else (key, kept)
        return [one for one in candidates if pan_between(scan, one) <= MOST_PAN_RAD and len(one.ranges_m) == len(scan.ranges_m)]


def pan_between(a: KeyScan, b: KeyScan) -> float:
    """How far the wrist has turned the laser from one scan to the other, in radians."""
    return abs(math.remainder(a.arm[2] - b.arm[2], math.tau))
