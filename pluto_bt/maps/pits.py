"""Beams that reach the ground inside a hole: they go on to its side, or to its floor."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.fan import DIRECTION_X, DIRECTION_Y, SLOPE, STRETCH
from pluto_bt.maps.kernel import kernel
from pluto_bt.maps.rings import hole_at, ring_holds
from pluto_bt.maps.shape_rays import wall_range
from pluto_bt.maps.solids import END, FIRST, RING_HEIGHT, X1, X2, Y1, Y2

Table = NDArray[np.float64]

BEYOND_M = 1e-9  # a side of a hole that lies in another hole is no side: looked for this far behind it


@kernel
def look_into_pits(
    x: float, y: float, cos: float, sin: float, z: float, max_range: float, fan: Table, out: Table, segments: Table, rings: Table
) -> None:
    """Lengthen the beams that end on the ground where a hole is."""
    n_holes = 0
    for k in range(rings.shape[0]):
        n_holes += rings[k, RING_HEIGHT] < 0.0
    for i in range(out.shape[0] if n_holes else 0):
        slope = fan[SLOPE, i]
        if slope < 0.0 and out[i] == -z / slope:
            dx = fan[DIRECTION_X, i] * cos - fan[DIRECTION_Y, i] * sin
            dy = fan[DIRECTION_X, i] * sin + fan[DIRECTION_Y, i] * cos
            k = hole_at(segments, rings, x + dx * out[i], y + dy * out[i])
            if k >= 0:
                out[i] = min(pit_range(x, y, dx, dy, z, slope, out[i], k, segments, rings), max_range * fan[STRETCH, i])


@kernel
def pit_range(x: float, y: float, dx: float, dy: float, z: float, slope: float, t: float, k: int, segments: Table, rings: Table) -> float:
    """Level distance to the floor or the side of the hole `k` that the beam has entered after `t`. Holes that overlap are one."""
    floor = float((rings[k, RING_HEIGHT] - z) / slope)
    for _ in range(rings.shape[0]):
        side = floor
        for s in range(int(rings[k, FIRST]), int(rings[k, END])):
            hit = wall_range(dx, dy, segments[s, X1] - x, segments[s, Y1] - y, segments[s, X2] - x, segments[s, Y2] - y)
            if t < hit < side:
                side = hit
        if side >= floor:
            return floor
        t = side
        beyond = -1
        for other in range(rings.shape[0]):
            behind = t + BEYOND_M
            if other != k and rings[other, RING_HEIGHT] < 0.0 and ring_holds(segments, rings, other, x + dx * behind, y + dy * behind):
                beyond = other
        if beyond < 0:
            return side
        k = beyond
    return t
