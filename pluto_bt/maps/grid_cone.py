"""The nearest solid cell of a grid within a cone, exact. All in cells.

The cone is swept line by line, outwards along the grid axis that is nearest to its own; in each line empty stretches are leapt over.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.free_squares import INSIDE
from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.maps.sector import segment_in_sector

STEEPEST_RAD = math.pi / 2 - 1e-6  # an edge along the lines is taken for one that leans by this; the reach bounds it


@kernel
def grid_cone(
    free: NDArray[np.uint8], x: float, y: float, axis_x: float, axis_y: float, cos: float, sin: float, half_angle: float, reach: float
) -> float:
    """Distance from (x, y) to the nearest point of a solid cell within the cone; `reach` if there is none nearer.

    Args:
        axis_x, axis_y: unit vector of the cone's axis.
        cos, sin, half_angle: half of the opening, at most an eighth of a turn.
    """
    turned = abs(axis_x) < abs(axis_y)  # sweep rows instead of columns
    lines, cells = (free.shape[1], free.shape[2]) if turned else (free.shape[2], free.shape[1])
    along, across = (y, x) if turned else (x, y)
    axis_along, axis_across = (axis_y, axis_x) if turned else (axis_x, axis_y)
    middle = math.atan2(axis_across, abs(axis_along))
    low, high = math.tan(max(middle - half_angle, -STEEPEST_RAD)), math.tan(min(middle + half_angle, STEEPEST_RAD))
    way = 1 if axis_along > 0.0 else -1
    best = reach
    line = math.floor(max(along, 0.0) if way > 0 else min(along, lines - 1.0))
    while 0 <= line < lines:
        near, far = (line - along, line + 1 - along) if way > 0 else (along - line - 1, along - line)
        near = max(near, 0.0)
        if near >= best:
            break
        first = max(across + min(near * low, far * low), across - best, 0.0)
        last = min(across + max(near * high, far * high), across + best, cells - 1.0)
        cell = math.floor(first)
        while cell <= last:
            column, row = (cell, line) if turned else (line, cell)
            side = max(free[0, row, column], free[2 if turned else 1, row, column])
            if side == 0:
                best = min(best, cell_in_cone(column - x, row - y, axis_x, axis_y, cos, sin, best))
            elif side == INSIDE and column <= x < column + 1 and row <= y < row + 1:
                return 0.0
            cell += 1 if side == 0 or side == INSIDE else int(side)
        line += way
    return best


@inline_kernel
def cell_in_cone(left: float, low: float, axis_x: float, axis_y: float, cos: float, sin: float, best: float) -> float:
    """Distance to the nearest point within the cone of a cell whose low left corner is (left, low) from the apex; at most `best`."""
    x, y = max(left, 0.0) + min(left + 1.0, 0.0), max(low, 0.0) + min(low + 1.0, 0.0)
    best2 = best * best
    if x * x + y * y >= best2:
        return best
    ahead, beside = x * axis_x + y * axis_y, y * axis_x - x * axis_y
    if abs(beside) * cos <= ahead * sin:
        return math.sqrt(x * x + y * y)
    # corners in the frame of the cone, counter-clockwise
    ax, ay = left * axis_x + low * axis_y, low * axis_x - left * axis_y
    bx, by = ax + axis_x, ay - axis_y
    cx, cy = bx + axis_y, by + axis_x
    dx, dy = ax + axis_y, ay + axis_x
    least2 = min(segment_in_sector(ax, ay, bx, by, cos, sin), segment_in_sector(bx, by, cx, cy, cos, sin))
    least2 = min(least2, segment_in_sector(cx, cy, dx, dy, cos, sin), segment_in_sector(dx, dy, ax, ay, cos, sin))
    return math.sqrt(least2) if least2 < best2 else best
