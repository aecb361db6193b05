"""Which scan to compare a new one with, to find who walks: one old enough that who strolls has gone far enough to be noticed."""

from __future__ import annotations

from pluto_bt.blackboard.messages import LaserScan
from pluto_bt.skills.outline import Planar

BEFORE_S = 0.55


class ScansBefore:
    """Keeps the level scans of the last `BEFORE_S`, each with where the laser was."""

    def __init__(self) -> None:
        self._scans: list[tuple[LaserScan, Planar]] = []

    def take(self, scan: LaserScan, laser: Planar) -> tuple[LaserScan, Planar] | None:
        """Take a scan; the newest that is old enough to compare it with, if it has the same beams."""
        while len(self._scans) > 1 and scan.stamp_s - self._scans[1][0].stamp_s >= BEFORE_S - 0.05:
            del self._scans[0]
        first = self._scans[0][0] if self._scans else None
        if first is None or scan.stamp_s - first.stamp_s > 2.0 * BEFORE_S or len(first.ranges_m) != len(scan.ranges_m):
            self._scans = []
        before = self._scans[0] if self._scans else None
        self._scans.append((scan, laser))
        return before
