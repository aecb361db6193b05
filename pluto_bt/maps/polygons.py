"""Is a polygon a polygon: three corners, some area, no edge that crosses or touches another? Plain numpy, no heavy library."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.world import Points

MAX_CORNERS = 5000
_ROWS = 256  # edges compared with all others at a time: memory stays small


def without_repeats(points: Points) -> Points:
    """The corners without any that equals the one before it; a last corner that closes the polygon is left out too."""
    keep = np.any(points != np.roll(points, 1, axis=0), axis=1)
    keep[0] = True
    corners: Points = points[keep]
    if len(corners) > 1 and np.array_equal(corners[0], corners[-1]):
        corners = corners[:-1].copy()
    corners.setflags(write=False)
    return corners


def crossing(corners: Points) -> tuple[int, int] | None:
    """The first pair of edges (i runs from corner i to the next) that cross, touch or lie on each other; None if the polygon is simple.

    Args:
        corners: (n, 2), n ≥ 3, no corner equal to the one before it.
    """
    ends = np.roll(corners, -1, axis=0)
    spike = _first_spike(corners, ends)
    if spike is not None:
        return spike
    n = len(corners)
    low, high = np.minimum(corners, ends), np.maximum(corners, ends)
    for start in range(0, n, _ROWS):
        i = np.arange(start, min(start + _ROWS, n))
        near = np.all((low[i, None] <= high[None]) & (low[None] <= high[i, None]), axis=2)
        first, second = np.nonzero(near)
        first = first + start
        gap = (second - first) % n
        apart = (second > first) & (gap != 1) & (gap != n - 1)
        first, second = first[apart], second[apart]
        hit = np.flatnonzero(_meet(corners[first], ends[first], corners[second], ends[second]))
        if hit.size:
            return int(first[hit[0]]), int(second[hit[0]])
    return None


def meeting_point(corners: Points, pair: tuple[int, int]) -> tuple[float, float]:
    """About where two edges meet, for a report."""
    n = len(corners)
    p, q = corners[pair[0]], corners[pair[1]]
    r, s = corners[(pair[0] + 1) % n] - p, corners[(pair[1] + 1) % n] - q
    cross = float(r[0] * s[1] - r[1] * s[0])
    if math.isclose(cross, 0.0, abs_tol=1e-12):
        return float(q[0]), float(q[1])
    share = float((q[0] - p[0]) * s[1] - (q[1] - p[1]) * s[0]) / cross
    return float(p[0] + share * r[0]), float(p[1] + share * r[1])


def _first_spike(corners: Points, ends: Points) -> tuple[int, int] | None:
    """Two edges in a row, of which the second runs back over the first."""
    along, following = ends - corners, np.roll(ends - corners, -1, axis=0)
    turn = along[:, 0] * following[:, 1] - along[:, 1] * following[:, 0]
    back = np.flatnonzero((turn == 0.0) & (np.sum(along * following, axis=1) < 0.0))
    return (int(back[0]), (int(back[0]) + 1) % len(corners)) if back.size else None


def _side(a: Points, b: Points, c: Points) -> NDArray[np.float64]:
    """On which side of a → b is c: the sign of the cross product, row by row."""
    return np.sign((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))


def _meet(a: Points, b: Points, c: Points, d: Points) -> NDArray[np.bool_]:
    """Whether a–b meets c–d, row by row; the boxes around them are known to overlap."""
    return np.asarray((_side(a, b, c) * _side(a, b, d) <= 0) & (_side(c, d, a) * _side(c, d, b) <= 0))


def is_flat(corners: Points) -> bool:
    """True if all corners lie on one line (a figure of eight has no net area either, but is not flat)."""
    along = corners[np.argmax(np.sum((corners - corners[0]) ** 2, axis=1))] - corners[0]
    offsets = corners - corners[0]
    return bool(np.all(np.abs(along[0] * offsets[:, 1] - along[1] * offsets[:, 0]) < 1e-9))
