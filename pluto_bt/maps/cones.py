"""The nearest surface within each of several cones (sonar): exact, in one kernel call.

A cone is a sector of less than half a turn. What lies across its edges is clipped to it before the nearest point is taken.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.grid_cone import grid_cone
from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.maps.outline import distance2, nearest_on_segment
from pluto_bt.maps.rings import solid_ring_at
from pluto_bt.maps.sector import disc_in_sector, segment_in_sector
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
    SEGMENT_HEIGHT,
    X1,
    X2,
    Y1,
    Y2,
)

Table = NDArray[np.float64]

# rows of the table of cones; the caller fills the first three and reads the fourth
APEX_X, APEX_Y, AXIS_RAD, NEAREST, AXIS_COS, AXIS_SIN = range(6)


@kernel
def cones_nearest(
    cones: Table, z: float, half_angle: float, max_range: float,
    segments: Table, blocks: Table, rings: Table, discs: Table, free: NDArray[np.uint8], frame: Table,
) -> None:  # fmt: skip
    """Fill the row NEAREST of `cones` (6, k); see `Scene.cones`. Tables as in `Solids`; metres, map frame."""
    cos, sin = math.cos(half_angle), math.sin(half_angle)
    middle_x, middle_y, spread = prepare(cones, max_range)
    for b in range(blocks.shape[0]):
        gap_x = max(blocks[b, 0] - middle_x, middle_x - blocks[b, 2], 0.0)
        gap_y = max(blocks[b, 1] - middle_y, middle_y - blocks[b, 3], 0.0)
        if gap_x * gap_x + gap_y * gap_y > (max_range + spread) ** 2:
            continue
        for s in range(b * BLOCK, min((b + 1) * BLOCK, segments.shape[0])):
            x1, y1, x2, y2 = segments[s, X1], segments[s, Y1], segments[s, X2], segments[s, Y2]
            px, py = nearest_on_segment(middle_x, middle_y, x1, y1, x2, y2)
            if segments[s, SEGMENT_HEIGHT] >= z and distance2(middle_x, middle_y, px, py) <= (max_range + spread) ** 2:
                segment_in_cones(cones, cos, sin, x1, y1, x2, y2)
    for m in range(discs.shape[0]):
        if discs[m, DISC_HEIGHT] >= z and discs[m, DISC_RADIUS] >= 0.0:
            disc_in_cones(cones, cos, sin, discs[m, DISC_X], discs[m, DISC_Y], discs[m, DISC_RADIUS])
    for k in range(cones.shape[1]):
        if solid_ring_at(segments, rings, cones[APEX_X, k], cones[APEX_Y, k], z) >= 0:
            cones[NEAREST, k] = 0.0
    if free.size and z <= frame[GRID_HEIGHT]:
        grid_in_cones(cones, cos, sin, half_angle, free, frame)


@kernel
def prepare(cones: Table, max_range: float) -> tuple[float, float, float]:
    """Start with nothing seen; returns the middle of all apexes and how far the furthest is from it."""
    x, y, spread2 = 0.0, 0.0, 0.0
    n_cones = cones.shape[1]
    for k in range(n_cones):
        cones[NEAREST, k] = max_range
        cones[AXIS_COS, k], cones[AXIS_SIN, k] = math.cos(cones[AXIS_RAD, k]), math.sin(cones[AXIS_RAD, k])
        x += cones[APEX_X, k] / n_cones
        y += cones[APEX_Y, k] / n_cones
    for k in range(n_cones):
        spread2 = max(spread2, distance2(x, y, cones[APEX_X, k], cones[APEX_Y, k]))
    return x, y, math.sqrt(spread2)


@inline_kernel
def segment_in_cones(cones: Table, cos: float, sin: float, x1: float, y1: float, x2: float, y2: float) -> None:
    """Shorten the cones that see a segment."""
    for k in range(cones.shape[1]):
        ax, ay, bx, by = x1 - cones[APEX_X, k], y1 - cones[APEX_Y, k], x2 - cones[APEX_X, k], y2 - cones[APEX_Y, k]
        c, s = cones[AXIS_COS, k], cones[AXIS_SIN, k]
        gap2 = segment_in_sector(ax * c + ay * s, ay * c - ax * s, bx * c + by * s, by * c - bx * s, cos, sin)
        if gap2 < cones[NEAREST, k] * cones[NEAREST, k]:
            cones[NEAREST, k] = math.sqrt(gap2)


@inline_kernel
def disc_in_cones(cones: Table, cos: float, sin: float, x: float, y: float, radius: float) -> None:
    """Shorten the cones that see a disc."""
    for k in range(cones.shape[1]):
        dx, dy, c, s = x - cones[APEX_X, k], y - cones[APEX_Y, k], cones[AXIS_COS, k], cones[AXIS_SIN, k]
        gap = disc_in_sector(dx * c + dy * s, dy * c - dx * s, radius, cos, sin)
        if gap < cones[NEAREST, k]:
            cones[NEAREST, k] = gap


@kernel
def grid_in_cones(cones: Table, cos: float, sin: float, half_angle: float, free: NDArray[np.uint8], frame: Table) -> None:
    """Shorten the cones that see a cell of the static map."""
    unit, turn_cos, turn_sin = frame[GRID_RESOLUTION], frame[GRID_COS], frame[GRID_SIN]
    for k in range(cones.shape[1]):
        east, north = (cones[APEX_X, k] - frame[GRID_X]) / unit, (cones[APEX_Y, k] - frame[GRID_Y]) / unit
        axis_x = cones[AXIS_COS, k] * turn_cos + cones[AXIS_SIN, k] * turn_sin
        axis_y = cones[AXIS_SIN, k] * turn_cos - cones[AXIS_COS, k] * turn_sin
        reach = cones[NEAREST, k] / unit
        column, row = east * turn_cos + north * turn_sin, north * turn_cos - east * turn_sin
        gap = grid_cone(free, column, row, axis_x, axis_y, cos, sin, half_angle, reach)
        if gap < reach:
            cones[NEAREST, k] = gap * unit
