"""A grid that goes along with the robot."""

from __future__ import annotations

import numpy as np


def shift(grid: np.ndarray[tuple[int, ...], np.dtype[np.generic]], di: int, dj: int, blank: float) -> None:
    """Move the contents of a square grid by (-di, -dj) cells and fill with `blank`."""
    old = grid.copy()
    grid[:] = blank
    n = grid.shape[0]
    if abs(di) < n and abs(dj) < n:
        grid[max(0, -di) : n - max(0, di), max(0, -dj) : n - max(0, dj)] = old[max(0, di) : n - max(0, -di), max(0, dj) : n - max(0, -dj)]
