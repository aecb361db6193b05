"""Who walks about: the stop filter's own memory of people and other moving things, seen or gone out of sight. Frame: dead reckoning.

Everybody may be anywhere that his legs can have taken him to since he was seen: people turn on their heels. Who stops in view is thought to
stay. Who went out of view is reckoned with for `memory_s`; what the sensors have seen to be free lately is left out for him by `stop_path`,
which asks. A single sign, be it an echo, is somebody for a moment. Nothing is assumed of people of whom there was no sign.
"""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.blackboard.messages import LaserScan
from pluto_bt.skills.approach import PERHAPS, SURELY
from pluto_bt.skills.movers import MOVED_BEAMS, Beams, Mask, Movers, came_closer, gone_away
from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.scans_before import ScansBefore
from pluto_bt.skills.stop_path import IN_VIEW, SPREAD_M, STRANGER, WALKER_COLUMNS
from pluto_bt.skills.walker import BODY_M, IN_VIEW_S, Walker

REACH_M = 6.0  # farther away, the beams are too far apart to tell
SCAN_S = 0.25  # a level scan counts for so much looking at most
SAME_S = 3.0  # who was not seen for longer is not known again
SURE = 2  # a single sighting may be a grazed edge: he is reckoned with for a moment, but nobody else because of him
MOST_WALKERS = 12
PERHAPS_S = 1.0  # who is perhaps there is forgotten after so long, …
OFTEN = 4  # … and surely there if he was heard so often meanwhile


class WalkerWatch:
    """Takes scans and what the sonar heard moving; gives the rows."""

    def __init__(self, memory_s: float) -> None:
        self._memory_s = memory_s
        self.forget()

    def forget(self) -> None:
        """Nobody was ever seen."""
        self._movers = Movers()
        self._before = ScansBefore()
        self._walkers: list[Walker] = []
        self._perhaps: list[Walker] = []  # heard, and it may be something that stands: they count for a moment
        self._doubted_s = -math.inf
        self._rows: tuple[float, Array] = (-math.inf, NOBODY)  # the last ones, and when they were; before anything is taken they hold

    def take_scan(self, scan: LaserScan, laser: Planar, believed: Array) -> None:
        """A level scan from where the laser was, yaw with the wrist's pan; `believed` as in `SeenSpace`."""
        before = self._before.take(scan, laser)
        if before is None:
            return
        self._rows = (-math.inf, NOBODY)
        near: Mask = (scan.ranges_m > 0.0) & (scan.ranges_m < REACH_M) & (believed != 0.0)
        points, beams = _ends(scan, laser, near)
        moved = came_closer(scan.ranges_m, near, before[0].ranges_m, laser, before[1], scan.angle_min_rad, scan.angle_step_rad, len(points))
        self._movers.velocities(points, beams, moved, scan.stamp_s)
        seen = [Walker(x, y, vx, vy, 0.0, scan.stamp_s, walked_s) for x, y, vx, vy, walked_s in self._movers.walkers.tolist()]
        self._meet(_apart([*seen, *_those_who_go(scan, laser, points, beams, *before)]))
        self._look_for_the_others(scan, laser, believed, min(scan.stamp_s - before[0].stamp_s, SCAN_S))

    def take_echoes(self, places: Array, stamp_s: float) -> None:
        """(n, 4) x m, y m, how far beside that he may be, and how well it is known: who comes nearer, as `Approach` hears it."""
        if len(places):
            self._rows = (-math.inf, NOBODY)
        heard: list[Walker] = []
        for x, y, unsure_m, how in places.tolist():
            one = Walker(x, y, 0.0, 0.0, unsure_m, stamp_s, stamp_s, SURE if how == SURELY else 1)
            (self._perhaps if how == PERHAPS else heard).append(one)
        seen = [one for one in self._walkers if one.unsure_m == 0.0 and stamp_s - one.walked_s <= IN_VIEW_S]
        self._meet([one for one in heard if not any(other.may_be(one) for other in seen)])  # the laser knows better where he is

    def doubt(self, stamp_s: float) -> None:
        """Something was heard that may be somebody, until it proves to stand."""
        self._doubted_s = stamp_s

    def rows(self, now_s: float) -> Array:
        """(n, WALKER_COLUMNS) of all who are known about, also those who were noticed once only, for a moment; see `Walker.row`."""
        if self._rows[0] != now_s:
            self._rows = (now_s, self._rows_at(now_s))
        return self._rows[1]

    def _rows_at(self, now_s: float) -> Array:
        self._forget_the_old(now_s)
        known = (*self._walkers, *self._perhaps)
        return np.array([one.row(now_s) for one in known]) if known else NOBODY

    def _forget_the_old(self, now_s: float) -> None:
        self._walkers = [one for one in self._walkers if now_s - one.walked_s < (self._memory_s if one.times >= SURE else IN_VIEW_S)]
        self._perhaps = [one for one in self._perhaps if now_s - one.stamp_s < PERHAPS_S]

    def is_anybody_about(self, now_s: float) -> bool:
        """Whether somebody was surely seen or heard walking lately, or a moment ago perhaps, if a laser cannot tell."""
        if now_s - self._doubted_s < IN_VIEW_S:
            return True
        self._forget_the_old(now_s)
        return any(one.times >= SURE for one in self._walkers) or len(self._perhaps) >= OFTEN

    def bodies(self, now_s: float) -> Array:
        """(n, 3) x m, y m, radius m of the discs in which those in view stand and walk."""
        if not self.is_anybody_about(now_s):
            return NO_BODY
        rows = self.rows(now_s)
        seen = rows[rows[:, IN_VIEW] == 1.0]
        return np.column_stack((seen[:, :2], seen[:, SPREAD_M] + 2.0 * BODY_M))

    def _meet(self, seen: list[Walker]) -> None:
        """Who of the known ones was seen again, and who is new."""
        for one in seen:
            known = [other for other in self._walkers if one.stamp_s - SAME_S < other.stamp_s < one.stamp_s and other.may_be(one)]
            nearest = min(known, key=lambda other: other.gap_m(one), default=None)
            if nearest is not None:
                self._walkers.remove(nearest)
                one.times = max(one.times, nearest.times + (one.walked_s > nearest.walked_s))  # that he is still there proves nothing
            self._walkers.append(one)
        del self._walkers[:-MOST_WALKERS]

    def _look_for_the_others(self, scan: LaserScan, laser: Planar, believed: Array, looked_s: float) -> None:
        """What the scan says of those who do not walk in it."""
        seen = [one for one in self._walkers if one.stamp_s == scan.stamp_s]
        self._walkers = [one for one in self._walkers if not one.is_refuted(scan, laser, believed, seen)]
        for one in self._walkers:
            if one.stamp_s < scan.stamp_s:
                one.looked_for_s += looked_s
                if not one.is_in_view(scan.stamp_s) and one.is_watched(scan, laser):
                    one.stays(scan.stamp_s)


def _ends(scan: LaserScan, laser: Planar, near: Mask) -> tuple[Array, Beams]:
    """(n, 2) x m, y m where the `near` beams end, and (n,) which ones they are."""
    beams = near.nonzero()[0]
    range_m, bearing_rad = scan.ranges_m[beams], laser[2] + scan.angle_min_rad + scan.angle_step_rad * beams
    points = np.zeros((len(beams), 2))
    points[:, 0], points[:, 1] = laser[0] + range_m * np.cos(bearing_rad), laser[1] + range_m * np.sin(bearing_rad)
    return points, beams


def _those_who_go(scan: LaserScan, laser: Planar, points: Array, beams: Beams, before: LaserScan, last: Planar) -> list[Walker]:
    """Who walks away from the laser, or along behind what he hid from it."""
    near: Mask = (before.ranges_m > 0.0) & (before.ranges_m < REACH_M)
    left = came_closer(before.ranges_m, near, scan.ranges_m, last, laser, scan.angle_min_rad, scan.angle_step_rad, int(np.count_nonzero(near)))
    if np.count_nonzero(left) < MOVED_BEAMS:
        return []
    gone = gone_away(points, beams, *_ends(before, last, near), left, scan.stamp_s - before.stamp_s)
    return [Walker(x, y, vx, vy, 0.0, scan.stamp_s, scan.stamp_s) for x, y, vx, vy in gone.tolist()]


def _apart(seen: list[Walker]) -> list[Walker]:
    """Those of one scan; two so near to each other are two sides of one person."""
    kept: list[Walker] = []
    for one in sorted(seen, key=lambda one: -math.hypot(one.vx_mps, one.vy_mps)):
        if all(math.hypot(one.x_m - other.x_m, one.y_m - other.y_m) > 2.0 * BODY_M for other in kept):
            kept.append(one)
    return kept


NOBODY: Array = np.zeros((0, WALKER_COLUMNS))
ANYWHERE: Array = np.array([[0.0, 0.0, 0.0, 0.0, 1e6, 0.0, STRANGER]])  # somebody out of view, nobody knows where
NO_BODY: Array = np.zeros((0, 3))
