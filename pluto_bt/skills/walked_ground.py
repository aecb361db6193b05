"""Where somebody walked lately, as far as the laser looks: what stands there now may walk on. Frame: dead reckoning."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pluto_bt.blackboard.messages import LaserScan
from pluto_bt.skills.movers import MOVED_BEAMS, Mask, came_closer
from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.scans_before import ScansBefore

Indices = NDArray[np.intp]
MEMORY_S = 20.0  # who paces to and fro in a doorway may stand for some seconds at its ends
BODY_M = 0.3  # his other side is about so far from what is seen of him
NOWHERE: Array = np.zeros((0, 2))


class WalkedGround:
    """The ends of beams that found somebody where all was free half a second before."""

    def __init__(self, look_m: float) -> None:
        self._look_m = look_m
        self.forget()

    def forget(self) -> None:
        """Nobody was ever seen to walk."""
        self._before = ScansBefore()
        self._steps: list[tuple[float, Array]] = []

    def take(self, scan: LaserScan, laser: Planar) -> None:
        """A level scan from where the laser was, yaw with the wrist's pan."""
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
        self._steps = [*(step for step in self._steps if scan.stamp_s - step[0] < MEMORY_S), (scan.stamp_s, points)]

    def places(self, now_s: float, memory_s: float = MEMORY_S) -> Array:
        """(n, 2) x m, y m of all of the last `memory_s`."""
        steps = [points for stamp_s, points in self._steps if now_s - stamp_s < memory_s]
        return np.concatenate(steps) if steps else NOWHERE


def cells_beside(cells: Array, n: int, size: int) -> tuple[Indices, Indices]:
    """The cells (rows, columns) under `cells` (k, 2), places in cells, and up to `n` beside them, of a square grid of `size`."""
    i, j = np.floor(cells).astype(np.intp).T
    di, dj = np.mgrid[-n : n + 1, -n : n + 1].reshape(2, -1, 1)
    return np.clip(i + di, 0, size - 1), np.clip(j + dj, 0, size - 1)
