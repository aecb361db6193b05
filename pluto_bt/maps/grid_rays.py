"""Rays through a grid of cells, exact to the border of the cell that stops them.

The reference is the walk of Amanatides and Woo (1987) in closed form: the ray from (x, y) along (dx, dy) crosses the vertical
line k at (k - x) * (1 / dx), the horizontal line k at (k - y) * (1 / dy), and at a tie the horizontal one first. The leaps over
free squares use the same numbers and the same rule, so that the range is bit for bit that of the walk from cell to cell.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.free_squares import INSIDE
from pluto_bt.maps.kernel import inline_kernel

FAR = 1e300  # stands for 1 / 0: a ray along a line never crosses it
NEAR_A_LINE = 1e-6  # cells; far above the rounding of a position, which is below 1e-9 in any grid that fits the memory
NEVER = 1e-200  # a slope below this is taken for none


@inline_kernel
def settle(at: float, ahead: float, per: float, t: float, i: int, side: int, rising: bool, ties: bool) -> int:
    """The row or column that the walk has come to at `t`, between the one it was in, `i`, and `side` - 1 further.

    Near a line the cell of the position `ahead` may be one off; the closed form decides. `ties`: a line crossed exactly at `t` counts.
    """
    if rising:
        cell = min(max(math.floor(ahead), i), i + side - 1)
        while cell < i + side - 1 and crossed((cell + 1 - at) * per, t, ties):
            cell += 1
        while cell > i and not crossed((cell - at) * per, t, ties):
            cell -= 1
    else:
        cell = max(min(math.floor(ahead), i), i - side + 1)
        while cell > i - side + 1 and crossed((cell - at) * per, t, ties):
            cell -= 1
        while cell < i and not crossed((cell + 1 - at) * per, t, ties):
            cell += 1
    return cell


@inline_kernel
def crossed(t_line: float, t: float, ties: bool) -> bool:
    """Whether a line crossed at `t_line` lies behind at `t`."""
    return t_line <= t if ties else t_line < t


@inline_kernel
def grid_entry(rows: int, columns: int, x: float, y: float, dx: float, dy: float, per_x: float, per_y: float) -> tuple[float, int, int]:
    """When, and in which cell, a ray comes into the grid: at 0 if it begins inside; time `FAR` if it never does."""
    if 0.0 <= x < columns and 0.0 <= y < rows:
        return 0.0, int(x), int(y)
    tx, ty = entry_time(x, columns, per_x), entry_time(y, rows, per_y)
    t = max(tx, ty)
    if t >= FAR or t < 0.0:
        return FAR, 0, 0
    ix, iy = math.floor(x), math.floor(y)
    if tx >= ty:
        ix = 0 if per_x > 0.0 else columns - 1
        iy = settle(y, y + t * dy, per_y, t, iy, rows + abs(iy) + 2, per_y > 0.0, True)
    else:
        iy = 0 if per_y > 0.0 else rows - 1
        ix = settle(x, x + t * dx, per_x, t, ix, columns + abs(ix) + 2, per_x > 0.0, False)
    if 0 <= ix < columns and 0 <= iy < rows:
        return t, ix, iy
    return FAR, 0, 0


@inline_kernel
def entry_time(at: float, size: int, per: float) -> float:
    """When the ray comes into [0, size) on one axis: at its near end; `FAR` = never; -1 = it is inside already."""
    if at < 0.0:
        return -at * per if 0.0 < per < FAR else FAR
    if at >= size:
        return (size - at) * per if per < 0.0 else FAR
    return -1.0


@inline_kernel
def grid_range(free: NDArray[np.uint8], x: float, y: float, dx: float, dy: float, reach: float) -> float:
    """Range to the first solid cell; `reach` if none is nearer or the ray leaves the grid. All in cells.

    Args:
        free: (4, rows, columns) of `free_squares`.
        x, y: where the ray begins, also outside of the grid; finite. In a solid cell the range is 0.
        dx, dy: unit direction.
        reach: where the ray ends.
    """
    rows, columns = free.shape[1], free.shape[2]
    per_x = 1.0 / dx if abs(dx) > NEVER else FAR
    per_y = 1.0 / dy if abs(dy) > NEVER else FAR
    t, ix, iy = grid_entry(rows, columns, x, y, dx, dy, per_x, per_y)
    if t >= reach:
        return reach
    right, up = per_x > 0.0, per_y > 0.0
    way = (0 if right else 1) + (0 if up else 2)
    if free[way, iy, ix] == INSIDE:
        return t
    # the edge of a square of side s lies at line ix + s for a ray to the right, at ix + 1 - s for one to the left
    way_x, near_x = (1, 0) if right else (-1, 1)
    way_y, near_y = (1, 0) if up else (-1, 1)
    while True:
        side = int(free[way, iy, ix])
        if side == 0:
            return t
        tx = (ix + near_x + way_x * side - x) * per_x
        ty = (iy + near_y + way_y * side - y) * per_y
        leaps_x = tx < ty
        t = tx if leaps_x else ty
        if t >= reach:
            return reach
        across = (y if leaps_x else x) + t * (dy if leaps_x else dx)
        cell = int(across)
        if abs(across - cell - 0.5) > 0.5 - NEAR_A_LINE:
            at, per, i, rising = (y, per_y, iy, up) if leaps_x else (x, per_x, ix, right)
            cell = settle(at, across, per, t, i, side, rising, leaps_x)
        ix = ix + way_x * side if leaps_x else cell
        iy = cell if leaps_x else iy + way_y * side
        if ix < 0 or iy < 0 or ix >= columns or iy >= rows:
            return reach
