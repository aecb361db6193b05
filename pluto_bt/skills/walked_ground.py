"""Where somebody walked lately, as far as the laser looks: what stands there now may walk on. Frame: dead reckoning.

A robot that turns away to look for another way does not see whether he walks there still. So a step grows old only while the laser looks at it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.blackboard.messages import LaserScan, read_only
from pluto_bt.maps.kernel import kernel
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
        kept = grown_old(self._steps, scan.ranges_m, scan.angle_min_rad, scan.angle_step_rad, laser, scan.stamp_s, watched_s)
        if not kept.all():
            self._points, self._steps = [self._points[i] for i in np.flatnonzero(kept).tolist()], self._steps[kept]

    def places(self, now_s: float, memory_s: float = LONGEST_S) -> Array:
        """(n, 2) x m, y m of all that are not over, and not older than `memory_s`."""
        first = int(np.searchsorted(self._steps[:, 2], now_s - memory_s, side="right"))
        return np.concatenate(self._points[first:]) if first < len(self._points) else NOWHERE


@kernel
def grown_old(
    steps: Array, ranges_m: Array, angle_min_rad: float, angle_step_rad: float, laser: Planar, stamp_s: float, watched_s: float
) -> Mask:  # fmt: skip
    """Add `watched_s` to the last column of those `steps` that a scan looks at; (n,) which of them are not over."""
    kept = np.zeros(steps.shape[0], dtype=np.bool_)
    for i in range(steps.shape[0]):
        dx, dy = steps[i, 0] - laser[0], steps[i, 1] - laser[1]
        bearing_rad = (math.atan2(dy, dx) - laser[2] + math.pi) % (2.0 * math.pi) - math.pi
        beam = int(np.rint((bearing_rad - angle_min_rad) / angle_step_rad))
        if 0 <= beam < ranges_m.shape[0] and ranges_m[beam] > math.hypot(dx, dy) - HIDDEN_M:
            steps[i, 3] += watched_s
        kept[i] = steps[i, 3] < MEMORY_S and stamp_s - steps[i, 2] < LONGEST_S
    return kept


def cells_beside(cells: Array, n: int, size: int) -> tuple[Indices, Indices]:
    """The cells (rows, columns) under `cells` (k, 2), places in cells, and up to `n` beside them, of a square grid of `size`."""
    i, j = np.floor(cells).astype(np.intp).T
    di, dj = np.mgrid[-n : n + 1, -n : n + 1].reshape(2, -1, 1)
    return np.clip(i + di, 0, size - 1), np.clip(j + dj, 0, size - 1)


def warm() -> None:
    """Use the kernel once that only a place where somebody has walked needs."""
    grown_old(np.zeros((1, 4)), read_only((1.0,)), 0.0, 1.0, (0.0, 0.0, 0.0), 0.0, 0.0)
