"""What is nearest to the robot's outline, and all that touches it: everything solid, in one kernel call each."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.grid_gap import grid_gap
from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.maps.outline import disc_gap, distance2, nearest_on_segment, outline_circle, segment_gap
from pluto_bt.maps.rings import ring_holds
from pluto_bt.maps.solids import (
    BLOCK,
    DISC_OWNER,
    DISC_RADIUS,
    DISC_X,
    DISC_Y,
    END,
    FIRST,
    GRID_COS,
    GRID_RESOLUTION,
    GRID_SIN,
    GRID_X,
    GRID_Y,
    RING_HEIGHT,
    RING_OWNER,
    SEGMENT_HEIGHT,
    SEGMENT_OWNER,
    X1,
    X2,
    Y1,
    Y2,
)

Table = NDArray[np.float64]

GAP, GAP_X, GAP_Y, GAP_OWNER = range(4)  # columns of `found`
GRID_OWNER = 0.0  # row of the static map among the owners


@kernel
def nearest_solid(
    outline: Table, segments: Table, blocks: Table, rings: Table, discs: Table, free: NDArray[np.uint8], frame: Table, cells: Table, found: Table
) -> int:
    """The nearest solid thing into `found[0]`; returns how many there are, 0 or 1, or -1 for an outline that is not finite.

    `cells` is as large as the outline and is written over. A circle around the outline gives a bound that leaves the exact test to the few
    things that may be nearest.
    """
    found[0, GAP] = math.inf
    cx, cy, radius = outline_circle(outline)
    if not math.isfinite(cx + cy + radius):
        return -1
    for m in range(discs.shape[0]):
        reach = found[0, GAP] + radius + discs[m, DISC_RADIUS]
        if discs[m, DISC_RADIUS] >= 0.0 and distance2(cx, cy, discs[m, DISC_X], discs[m, DISC_Y]) < reach * reach:
            gap, x, y = disc_gap(outline, discs[m, DISC_X], discs[m, DISC_Y], discs[m, DISC_RADIUS])
            keep_nearest(found, gap, x, y, discs[m, DISC_OWNER])
    for b in range(blocks.shape[0]):
        if box_beyond(blocks, b, cx, cy, found[0, GAP] + radius):
            continue
        for s in range(b * BLOCK, min((b + 1) * BLOCK, segments.shape[0])):
            reach = found[0, GAP] + radius
            if segments[s, SEGMENT_HEIGHT] >= 0.0 and segment_within(segments, s, cx, cy, reach):
                gap, x, y = segment_gap(outline, segments[s, X1], segments[s, Y1], segments[s, X2], segments[s, Y2])
                keep_nearest(found, gap, x, y, segments[s, SEGMENT_OWNER])
    for k in range(rings.shape[0]):
        if found[0, GAP] > 0.0 and rings[k, RING_HEIGHT] >= 0.0 and ring_holds(segments, rings, k, outline[0, 0], outline[0, 1]):
            keep_nearest(found, 0.0, cx, cy, rings[k, RING_OWNER])
    if free.size and found[0, GAP] > 0.0:
        gap, x, y = map_gap(outline, cells, free, frame, found[0, GAP])
        keep_nearest(found, gap, x, y, GRID_OWNER)
    return 1 if math.isfinite(found[0, GAP]) else 0


@kernel
def touching_solids(
    outline: Table, segments: Table, blocks: Table, rings: Table, discs: Table, free: NDArray[np.uint8], frame: Table, cells: Table, found: Table
) -> int:
    """All owners that share a point with the outline, one row of `found` each; returns how many, -1 for an outline that is not finite.

    `found` has a row for every owner; `cells` is as large as the outline and is written over.
    """
    count = 0
    cx, cy, radius = outline_circle(outline)
    if not math.isfinite(cx + cy + radius):
        return -1
    if free.size:
        gap, x, y = map_gap(outline, cells, free, frame, 1e-9)
        count = note_contact(found, count, gap, x, y, GRID_OWNER)
    for b in range(blocks.shape[0]):
        if box_beyond(blocks, b, cx, cy, radius):
            continue
        for s in range(b * BLOCK, min((b + 1) * BLOCK, segments.shape[0])):
            if segments[s, SEGMENT_HEIGHT] >= 0.0 and segment_within(segments, s, cx, cy, radius):
                gap, x, y = segment_gap(outline, segments[s, X1], segments[s, Y1], segments[s, X2], segments[s, Y2])
                count = note_contact(found, count, gap, x, y, segments[s, SEGMENT_OWNER])
    for k in range(rings.shape[0]):
        if rings[k, RING_HEIGHT] >= 0.0 and ring_holds(segments, rings, k, outline[0, 0], outline[0, 1]):
            count = note_contact(found, count, 0.0, cx, cy, rings[k, RING_OWNER])
    for m in range(discs.shape[0]):
        reach = radius + discs[m, DISC_RADIUS]
        if discs[m, DISC_RADIUS] >= 0.0 and distance2(cx, cy, discs[m, DISC_X], discs[m, DISC_Y]) <= reach * reach:
            gap, x, y = disc_gap(outline, discs[m, DISC_X], discs[m, DISC_Y], discs[m, DISC_RADIUS])
            count = note_contact(found, count, gap, x, y, discs[m, DISC_OWNER])
    return count


@kernel
def nearest_hole(outline: Table, segments: Table, rings: Table, found: Table) -> int:
    """The nearest hole into `found[0]`, at distance 0 if the outline reaches over it; returns how many there are, 0 or 1, or -1 as above."""
    found[0, GAP] = math.inf
    cx, cy, radius = outline_circle(outline)
    if not math.isfinite(cx + cy + radius):
        return -1
    for k in range(rings.shape[0]):
        if rings[k, RING_HEIGHT] >= 0.0:
            continue
        if found[0, GAP] > 0.0 and ring_holds(segments, rings, k, outline[0, 0], outline[0, 1]):
            keep_nearest(found, 0.0, outline[0, 0], outline[0, 1], rings[k, RING_OWNER])
        for s in range(int(rings[k, FIRST]), int(rings[k, END])):
            if segment_within(segments, s, cx, cy, found[0, GAP] + radius):
                gap, x, y = segment_gap(outline, segments[s, X1], segments[s, Y1], segments[s, X2], segments[s, Y2])
                keep_nearest(found, gap, x, y, rings[k, RING_OWNER])
    return 1 if math.isfinite(found[0, GAP]) else 0


@kernel
def map_gap(outline: Table, cells: Table, free: NDArray[np.uint8], frame: Table, limit: float) -> tuple[float, float, float]:
    """`grid_gap` in metres and the map frame. `cells`: room for the outline in cells."""
    unit, cos, sin = frame[GRID_RESOLUTION], frame[GRID_COS], frame[GRID_SIN]
    for i in range(outline.shape[0]):
        east, north = (outline[i, 0] - frame[GRID_X]) / unit, (outline[i, 1] - frame[GRID_Y]) / unit
        cells[i, 0], cells[i, 1] = east * cos + north * sin, north * cos - east * sin
    gap, column, row = grid_gap(free, cells, limit / unit)
    return gap * unit, frame[GRID_X] + (column * cos - row * sin) * unit, frame[GRID_Y] + (column * sin + row * cos) * unit


@inline_kernel
def box_beyond(blocks: Table, b: int, x: float, y: float, reach: float) -> bool:
    """Whether block `b` is further than `reach` from the point."""
    dx, dy = max(blocks[b, 0] - x, x - blocks[b, 2], 0.0), max(blocks[b, 1] - y, y - blocks[b, 3], 0.0)
    return bool(dx * dx + dy * dy > reach * reach)


@inline_kernel
def segment_within(segments: Table, s: int, x: float, y: float, reach: float) -> bool:
    """Whether segment `s` is not further than `reach` from the point."""
    px, py = nearest_on_segment(x, y, segments[s, X1], segments[s, Y1], segments[s, X2], segments[s, Y2])
    return distance2(x, y, px, py) <= reach * reach


@inline_kernel
def keep_nearest(found: Table, gap: float, x: float, y: float, owner: float) -> None:
    """Put a thing into `found[0]` if it is nearer than what is there."""
    if gap < found[0, GAP]:
        found[0, GAP], found[0, GAP_X], found[0, GAP_Y], found[0, GAP_OWNER] = gap, x, y, owner


@inline_kernel
def note_contact(found: Table, count: int, gap: float, x: float, y: float, owner: float) -> int:
    """Add a row for an owner in contact that has none yet; returns the new count."""
    if gap > 0.0:
        return count
    for i in range(count):
        if found[i, GAP_OWNER] == owner:
            return count
    found[count, GAP], found[count, GAP_X], found[count, GAP_Y], found[count, GAP_OWNER] = gap, x, y, owner
    return count + 1
