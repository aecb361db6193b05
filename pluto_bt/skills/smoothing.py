"""A way along grid cells made into one that a person would drive: corners cut where there is room, then rounded like a rubber band."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from pluto_bt.skills.grid_kernels import draw_tight
from pluto_bt.skills.outline import Array
from pluto_bt.skills.plan_map import PlanMap

Clearances = Callable[[Array], Array]  # (n, 2) points → (n,) metres to what stands
LOOKS = (1.0, 0.75, 0.5, 0.35, 0.25, 0.15, 0.1)  # shares of the longest short cut that are tried
LONGEST_CUT_M = 15.0
LOOK_STEP_M = 0.1
ROUNDS, PULL = 150, 0.5  # of the rubber band


def resampled(points: Array, step_m: float) -> Array:
    """The polyline through points (n, 2), with points about `step_m` apart; the ends stay."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    at = np.concatenate(([0.0], np.cumsum(steps)))
    count = max(2, math.ceil(at[-1] / step_m) + 1)
    wanted = np.linspace(0.0, at[-1], count)
    return np.column_stack([np.interp(wanted, at, points[:, axis]) for axis in (0, 1)])


def pulled(points: Array, clearances_m: Clearances, wide_m: float) -> Array:
    """Corners of a shorter way: from each, as far straight on as the line has as much room as the way itself has there, up to `wide_m`."""
    room = np.minimum(clearances_m(points), wide_m)
    steps = np.hypot(*np.diff(points, axis=0).T)
    longest = max(2, round(LONGEST_CUT_M / max(float(steps.mean()), 1e-6)))
    corners, at, last = [0], 0, len(points) - 1
    while at < last:
        for share in LOOKS:
            to = min(last, at + max(1, round(share * longest)))
            if to == at + 1 or _has_room(points[at], points[to], float(room[at : to + 1].min()), clearances_m):
                break
        else:
            to = at + 1
        corners.append(to)
        at = to
    return points[corners]


def _has_room(a: Array, b: Array, room_m: float, clearances_m: Clearances) -> bool:
    count = max(2, math.ceil(math.dist(a, b) / LOOK_STEP_M) + 1)
    line = a + np.linspace(0.0, 1.0, count)[:, None] * (b - a)
    return bool((clearances_m(line) >= room_m).all())


def smoothed(points: Array, plan_map: PlanMap, wide_m: float) -> Array:
    """Each point drawn to the middle of its neighbours, again and again, but never nearer to what stands than it was, below `wide_m`."""
    way = np.array(points)
    frame = plan_map.frame
    draw_tight(way, np.minimum(plan_map.clearances_m(way), wide_m), ROUNDS, PULL, plan_map.clearance, frame.origin, frame.cell_m)
    return way
