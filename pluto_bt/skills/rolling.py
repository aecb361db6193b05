"""A ball that rolls along what stands, the wall on its left: what it touches is the wall, what it does not fit into is passed by.

The points that a ball of a given radius can touch are those of the alpha shape of the scene. Ref: H. Edelsbrunner, D. Kirkpatrick, R. Seidel,
On the shape of a set of points in the plane, 1983.
"""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills.outline import Array

FIT_M = 0.002  # nearer than the radius by less is touching
PUSHES = 24  # after so many pushes a ball that still does not fit is wedged
NEAR_M = 0.5  # the ball looks at all points again when it has gone so far, between that at those that may be nearest
WEDGED_M = 0.03  # by how much a wedged ball may overlap and still count as fitting


@kernel
def roll(points: Array, x_m: float, y_m: float, radius_m: float, step_m: float, count: int) -> Array:
    """Let a ball down on the nearest point, then roll it on by `count` steps.

    Args:
        points: (n, 2 or more) x m, y m of what stands.
        x_m, y_m: where the ball begins, about a radius away from the wall.
    Returns: (k, 4) for each step the ball's middle x, y and the point x, y that it touches. Less than `count` rows where it does not fit any
        more, none if it does not fit where it begins or nothing is there.
    """
    rows = np.zeros((count, 4))
    if points.shape[0] == 0:
        return rows[:0]
    near, near_count, at_x, at_y = np.zeros((points.shape[0], 3)), 0, math.inf, math.inf
    touched = -1
    for k in range(count):
        first, overlap_m = -1, 0.0
        for _ in range(PUSHES):
            if not math.hypot(x_m - at_x, y_m - at_y) < NEAR_M:
                near_count, at_x, at_y = _gather(points, x_m, y_m, near), x_m, y_m
            which, distance_m = _nearest(near[:near_count], x_m, y_m)
            i = int(near[which, 2])
            overlap_m = radius_m - distance_m
            if overlap_m < FIT_M:
                break
            if first < 0 and i != touched:
                first = i
            x_m += overlap_m * (x_m - points[i, 0]) / max(distance_m, 1e-6)
            y_m += overlap_m * (y_m - points[i, 1]) / max(distance_m, 1e-6)
        if overlap_m > WEDGED_M:
            return rows[:k]
        touched = first if first >= 0 and k > 0 else i  # what is met on the way is the next to roll along
        dx, dy = x_m - points[touched, 0], y_m - points[touched, 1]
        distance_m = max(math.sqrt(dx * dx + dy * dy), 1e-6)
        if first < 0 or k == 0:  # let it down
            x_m, y_m = points[touched, 0] + radius_m * dx / distance_m, points[touched, 1] + radius_m * dy / distance_m
        rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3] = x_m, y_m, points[touched, 0], points[touched, 1]
        x_m, y_m = x_m - step_m * dy / distance_m, y_m + step_m * dx / distance_m
    return rows


@inline_kernel
def _gather(points: Array, x_m: float, y_m: float, near: Array) -> int:
    """Fill `near` with the points, x, y and number, one of which is the nearest to any place less than `NEAR_M` from here; how many."""
    _, least_m = _nearest(points, x_m, y_m)
    reach_m, count = least_m + 2.0 * NEAR_M + 1e-6, 0
    for i in range(points.shape[0]):
        dx, dy = points[i, 0] - x_m, points[i, 1] - y_m
        if dx * dx + dy * dy < reach_m * reach_m:
            near[count, 0], near[count, 1], near[count, 2] = points[i, 0], points[i, 1], i
            count += 1
    return count


@inline_kernel
def _nearest(points: Array, x_m: float, y_m: float) -> tuple[int, float]:
    """The nearest point, and how far it is."""
    best, least = 0, 1e18
    for i in range(points.shape[0]):
        dx, dy = points[i, 0] - x_m, points[i, 1] - y_m
        square = dx * dx + dy * dy
        if square < least:
            best, least = i, square
    return best, math.sqrt(least)
