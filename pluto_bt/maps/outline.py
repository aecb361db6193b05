"""Exact gaps between the robot's outline and one thing. The outline is the inside and the rim of a simple polygon, (n, 2)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.kernel import inline_kernel, kernel

Table = NDArray[np.float64]


@kernel
def outline_circle(outline: Table) -> tuple[float, float, float]:
    """Centre and radius of a circle around the outline: whatever is further from the centre than the radius plus d is further than d."""
    x, y, radius2 = 0.0, 0.0, 0.0
    for i in range(outline.shape[0]):
        x += outline[i, 0] / outline.shape[0]
        y += outline[i, 1] / outline.shape[0]
    for i in range(outline.shape[0]):
        dx, dy = outline[i, 0] - x, outline[i, 1] - y
        radius2 = max(radius2, dx * dx + dy * dy)
    return x, y, math.sqrt(radius2)


@kernel
def outline_holds(outline: Table, x: float, y: float) -> bool:
    """Whether the point is inside the outline (even-odd rule)."""
    inside = False
    x1, y1 = outline[-1, 0], outline[-1, 1]
    for i in range(outline.shape[0]):
        x2, y2 = outline[i, 0], outline[i, 1]
        if (y1 > y) != (y2 > y) and x < x1 + (x2 - x1) * ((y - y1) / (y2 - y1)):
            inside = not inside
        x1, y1 = x2, y2
    return inside


@inline_kernel
def nearest_on_segment(x: float, y: float, x1: float, y1: float, x2: float, y2: float) -> tuple[float, float]:
    """The point of a segment that is nearest to (x, y)."""
    ex, ey = x2 - x1, y2 - y1
    length2 = ex * ex + ey * ey
    share = ((x - x1) * ex + (y - y1) * ey) / length2 if length2 > 0.0 else 0.0
    if share >= 1.0:
        return x2, y2
    share = max(share, 0.0)
    return x1 + share * ex, y1 + share * ey


@inline_kernel
def distance2(x1: float, y1: float, x2: float, y2: float) -> float:
    """Squared distance of two points."""
    return (x2 - x1) * (x2 - x1) + (y2 - y1) * (y2 - y1)


@kernel
def segment_gap(outline: Table, x1: float, y1: float, x2: float, y2: float) -> tuple[float, float, float]:
    """Distance from the outline to a segment, 0 if they share a point, and the point of the segment where that is."""
    if outline_holds(outline, x1, y1):
        return 0.0, x1, y1
    least2, x, y = math.inf, x1, y1
    ax, ay = outline[-1, 0], outline[-1, 1]
    for i in range(outline.shape[0]):
        bx, by = outline[i, 0], outline[i, 1]
        side1, side2 = (bx - ax) * (y1 - ay) - (by - ay) * (x1 - ax), (bx - ax) * (y2 - ay) - (by - ay) * (x2 - ax)
        side_a, side_b = (x2 - x1) * (ay - y1) - (y2 - y1) * (ax - x1), (x2 - x1) * (by - y1) - (y2 - y1) * (bx - x1)
        if (side1 > 0.0) != (side2 > 0.0) and (side_a > 0.0) != (side_b > 0.0):
            share = side1 / (side1 - side2)
            return 0.0, x1 + share * (x2 - x1), y1 + share * (y2 - y1)
        px, py = nearest_on_segment(bx, by, x1, y1, x2, y2)
        gap2 = distance2(bx, by, px, py)
        if gap2 < least2:
            least2, x, y = gap2, px, py
        px, py = nearest_on_segment(x1, y1, ax, ay, bx, by)
        gap2 = distance2(x1, y1, px, py)
        if gap2 < least2:
            least2, x, y = gap2, x1, y1
        px, py = nearest_on_segment(x2, y2, ax, ay, bx, by)
        gap2 = distance2(x2, y2, px, py)
        if gap2 < least2:
            least2, x, y = gap2, x2, y2
        ax, ay = bx, by
    return math.sqrt(least2), x, y


@kernel
def disc_gap(outline: Table, cx: float, cy: float, radius: float) -> tuple[float, float, float]:
    """Distance from the outline to a disc, 0 if they share a point, and the point of the disc where that is."""
    if outline_holds(outline, cx, cy):
        return 0.0, cx, cy
    least2, x, y = math.inf, cx, cy
    ax, ay = outline[-1, 0], outline[-1, 1]
    for i in range(outline.shape[0]):
        bx, by = outline[i, 0], outline[i, 1]
        px, py = nearest_on_segment(cx, cy, ax, ay, bx, by)
        gap2 = distance2(cx, cy, px, py)
        if gap2 < least2:
            least2, x, y = gap2, px, py
        ax, ay = bx, by
    distance = math.sqrt(least2)
    if distance <= radius:
        return 0.0, x, y
    return distance - radius, cx + (x - cx) * (radius / distance), cy + (y - cy) * (radius / distance)


@inline_kernel
def outline_distance(outline: Table, x: float, y: float) -> float:
    """Distance from a point to the outline; 0 inside."""
    if outline_holds(outline, x, y):
        return 0.0
    least2 = math.inf
    ax, ay = outline[-1, 0], outline[-1, 1]
    for i in range(outline.shape[0]):
        bx, by = outline[i, 0], outline[i, 1]
        px, py = nearest_on_segment(x, y, ax, ay, bx, by)
        least2 = min(least2, distance2(x, y, px, py))
        ax, ay = bx, by
    return math.sqrt(least2)


@kernel
def box_gap(outline: Table, left: float, low: float) -> tuple[float, float, float]:
    """Distance from the outline to an upright unit square, 0 if they share a point, and the point of the square where that is.

    What does not overlap is nearest at a corner of one of the two.
    """
    if outline_holds(outline, left, low):
        return 0.0, left, low
    least2, x, y = math.inf, left, low
    ax, ay = outline[-1, 0], outline[-1, 1]
    for i in range(outline.shape[0]):
        bx, by = outline[i, 0], outline[i, 1]
        enters, share = enters_box(ax - left, ay - low, bx - ax, by - ay)
        if enters:
            return 0.0, ax + share * (bx - ax), ay + share * (by - ay)
        px, py = min(max(bx, left), left + 1.0), min(max(by, low), low + 1.0)
        gap2 = distance2(bx, by, px, py)
        if gap2 < least2:
            least2, x, y = gap2, px, py
        for corner in range(4):
            cx, cy = left + (corner & 1), low + (corner >> 1)
            px, py = nearest_on_segment(cx, cy, ax, ay, bx, by)
            gap2 = distance2(cx, cy, px, py)
            if gap2 < least2:
                least2, x, y = gap2, cx, cy
        ax, ay = bx, by
    return math.sqrt(least2), x, y


@inline_kernel
def enters_box(x: float, y: float, dx: float, dy: float) -> tuple[bool, float]:
    """Whether the segment from (x, y) by (dx, dy) shares a point with the unit square at the origin, and at which share of it first."""
    start, end = 0.0, 1.0
    for axis in range(2):
        at, by = (x, dx) if axis == 0 else (y, dy)
        if by == 0.0:
            if at < 0.0 or at > 1.0:
                return False, 0.0
        else:
            near, far = -at / by, (1.0 - at) / by
            start, end = max(start, min(near, far)), min(end, max(near, far))
    return start <= end, start
