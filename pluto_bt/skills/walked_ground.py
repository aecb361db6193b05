"""Where somebody walked lately, as far as the laser looks: what stands there now may walk on. Frame: dead reckoning.

A robot that turns away to look for another way does not see whether he walks there still. So a step grows old only while the laser looks at it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.blackboard.messages import LaserScan
from pluto_bt.skills.movers import MOVED_BEAMS, Mask, came_closer
from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.scans_before import ScansBefore

Indices = NDArray[np.intp]
MEMORY_S = 20.0  # who paces to and fro in a doorway may stand for some seconds at its ends
LONGEST_S = 120.0  # and this is how long he is remembered where nobody looks
LOOK_S = 0.5  # a scan counts for so much looking at most
HIDDEN_M = 0.5  # what ends a beam so much nearer than a step hides it
BODY_M = 0.3  # his other side is about so far from what is seen of him
NOWHERE: Array = np.zeros((0, 2))


class WalkedGround:
    """Steps: the ends of the beams that found somebody where all was free half a second before."""

    def __init__(self, look_m: float) -> None:
        self._look_m = look_m
        self.forget()

    def forget(self) -> None:
        """Nobody was ever seen to walk."""
        self._before = ScansBefore()
        self._points: list[Array] = []
        self._steps: Array = np.zeros((0, 4))  # the middle x m, y m of each, its stamp s, and how long it was looked at since, s
        self._looked_s = -math.inf

    def take(self, scan: LaserScan, laser: Planar) -> None:
        """A level scan from where the laser was, yaw with the wrist's pan."""
        self._grow_old(scan, laser)
        before, ranges = self._before.take(scan, laser), scan.ranges_m
        if before is None:
            return
        near: Mask = (ranges > 0.0) & (ranges < self._look_m)
        beams = near.nonzero()[0]
        moved = came_closer(ranges, near, before[0].ranges_m, laser, before[1], scan.angle_min_rad, scan.angle_step_rad, len(beams))
        if np.count_nonzero(moved) < MOVED_BEAMS:
            return
        bearings_rad, range_m = laser[2] + scan.angle_min_rad + scan.angle_step_rad * beams[moved], ranges[beams[moved]]
        points = np.column_stack((laser[0] + range_m * np.cos(bearings_rad), laser[1] + range_m * np.sin(bearings_rad)))
        self._points.append(points)
        self._steps = np.vstack((self._steps, (*points.mean(axis=0), scan.stamp_s, 0.0)))

    def _grow_old(self, scan: LaserScan, laser: Planar) -> None:
        """Count the time for the steps that are looked at, and forget those that are over."""
        watched_s, self._looked_s = min(scan.stamp_s - self._looked_s, LOOK_S), scan.stamp_s
        if not self._points:
            return
        x_m, y_m, stamps_s, seconds = self._steps.T
        bearings_rad = np.arctan2(y_m - laser[1], x_m - laser[0]) - laser[2]
        beams = np.rint((np.remainder(bearings_rad + np.pi, 2.0 * np.pi) - np.pi - scan.angle_min_rad) / scan.angle_step_rad).astype(np.intp)
        shown_m = scan.ranges_m[np.clip(beams, 0, len(scan.ranges_m) - 1)]
        is_in_field = (beams >= 0) & (beams < len(scan.ranges_m))
        seconds += watched_s * (is_in_field & (shown_m > np.hypot(x_m - laser[0], y_m - laser[1]) - HIDDEN_M))
        kept = (seconds < MEMORY_S) & (scan.stamp_s - stamps_s < LONGEST_S)
        if not kept.all():
            self._points, self._steps = [self._points[i] for i in np.flatnonzero(kept).tolist()], self._steps[kept]

    def places(self, now_s: float, memory_s: float = LONGEST_S) -> Array:
        """(n, 2) x m, y m of all that are not over, and not older than `memory_s`."""
        first = int(np.searchsorted(self._steps[:, 2], now_s - memory_s, side="right"))
        return np.concatenate(self._points[first:]) if first < len(self._points) else NOWHERE


def cells_beside(cells: Array, n: int, size: int) -> tuple[Indices, Indices]:
    """The cells (rows, columns) under `cells` (k, 2), places in cells, and up to `n` beside them, of a square grid of `size`."""
    i, j = np.floor(cells).astype(np.intp).T
    di, dj = np.mgrid[-n : n + 1, -n : n + 1].reshape(2, -1, 1)
    return np.clip(i + di, 0, size - 1), np.clip(j + dj, 0, size - 1)
