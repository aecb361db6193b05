"""Is a polygon a polygon: three corners, some area, no edge that crosses or touches another? Plain numpy, no heavy library."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.world import Points

MAX_CORNERS = 5000
FEW = 12
_ROWS = 128  # edges compared at a time: memory stays small


def without_repeats(points: Points) -> Points:
    """The corners without any that equals the one before it; a last corner that closes the polygon is left out too."""
    kept: list[list[float]] = []
    for point in points.tolist():
        if not kept or point != kept[-1]:
            kept.append(point)
    if len(kept) > 1 and kept[0] == kept[-1]:
        kept.pop()
    if len(kept) == len(points):
        return points
    corners = np.array(kept)
    corners.setflags(write=False)
    return corners


def crossing(corners: Points) -> tuple[int, int] | None:
    """The first pair of edges (i runs from corner i to the next) that cross, touch or lie on each other; None if the polygon is simple.

    Args:
        corners: (n, 2), n ≥ 3, no corner equal to the one before it.
    """
    return _crossing_of_few(corners.tolist()) if len(corners) <= FEW else _crossing_of_many(corners)


def _crossing_of_few(corners: list[list[float]]) -> tuple[int, int] | None:
    """Each edge with each other: for the usual house, arrays would take ten times as long."""
    n = len(corners)

    def side(a: list[float], b: list[float], c: list[float]) -> float:
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    for i in range(n):
        a, b, c = corners[i], corners[(i + 1) % n], corners[(i + 2) % n]
        if side(a, b, c) == 0.0 and (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) < 0.0:
            return i, (i + 1) % n
    for i in range(n - 2):
        a, b = corners[i], corners[i + 1]
        for j in range(i + 2, n - (i == 0)):
            c, d = corners[j], corners[(j + 1) % n]
            if max(a[0], b[0]) < min(c[0], d[0]) or max(c[0], d[0]) < min(a[0], b[0]):
                continue
            if max(a[1], b[1]) < min(c[1], d[1]) or max(c[1], d[1]) < min(a[1], b[1]):
                continue
            if _are_apart(side(a, b, c), side(a, b, d)) or _are_apart(side(c, d, a), side(c, d, b)):
                continue
            return i, j
    return None


def _are_apart(one: float, other: float) -> bool:
    """True if both points lie strictly on one side."""
    return (one > 0.0 and other > 0.0) or (one < 0.0 and other < 0.0)


def _crossing_of_many(corners: Points) -> tuple[int, int] | None:
    """A sweep from left to right: a block of edges is compared with those that begin before the block ends."""
    ends = np.roll(corners, -1, axis=0)
    spike = _first_spike(corners, ends)
    if spike is not None:
        return spike
    n = len(corners)
    low, high = np.minimum(corners, ends), np.maximum(corners, ends)
    order = np.argsort(low[:, 0], kind="stable")
    low_x = low[order, 0]
    for start in range(0, n, _ROWS):
        block = order[start : start + _ROWS]
        others = order[start : np.searchsorted(low_x, high[block, 0].max(), side="right")]
        near = np.all((low[block, None] <= high[None, others]) & (low[None, others] <= high[block, None]), axis=2)
        first, second = np.nonzero(near)
        first, second = block[first], others[second]
        gap = (second - first) % n
        apart = (gap > 1) & (gap < n - 1)
        first, second = first[apart], second[apart]
        hit = np.flatnonzero(_meet(corners[first], ends[first], corners[second], ends[second]))
        if hit.size:
            pair = min(tuple(sorted((int(first[k]), int(second[k])))) for k in hit)
            return pair[0], pair[1]
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
    points = corners.tolist()
    x0, y0 = points[0]
    x1, y1 = max(points, key=lambda point: abs(point[0] - x0) + abs(point[1] - y0))
    return all(abs((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) < 1e-9 for x, y in points)
