"""Can the laser be trusted? Age, holes, a fatal error, and content that does not change although the robot moves.

The one judge of the laser. Avoidance and stop filter have one each, with limits and memory of their own: neither trusts the other.
"""

from __future__ import annotations

import math
from enum import StrEnum

import numpy as np

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.blackboard.messages import LaserScan
from pluto_bt.maps.platform import Laser
from pluto_bt.skills import reasons
from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.verdict import ALL_WELL, Verdict

GOOD_IN_A_ROW = 2  # after a fault so many good scans, each in time, make the laser trustworthy again
MOVED_M, MOVED_RAD = 0.02, 0.02  # after so much motion two scans cannot be equal
NO_PLACE = "the odometry comes too late: it is not known from where the newest scan was taken"  # a late scan is told by its age
NO_ANGLE = "the wrist is silent: it is not known where the laser looked"
RETURNS = 20  # in half a scan: fewer may well stay the same, an empty field always looks the same


class Lack(StrEnum):
    """What is missing to tell from where a scan was taken."""

    NOTHING = ""
    ODOMETRY = "odometry"  # it does not reach to the stamp of the scan, or is too old
    WRIST = "wrist"  # it is silent, and may have moved since


def _bad(text: str, code: LinkStatus = LinkStatus.LASER_SLOW_STOP, word: str = reasons.LASER_STALE) -> Verdict:
    return Verdict(code, word, text)


class ScanWatch:
    """Looks at each scan once; `verdict` tells at any moment."""

    def __init__(self, laser: Laser, stale_s: float, holes: float, good_in_a_row: int = GOOD_IN_A_ROW) -> None:
        """`stale_s`: how old the newest scan may be, 0 = the laser's delay and 1.25 periods; `holes`: the share of beams that may tell nothing;
        `good_in_a_row`: 1 for who may look more seldom than scans come.
        """
        self._laser, self._enough = laser, good_in_a_row
        self.tune(stale_s, holes)
        self._last: LaserScan | None = None
        self._anchors: list[Planar | None] = [None, None]  # where the robot was when the content of each half last changed
        self._fault = _bad("no scan yet")
        self._good_in_a_row = good_in_a_row - 1  # the first scan of a run needs no other

    def tune(self, stale_s: float, holes: float) -> None:
        """These limits count from now on."""
        self._stale_s = stale_s or self._laser.arrival_delay_s + 1.25 / self._laser.rate_hz
        self._holes = holes

    def look(self, scan: LaserScan, laser: Planar | None, lacks: Lack = Lack.NOTHING) -> bool:
        """Judge a scan taken from `laser` (None: nobody knows where, for want of `lacks`); True if it may be used."""
        fault = self._judge(scan, laser, lacks)
        if self._last is not None and scan.stamp_s - self._last.stamp_s > self._stale_s:
            self._good_in_a_row = 0
        self._last = scan
        if fault != ALL_WELL:
            self._fault, self._good_in_a_row = fault, 0
            return False
        self._good_in_a_row += 1
        if self._good_in_a_row >= self._enough:
            self._fault = ALL_WELL
        elif self._fault == ALL_WELL:
            self._fault = _bad("scans come too seldom")
        elif self._fault.code is LinkStatus.LASER_FATAL:
            self._fault = _bad("scans come again; two in time are asked for")
        return True

    def verdict(self, now_s: float) -> Verdict:
        """Why the laser cannot be trusted now; ALL_WELL if it can."""
        if self._last is not None and now_s - self._last.stamp_s > self._stale_s and self._fault.code != LinkStatus.LASER_FATAL:
            self._fault = _bad(f"the newest scan is older than {self._stale_s:.2f} s")
            self._good_in_a_row = 0
        return self._fault

    def _judge(self, scan: LaserScan, laser: Planar | None, lacks: Lack) -> Verdict:
        ranges = scan.ranges_m
        usable = (ranges > 0.0) & (ranges < math.inf)  # NaN compares False
        n_usable = int(np.count_nonzero(usable))
        if len(ranges) and not n_usable and bool((ranges == -1.0).all()):
            return _bad("the laser had a fatal error and is rebooting", LinkStatus.LASER_FATAL, reasons.LASER_FATAL)
        if not len(ranges) or n_usable < (1.0 - self._holes) * len(ranges):
            share = 1.0 - n_usable / max(1, len(ranges))
            return _bad(f"{share:.0%} of the beams give no usable number, {self._holes:.0%} are allowed")
        if laser is None:
            return _bad(NO_ANGLE, word=reasons.WRIST_STALE) if lacks is Lack.WRIST else Verdict(reason=reasons.ODOMETRY_STALE, text=NO_PLACE)
        half = len(ranges) // 2
        for which, part in enumerate((slice(None, half), slice(half, None))):
            if self._is_frozen(which, ranges, part, laser):
                return _bad(f"the {'right' if which == 0 else 'left'} half of the scan stays exactly the same although the robot moves")
        return ALL_WELL

    def _is_frozen(self, which: int, ranges: Array, part: slice, laser: Planar) -> bool:
        now, before, at = ranges[part], None if self._last is None else self._last.ranges_m[part], self._anchors[which]
        if before is None or at is None or not are_same(now, before):
            self._anchors[which] = laser
            return False
        if np.count_nonzero(now < self._laser.max_range_m) < RETURNS:
            return False
        return math.hypot(laser[0] - at[0], laser[1] - at[1]) > MOVED_M or abs(math.remainder(laser[2] - at[2], math.tau)) > MOVED_RAD


def are_same(a: Array, b: Array) -> bool:
    """Whether two runs of beams are equal, number by number. The first one nearly always tells."""
    return len(a) == len(b) and (not len(a) or bool(a[0] == b[0])) and np.array_equal(a, b)
