"""Exact gap between the robot's outline and the solid cells of a grid. All in cells."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.free_squares import INSIDE, LONGEST
from pluto_bt.maps.kernel import kernel
from pluto_bt.maps.outline import box_gap, outline_circle, outline_distance

Table = NDArray[np.float64]

HALF_DIAGONAL = 0.7072  # of a cell


@kernel
def grid_gap(free: NDArray[np.uint8], outline: Table, limit: float) -> tuple[float, float, float]:
    """Distance from the outline to the nearest solid cell and the point of the cell where that is; inf if none is nearer than `limit`.

    Rows are searched from the middle outwards, in each row empty stretches are leapt over.
    """
    rows, columns = free.shape[1], free.shape[2]
    cx, cy, radius = outline_circle(outline)
    gap, x, y = math.inf, cx, cy
    for i in range(outline.shape[0]):
        side = nearest_side(free, outline[i, 0], outline[i, 1])
        if side <= 0:
            return 0.0, outline[i, 0], outline[i, 1]
        if side < LONGEST:  # a solid cell begins within `side` cells of this corner on both axes
            limit = min(limit, side * math.sqrt(2.0) + 1e-6)
    reach = limit + radius
    middle = math.floor(min(max(cy, 0.0), rows - 1.0))
    for k in range(2 * rows):
        row = middle + (k + 1) // 2 if k % 2 else middle - k // 2
        off = max(row - cy, cy - row - 1.0, 0.0)
        if off >= reach or not 0 <= row < rows:
            continue
        half = math.sqrt(reach * reach - off * off)
        column, last = math.floor(max(cx - half, 0.0)), min(cx + half, columns - 1.0)
        while column <= last:
            side = max(free[0, row, column], free[2, row, column])
            if side == 0 and outline_distance(outline, column + 0.5, row + 0.5) - HALF_DIAGONAL <= min(gap, limit):
                other, ox, oy = box_gap(outline, column, row)
                if other < min(gap, limit):
                    gap, x, y, reach = other, ox, oy, other + radius
            column += 1 if side == 0 or side == INSIDE else int(side)
    return gap, x, y


@kernel
def nearest_side(free: NDArray[np.uint8], x: float, y: float) -> int:
    """Cells to the nearest solid cell, chessboard distance; 0 in one; `LONGEST` = that far or unknown (also outside of the grid)."""
    if not (0.0 <= x < free.shape[2] and 0.0 <= y < free.shape[1]):
        return LONGEST
    column, row = int(x), int(y)
    side = int(min(min(free[0, row, column], free[1, row, column]), min(free[2, row, column], free[3, row, column])))
    return 0 if side == INSIDE else side
