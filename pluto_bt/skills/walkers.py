"""Who walks about: the stop filter's own memory of people and other moving things, seen or gone out of sight. Frame: dead reckoning.

Who is in view is thought to go on about as he does. Who went out of view may be anywhere that his legs can have taken him to since, for
`memory_s`; what the sensors have seen to be free lately is left out by `stop_path`, which asks. Nothing is assumed of people never seen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pluto_bt.blackboard.messages import LaserScan
from pluto_bt.skills.movers import Mask, Movers, came_closer
from pluto_bt.skills.outline import Array, Planar

REACH_M = 6.0  # farther away, the beams are too far apart to tell
BEFORE_S = 0.55  # a scan is compared with one so much older, so that who strolls has gone far enough to be noticed
IN_VIEW_S = 0.6  # after so long without being seen he is out of view
SAME_M, SAME_MPS, SAME_S = 0.4, 0.8, 2.0  # who is seen so near to where somebody was expected is the same one, if it is not too long ago
SURE = 2  # a single sighting may be a grazed edge
REFUTED_S, BODY_M = 0.3, 0.3  # who is not seen in the next scans where he must be, with so much of a body, was a phantom
UNSTEADY_MPS = 0.2  # nobody walks quite evenly
MOST_MPS, HURRY = 2.0, 1.25
HEARD_MPS = 1.2  # how fast somebody may be who was only heard
MOST_WALKERS = 12
ROW = 7  # x m, y m, drift x, y m/s, spread m, growth m/s, 1 = in view


@dataclass(slots=True)
class Walker:
    """Where somebody was seen last, how fast he went, how well that is known, when, and how often he was seen."""

    x_m: float
    y_m: float
    vx_mps: float
    vy_mps: float
    unsure_m: float
    stamp_s: float
    times: int = 1

    def gap_m(self, other: Walker) -> float:
        """From where he was expected to `other`."""
        dt_s = other.stamp_s - self.stamp_s
        return math.hypot(other.x_m - self.x_m - self.vx_mps * dt_s, other.y_m - self.y_m - self.vy_mps * dt_s)

    def row(self, now_s: float) -> tuple[float, ...]:
        """What `stop_path` reckons with: the disc in which his middle must be now, how it drifts, how it grows."""
        age_s, speed_mps = now_s - self.stamp_s, math.hypot(self.vx_mps, self.vy_mps)
        if age_s <= IN_VIEW_S and speed_mps > 0.0:  # from standing still to going on, bending to either side
            drift_x, drift_y, growth_mps = 0.5 * self.vx_mps, 0.5 * self.vy_mps, 0.5 * speed_mps + UNSTEADY_MPS
        else:
            drift_x, drift_y = 0.0, 0.0
            growth_mps = min(MOST_MPS, HURRY * speed_mps + UNSTEADY_MPS) if speed_mps > 0.0 else HEARD_MPS
        is_in_view = 1.0 if age_s <= IN_VIEW_S else 0.0
        return self.x_m + drift_x * age_s, self.y_m + drift_y * age_s, drift_x, drift_y, self.unsure_m + growth_mps * age_s, growth_mps, is_in_view


class WalkerWatch:
    """Takes scans and what the sonar heard moving; gives the rows."""

    def __init__(self, memory_s: float) -> None:
        self._memory_s = memory_s
        self.forget()

    def forget(self) -> None:
        """Nobody was ever seen."""
        self._movers = Movers()
        self._scans: list[tuple[LaserScan, Planar]] = []
        self._walkers: list[Walker] = []

    def take_scan(self, scan: LaserScan, laser: Planar, believed: Array) -> None:
        """A level scan from where the laser was, yaw with the wrist's pan; `believed` as in `SeenSpace`."""
        before = self._before(scan)
        self._scans.append((scan, laser))
        if before is None:
            return
        ranges = scan.ranges_m
        near: Mask = (ranges > 0.0) & (ranges < REACH_M) & (believed != 0.0)
        bearing = laser[2] + scan.angle_min_rad + scan.angle_step_rad * np.flatnonzero(near)
        points = np.column_stack((laser[0] + ranges[near] * np.cos(bearing), laser[1] + ranges[near] * np.sin(bearing)))
        moved = came_closer(ranges, near, before[0].ranges_m, laser, before[1], scan.angle_min_rad, scan.angle_step_rad, len(points))
        self._movers.velocities(points, np.flatnonzero(near), moved, scan.stamp_s)
        self._meet(_apart([Walker(x, y, vx, vy, 0.0, stamp_s) for x, y, vx, vy, stamp_s in self._movers.walkers.tolist()]))
        seen = [one for one in self._walkers if one.stamp_s == scan.stamp_s]
        self._walkers = [one for one in self._walkers if not _is_refuted(one, scan, laser, believed, seen)]

    def take_echoes(self, places: Array, stamp_s: float) -> None:
        """(n, 3) x m, y m and how far beside that he may be: who comes nearer, as `Approach` hears it."""
        heard = [Walker(x, y, 0.0, 0.0, unsure_m, stamp_s) for x, y, unsure_m in places.tolist()]
        seen = [one for one in self._walkers if one.unsure_m == 0.0 and stamp_s - one.stamp_s <= IN_VIEW_S]
        self._meet([one for one in heard if not any(_may_be(other, one) for other in seen)])  # the laser knows better where he is

    def rows(self, now_s: float) -> Array:
        """(n, ROW) of all who are known about."""
        self._walkers = [one for one in self._walkers if now_s - one.stamp_s < (self._memory_s if one.times >= SURE else IN_VIEW_S)]
        sure = [one.row(now_s) for one in self._walkers if one.times >= SURE]
        return np.array(sure) if sure else NOBODY

    def _before(self, scan: LaserScan) -> tuple[LaserScan, Planar] | None:
        """The newest scan that is old enough to compare with, if it has the same beams."""
        while len(self._scans) > 1 and scan.stamp_s - self._scans[1][0].stamp_s >= BEFORE_S - 0.05:
            del self._scans[0]
        if not self._scans or scan.stamp_s - self._scans[0][0].stamp_s > 2.0 * BEFORE_S or len(self._scans[0][0].ranges_m) != len(scan.ranges_m):
            self._scans = []
            return None
        return self._scans[0]

    def _meet(self, seen: list[Walker]) -> None:
        """Who of the known ones was seen again, and who is new."""
        for one in seen:
            known = [other for other in self._walkers if one.stamp_s - SAME_S < other.stamp_s < one.stamp_s]
            nearest = min(known, key=lambda other: other.gap_m(one), default=None)
            if nearest is not None and _may_be(nearest, one):
                self._walkers.remove(nearest)
                one.times = nearest.times + 1
            self._walkers.append(one)
        del self._walkers[:-MOST_WALKERS]


def _may_be(known: Walker, seen: Walker) -> bool:
    """True if who is seen may be the one who is known."""
    return known.gap_m(seen) < SAME_M + SAME_MPS * abs(seen.stamp_s - known.stamp_s) + seen.unsure_m


def _apart(seen: list[Walker]) -> list[Walker]:
    """Those of one scan; two so near to each other are two sides of one person."""
    kept: list[Walker] = []
    for one in sorted(seen, key=lambda one: -math.hypot(one.vx_mps, one.vy_mps)):
        if all(math.hypot(one.x_m - other.x_m, one.y_m - other.y_m) > 2.0 * BODY_M for other in kept):
            kept.append(one)
    return kept


def _is_refuted(walker: Walker, scan: LaserScan, laser: Planar, believed: Array, seen: list[Walker]) -> bool:
    """True if every beam that passes where he can be goes on behind it, or ends at somebody who is `seen`.

    Nobody vanishes in plain view: he is that one, or never was.
    """
    if scan.stamp_s - walker.stamp_s < REFUTED_S:
        return False
    x_m, y_m, _, _, spread_m, _, _ = walker.row(scan.stamp_s)
    distance_m, radius_m = math.hypot(x_m - laser[0], y_m - laser[1]), spread_m + BODY_M
    if distance_m <= radius_m:
        return False
    half_rad = math.asin(radius_m / distance_m)
    first_rad = math.remainder(math.atan2(y_m - laser[1], x_m - laser[0]) - laser[2], math.tau) - half_rad - scan.angle_min_rad
    first, last = math.floor(first_rad / scan.angle_step_rad), math.ceil((first_rad + 2.0 * half_rad) / scan.angle_step_rad)
    if first < 0 or last >= len(scan.ranges_m):
        return False
    beams = scan.ranges_m[first : last + 1]
    explained = (beams > distance_m + radius_m) | (believed[first : last + 1] == 0.0)
    bearings = laser[2] + scan.angle_min_rad + scan.angle_step_rad * np.arange(first, last + 1)
    end_x, end_y = laser[0] + beams * np.cos(bearings), laser[1] + beams * np.sin(bearings)
    for one in seen:
        explained |= np.hypot(end_x - one.x_m, end_y - one.y_m) < 2.0 * BODY_M
    return bool(explained.all())


NOBODY: Array = np.zeros((0, ROW))
