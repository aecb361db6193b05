"""A grid that goes along with the robot."""

from __future__ import annotations

import numpy as np


def shift(grid: np.ndarray[tuple[int, ...], np.dtype[np.generic]], di: int, dj: int, blank: float) -> None:
    """Move the contents of a square grid (n, n, …) by (-di, -dj) cells, in its place, and fill what comes in with `blank`."""
    n = grid.shape[0]
    if abs(di) >= n or abs(dj) >= n:
        grid[:] = blank
        return
    came_i, came_j = slice(n - di, n) if di > 0 else slice(0, -di), slice(n - dj, n) if dj > 0 else slice(0, -dj)
    to = grid[max(0, -di) : n - max(0, di), max(0, -dj) : n - max(0, dj)]
    to[:] = grid[max(0, di) : n - max(0, -di), max(0, dj) : n - max(0, -dj)]  # numpy minds that they overlap
    grid[came_i], grid[:, came_j] = blank, blank
