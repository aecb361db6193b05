"""What a scan is held against: the key scan, or, where the wrist has turned the laser away from what that shows, a good one of a moment ago.

A laser that looks to the left and then to the right sees hardly anything twice; who carries the robot away in between would not be noticed.
"""

from __future__ import annotations

import math
from collections import deque

from estimation.key_scan import LEAST_POINTS, Beams, KeyScan, best_match
from estimation.reckoning import Motion, motion_between
from estimation.scan_match import ScanStep
from estimation.se2 import Pose2

MOST_PAN_RAD = 1.6  # a laser that was panned farther sees too little of the same
KEPT = 16  # scans; three seconds, if all of them are good
KEY_WAY_M, KEY_TURN_RAD = 1.0, 0.5
FAR_KEYS = 3.0  # after a gap scans are compared up to so many times that way
LONGEST_GAP_S = 60.0  # and so long after one another: later the place may look different


class KeptScans:
    """Good scans of the last moments, of one place as far as anybody knows."""

    def __init__(self) -> None:
        self._scans: deque[KeyScan] = deque(maxlen=KEPT)

    def keep(self, scan: KeyScan) -> None:
        """One that fitted."""
        self._scans.append(scan)

    def forget(self) -> None:
        """The robot is elsewhere, or what was reckoned since is known to be wrong."""
        self._scans.clear()

    def compared(self, scan: KeyScan, key: KeyScan, beams: Beams, hint_m: float = 0.0) -> tuple[KeyScan, Motion, ScanStep] | None:
        """A scan held against the key scan, or against the kept one whose laser looked nearest if that shows more of the same; with the one that
        it was held against. None if there is none. `hint_m`: so much farther the last comparison with the key scan has seen the robot."""
        kept = min(reversed(self._scans), key=lambda one: pan_between(scan, one), default=key)
        best: tuple[KeyScan, Motion, ScanStep] | None = None
        for before in (key,) if kept is key else (key, kept):
            is_alike = pan_between(scan, before) <= MOST_PAN_RAD and len(before.ranges_m) == len(scan.ranges_m)
            held = held_against(before, scan, beams, hint_m if before is key else 0.0) if is_alike else None
            if held is not None and (best is None or held[1].points > best[2].points):
                best = (before, *held)
                if held[1].points >= LEAST_POINTS:
                    break
        return best


def held_against(before: KeyScan, scan: KeyScan, beams: Beams, hint_m: float = 0.0) -> tuple[Motion, ScanStep] | None:
    """What was reckoned between two scans, and how the second fits to the first; None if that is too long ago or too far away."""
    motion = motion_between(before.at, scan.at)
    if not 0.0 < motion.time_s <= LONGEST_GAP_S or is_far(motion.pose, FAR_KEYS):
        return None
    return motion, best_match(before, scan, motion, beams, hint_m)


def is_far(pose: Pose2, times: float) -> bool:
    """True if so many times the way or turn lies between two scans after which another key scan is taken."""
    return math.hypot(pose[0], pose[1]) > times * KEY_WAY_M or abs(pose[2]) > times * KEY_TURN_RAD


def pan_between(a: KeyScan, b: KeyScan) -> float:
    """How far the wrist has turned the laser from one scan to the other, in radians."""
    return abs(math.remainder(a.arm[2] - b.arm[2], math.tau))
