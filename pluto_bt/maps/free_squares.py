"""How far a ray may jump in a grid: for each cell, the largest empty square that begins there and grows one of four ways.

A ray heading up and right that stands in a cell whose up-right square has side s may leap to the edge of that square, for
nothing stands inside. Unlike a distance field, the square does not care for what the ray leaves behind or beside it.
The least of the four squares of a cell is its chessboard distance to the nearest obstacle.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.kernel import kernel

INSIDE = 255  # a solid cell whose eight neighbours are solid too
LONGEST = 254  # sides are cut here, so that they fit a byte

# planes of the result: way 0 grows to +x +y, 1 to -x +y, 2 to +x -y, 3 to -x -y
N_WAYS = 4


def free_squares(occupied: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Sides in cells of the free squares, (4, rows, columns) uint8; 0 = solid at the rim of an obstacle, `INSIDE` = deep in one.

    Outside of the grid all is free.
    """
    squares = np.zeros((N_WAYS, *occupied.shape), dtype=np.uint8)
    if occupied.size:
        fill_free_squares(np.ascontiguousarray(occupied, dtype=np.uint8).copy(), squares)
    return squares


@kernel
def fill_free_squares(occupied: NDArray[np.uint8], squares: NDArray[np.uint8]) -> None:
    """The largest-square recurrence, once for each way: side = 1 + the least side of the three neighbours that way."""
    rows, columns = occupied.shape
    for way in range(4):
        step_x = -1 if way & 1 else 1
        step_y = -1 if way & 2 else 1
        for j in range(rows):
            iy = rows - 1 - j if step_y > 0 else j
            for i in range(columns):
                ix = columns - 1 - i if step_x > 0 else i
                if occupied[iy, ix]:
                    continue
                side = LONGEST - 1
                if j > 0:
                    side = min(side, squares[way, iy + step_y, ix])
                if i > 0:
                    side = min(side, squares[way, iy, ix + step_x])
                if i > 0 and j > 0:
                    side = min(side, squares[way, iy + step_y, ix + step_x])
                squares[way, iy, ix] = side + 1
    for iy in range(1, rows - 1):
        for ix in range(1, columns - 1):
            solid = 0
            for neighbour in range(9):
                solid += occupied[iy - 1 + neighbour // 3, ix - 1 + neighbour % 3] != 0
            if solid == 9:
                for way in range(4):
                    squares[way, iy, ix] = INSIDE
