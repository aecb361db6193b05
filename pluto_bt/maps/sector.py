"""The nearest point of one thing within a sector: apex at the origin, axis along +x, half angle (cos, sin) below a quarter turn."""

from __future__ import annotations

import math

from pluto_bt.maps.kernel import inline_kernel
from pluto_bt.maps.shape_rays import disc_range

SHARED = 1e-12  # a segment through the apex is clipped to one point, up to rounding


@inline_kernel
def segment_in_sector(x1: float, y1: float, x2: float, y2: float, cos: float, sin: float) -> float:
    """Squared distance to the nearest point of a segment within the sector; inf if no part of it is inside."""
    left1, left2 = y1 * cos - x1 * sin, y2 * cos - x2 * sin  # > 0: beyond the left edge
    right1, right2 = -y1 * cos - x1 * sin, -y2 * cos - x2 * sin
    if (left1 > 0.0 and left2 > 0.0) or (right1 > 0.0 and right2 > 0.0):
        return math.inf
    start, end = 0.0, 1.0
    if left1 > 0.0:
        start = left1 / (left1 - left2)
    elif left2 > 0.0:
        end = left1 / (left1 - left2)
    if right1 > 0.0:
        start = max(start, right1 / (right1 - right2))
    elif right2 > 0.0:
        end = min(end, right1 / (right1 - right2))
    if start > end + SHARED:
        return math.inf
    ex, ey = x2 - x1, y2 - y1
    length2 = ex * ex + ey * ey
    share = -(x1 * ex + y1 * ey) / length2 if length2 > 0.0 else 0.0
    share = min(max(share, start), end)
    x, y = x1 + share * ex, y1 + share * ey
    return x * x + y * y


@inline_kernel
def disc_in_sector(x: float, y: float, radius: float, cos: float, sin: float) -> float:
    """Distance to the nearest point of a disc within the sector; inf if no part of it is inside, 0 from inside the disc."""
    distance = math.hypot(x, y)
    if distance <= radius:
        return 0.0
    if abs(y) * cos <= x * sin:
        return distance - radius
    gap = disc_range(cos, sin if y > 0.0 else -sin, x, y, radius)  # the edge on its side meets the nearest part
    return gap if gap >= 0.0 else math.inf
