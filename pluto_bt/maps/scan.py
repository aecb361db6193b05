"""One laser scan of everything solid, in one kernel call."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.fan import DIRECTION_X, DIRECTION_Y, HEAD, SLOPE, STRETCH, TILT_RAD, aim_fan
from pluto_bt.maps.grid_rays import grid_range
from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.maps.pits import look_into_pits
from pluto_bt.maps.rings import ring_holds, solid_ring_at
from pluto_bt.maps.shape_rays import cast_disc, cast_wall, land_on_disc
from pluto_bt.maps.solids import (
    BLOCK,
    DISC_HEIGHT,
    DISC_RADIUS,
    DISC_X,
    DISC_Y,
    GRID_COS,
    GRID_HEIGHT,
    GRID_RESOLUTION,
    GRID_SIN,
    GRID_X,
    GRID_Y,
    RING_HEIGHT,
    SEGMENT_HEIGHT,
    X1,
    X2,
    Y1,
    Y2,
)

Table = NDArray[np.float64]


@kernel
def scan_solids(
    x: float, y: float, yaw: float, z: float, tilt: float, max_range: float, fan: Table, out: Table,
    segments: Table, blocks: Table, rings: Table, discs: Table, free: NDArray[np.uint8], frame: Table,
) -> None:  # fmt: skip
    """Ranges of all beams of `fan` into `out` (n,); see `Scene.scan`. Tables as in `Solids`; metres, map frame."""
    if fan[HEAD, TILT_RAD] != tilt:
        aim_fan(fan, out.shape[0], tilt)
    if starts_inside(x, y, z, segments, rings, discs):
        for i in range(out.shape[0]):
            out[i] = 0.0
        return
    for i in range(out.shape[0]):
        out[i] = max_range * fan[STRETCH, i]
        if fan[SLOPE, i] < 0.0:
            out[i] = min(out[i], -z / fan[SLOPE, i])  # the ground
    cos, sin = math.cos(yaw), math.sin(yaw)
    cast_segments(x, y, cos, sin, z, tilt, max_range, fan, out, segments, blocks)
    cast_discs(x, y, cos, sin, z, fan, out, discs)
    if free.size:
        cast_grid(x, y, cos, sin, z, fan, out, free, frame)
    if tilt != 0.0:
        land_on_rings(x, y, cos, sin, z, fan, out, segments, rings)
        look_into_pits(x, y, cos, sin, z, max_range, fan, out, segments, rings)
        for i in range(out.shape[0]):
            out[i] = min(out[i] / fan[STRETCH, i], max_range)


@kernel
def starts_inside(x: float, y: float, z: float, segments: Table, rings: Table, discs: Table) -> bool:
    """Whether the laser stands in a polygon or a disc that is not lower than itself."""
    for m in range(discs.shape[0]):
        radius = discs[m, DISC_RADIUS]
        if discs[m, DISC_HEIGHT] >= z and radius >= 0.0 and math.hypot(discs[m, DISC_X] - x, discs[m, DISC_Y] - y) <= radius:
            return True
    return solid_ring_at(segments, rings, x, y, z) >= 0


@inline_kernel
def cast_segments(
    x: float, y: float, cos: float, sin: float, z: float, tilt: float, max_range: float, fan: Table, out: Table, segments: Table, blocks: Table
) -> None:
    """All walls and outlines, but for blocks out of range and, in a level scan, those lower than the laser."""
    for b in range(blocks.shape[0]):
        gap_x = max(blocks[b, 0] - x, x - blocks[b, 2], 0.0)
        gap_y = max(blocks[b, 1] - y, y - blocks[b, 3], 0.0)
        if gap_x * gap_x + gap_y * gap_y > max_range * max_range:
            continue
        for s in range(b * BLOCK, min((b + 1) * BLOCK, segments.shape[0])):
            height = segments[s, SEGMENT_HEIGHT]
            if height < 0.0 or (tilt == 0.0 and height < z):
                continue
            x1, y1, x2, y2 = segments[s, X1] - x, segments[s, Y1] - y, segments[s, X2] - x, segments[s, Y2] - y
            cast_wall(fan, out, x1 * cos + y1 * sin, y1 * cos - x1 * sin, x2 * cos + y2 * sin, y2 * cos - x2 * sin, z, height)


@inline_kernel
def cast_discs(x: float, y: float, cos: float, sin: float, z: float, fan: Table, out: Table, discs: Table) -> None:
    """All discs that are there: their rims, and the tops of those lower than the laser."""
    tilted = fan[HEAD, TILT_RAD] != 0.0
    for m in range(discs.shape[0]):
        radius, height = discs[m, DISC_RADIUS], discs[m, DISC_HEIGHT]
        if radius < 0.0 or (not tilted and height < z):
            continue
        dx, dy = discs[m, DISC_X] - x, discs[m, DISC_Y] - y
        forward, left = dx * cos + dy * sin, dy * cos - dx * sin
        cast_disc(fan, out, forward, left, radius, z, height)
        if tilted and height < z:
            land_on_disc(fan, out, forward, left, radius, z, height)


@inline_kernel
def cast_grid(
    x: float, y: float, cos: float, sin: float, z: float, fan: Table, out: Table, free: NDArray[np.uint8], frame: Table
) -> None:
    """The cells of the static map, up to their height."""
    unit, height, turn_cos, turn_sin = frame[GRID_RESOLUTION], frame[GRID_HEIGHT], frame[GRID_COS], frame[GRID_SIN]
    east, north = (x - frame[GRID_X]) / unit, (y - frame[GRID_Y]) / unit
    column, row = east * turn_cos + north * turn_sin, north * turn_cos - east * turn_sin
    c, s = cos * turn_cos + sin * turn_sin, sin * turn_cos - cos * turn_sin
    for i in range(out.shape[0]):
        slope, start, end = fan[SLOPE, i], 0.0, out[i] / unit
        if z > height:  # comes down to the tops of the cells, or never
            start = (height - z) / slope / unit if slope < 0.0 else end
        elif slope > 0.0:
            end = min(end, (height - z) / slope / unit)
        if start < end:
            dx, dy = c * fan[DIRECTION_X, i] - s * fan[DIRECTION_Y, i], s * fan[DIRECTION_X, i] + c * fan[DIRECTION_Y, i]
            t = grid_range(free, column + start * dx, row + start * dy, dx, dy, end - start)
            if t < end - start:
                out[i] = (start + t) * unit


@kernel
def land_on_rings(
    x: float, y: float, cos: float, sin: float, z: float, fan: Table, out: Table, segments: Table, rings: Table
) -> None:
    """Shorten the beams that come down on the top of a polygon lower than the laser."""
    for k in range(rings.shape[0]):
        height = rings[k, RING_HEIGHT]
        if not 0.0 <= height < z:
            continue
        for i in range(out.shape[0]):
            if fan[SLOPE, i] < 0.0:
                t = (height - z) / fan[SLOPE, i]
                forward, left = fan[DIRECTION_X, i] * t, fan[DIRECTION_Y, i] * t
                if t < out[i] and ring_holds(segments, rings, k, x + forward * cos - left * sin, y + forward * sin + left * cos):
                    out[i] = t
