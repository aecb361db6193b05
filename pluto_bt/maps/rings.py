"""Points inside closed outlines, map frame: solid polygons and holes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.kernel import kernel
from pluto_bt.maps.solids import END, FIRST, RING_HEIGHT, X1, X2, X_MAX, X_MIN, Y1, Y2, Y_MAX, Y_MIN

Table = NDArray[np.float64]


@kernel
def ring_holds(segments: Table, rings: Table, k: int, x: float, y: float) -> bool:
    """Whether ring `k` has the point inside (even-odd rule; of points on the outline some count as inside)."""
    if not (rings[k, X_MIN] <= x <= rings[k, X_MAX] and rings[k, Y_MIN] <= y <= rings[k, Y_MAX]):
        return False
    inside = False
    for i in range(int(rings[k, FIRST]), int(rings[k, END])):
        y1, y2 = segments[i, Y1], segments[i, Y2]
        if (y1 > y) != (y2 > y):
            x1, x2 = segments[i, X1], segments[i, X2]
            if x < x1 + (x2 - x1) * ((y - y1) / (y2 - y1)):
                inside = not inside
    return inside


@kernel
def solid_ring_at(segments: Table, rings: Table, x: float, y: float, z: float) -> int:
    """The first solid ring, not lower than `z`, that has the point inside; -1 = none."""
    for k in range(rings.shape[0]):
        if rings[k, RING_HEIGHT] >= z and rings[k, RING_HEIGHT] >= 0.0 and ring_holds(segments, rings, k, x, y):
            return k
    return -1


@kernel
def hole_at(segments: Table, rings: Table, x: float, y: float) -> int:
    """The first hole that has the point inside; -1 = none."""
    for k in range(rings.shape[0]):
        if rings[k, RING_HEIGHT] < 0.0 and ring_holds(segments, rings, k, x, y):
            return k
    return -1
