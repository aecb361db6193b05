"""Who walks about: the stop filter's own memory of people and other moving things, seen or gone out of sight. Frame: dead reckoning.

Who is in view is thought to go on about as he does. Who stops there is thought to stay. Who went out of view may be anywhere that his legs
can have taken him to since, for `memory_s`; what the sensors have seen to be free lately is left out by `stop_path`, which asks. Nothing is
assumed of people who were never seen to walk.
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
SAME_M, SAME_S = 0.4, 3.0  # who is seen where somebody can have come to since, give or take the first, is the same one, if it is not too long ago
BLINK_S, SCAN_S = 4.0, 0.25  # … but for so long, while scans look down; and how much a level one counts at most
GLANCE_S = 0.5  # a look away for so long does not count
BODY_M = 0.25
SURE = 2  # a single sighting may be a grazed edge
UNSTEADY_MPS = 0.2  # nobody walks quite evenly
MOST_MPS, HURRY = 2.0, 1.25
HEARD_MPS = 1.2  # how fast somebody may be who was only heard
MOST_WALKERS = 12
SPREAD, IN_VIEW = 4, 6
ROW = 7  # x m, y m, drift x, y m/s, spread m, growth m/s, 1 = in view


@dataclass(slots=True)
class Walker:
    """Where somebody was at `stamp_s`, how well that is known, how fast he walked when he was last seen walking, and when and how often that was.

    `looked_for_s`: how long level scans have looked for him in vain since.
    """

    x_m: float
    y_m: float
    vx_mps: float
    vy_mps: float
    unsure_m: float
    stamp_s: float
    walked_s: float
    times: int = 1
    looked_for_s: float = 0.0

    @property
    def growth_mps(self) -> float:
        """How fast he may get away from where he was."""
        speed_mps = math.hypot(self.vx_mps, self.vy_mps)
        return min(MOST_MPS, HURRY * speed_mps + UNSTEADY_MPS) if speed_mps > 0.0 else HEARD_MPS

    def spread_m(self, now_s: float) -> float:
        """How far he may be now from where he was."""
        return self.unsure_m + self.growth_mps * (now_s - self.stamp_s)

    def is_in_view(self, now_s: float) -> bool:
        """Whether he was seen just now; a laser that looks down for a moment does not lose him."""
        age_s = now_s - self.walked_s
        return age_s <= IN_VIEW_S or (self.looked_for_s <= IN_VIEW_S and age_s <= BLINK_S and (self.vx_mps, self.vy_mps) != (0.0, 0.0))

    def stays(self, stamp_s: float) -> None:
        """The whole ground on which he may be is in view, and nobody walks there: he stands somewhere on it."""
        if stamp_s - self.stamp_s > GLANCE_S:
            self.unsure_m = self.spread_m(stamp_s)
        self.stamp_s = stamp_s

    def is_watched(self, scan: LaserScan, laser: Planar) -> bool:
        """Whether a scan shows all the ground on which he may be, and nothing hides it."""
        dx, dy, reach_m = self.x_m - laser[0], self.y_m - laser[1], self.spread_m(scan.stamp_s) + BODY_M
        away_m = math.hypot(dx, dy)
        if away_m <= reach_m:
            return False
        bearing_rad, half_rad = math.remainder(math.atan2(dy, dx) - laser[2], math.tau) - scan.angle_min_rad, math.asin(reach_m / away_m)
        first, last = math.floor((bearing_rad - half_rad) / scan.angle_step_rad), math.ceil((bearing_rad + half_rad) / scan.angle_step_rad)
        return first >= 0 and last < len(scan.ranges_m) and bool(scan.ranges_m[first : last + 1].min() > away_m - reach_m)

    def way_m(self, other: Walker) -> float:
        """From where he was to `other`."""
        return math.hypot(other.x_m - self.x_m, other.y_m - self.y_m)

    def gap_m(self, other: Walker) -> float:
        """From where he was expected to `other`."""
        dt_s = other.stamp_s - self.stamp_s
        return math.hypot(other.x_m - self.x_m - self.vx_mps * dt_s, other.y_m - self.y_m - self.vy_mps * dt_s)

    def row(self, now_s: float) -> tuple[float, ...]:
        """What `stop_path` reckons with: the disc in which his middle must be now, how it drifts, how it grows."""
        age_s, speed_mps = now_s - self.stamp_s, math.hypot(self.vx_mps, self.vy_mps)
        if not self.is_in_view(now_s):
            return self.x_m, self.y_m, 0.0, 0.0, self.spread_m(now_s), self.growth_mps, 0.0
        if speed_mps == 0.0:
            return self.x_m, self.y_m, 0.0, 0.0, self.spread_m(now_s), self.growth_mps, 1.0
        drift_x, drift_y, growth_mps = 0.5 * self.vx_mps, 0.5 * self.vy_mps, 0.5 * speed_mps + UNSTEADY_MPS  # from standing still to going on
        return self.x_m + drift_x * age_s, self.y_m + drift_y * age_s, drift_x, drift_y, self.unsure_m + growth_mps * age_s, growth_mps, 1.0


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
        self._meet([Walker(x, y, vx, vy, 0.0, scan.stamp_s, walked_s) for x, y, vx, vy, walked_s in self._movers.walkers.tolist()])
        for one in self._walkers:
            one.looked_for_s += min(scan.stamp_s - before[0].stamp_s, SCAN_S) if one.stamp_s < scan.stamp_s else 0.0
            if not one.is_in_view(scan.stamp_s) and one.is_watched(scan, laser):
                one.stays(scan.stamp_s)

    def take_echoes(self, places: Array, stamp_s: float) -> None:
        """(n, 3) x m, y m and how far beside that he may be: who comes nearer, as `Approach` hears it."""
        self._meet([Walker(x, y, 0.0, 0.0, unsure_m, stamp_s, stamp_s) for x, y, unsure_m in places.tolist()])

    def rows(self, now_s: float) -> Array:
        """(n, ROW) of all who are known about."""
        self._walkers = [one for one in self._walkers if now_s - one.walked_s < (self._memory_s if one.times >= SURE else IN_VIEW_S)]
        sure = [one.row(now_s) for one in self._walkers if one.times >= SURE]
        return np.array(sure) if sure else NOBODY

    def bodies(self, now_s: float) -> Array:
        """(n, 3) x m, y m, radius m of the discs in which those in view stand and walk."""
        rows = self.rows(now_s)
        seen = rows[rows[:, IN_VIEW] == 1.0]
        return np.column_stack((seen[:, :2], seen[:, SPREAD] + 2.0 * BODY_M))

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
            within = [other for other in known if other.way_m(one) < other.spread_m(one.stamp_s) + one.unsure_m + SAME_M]
            nearest = min(within, key=lambda other: other.gap_m(one), default=None)
            if nearest is not None:
                self._walkers.remove(nearest)
                one.times = nearest.times + 1
            self._walkers.append(one)
        del self._walkers[:-MOST_WALKERS]


NOBODY: Array = np.zeros((0, ROW))
