"""A grid that goes along with the robot, against a slow twin that looks up one cell after another."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.skills.grid_shift import shift

STEPS = st.integers(-9, 9)


@given(st.integers(1, 8), STEPS, STEPS, st.sampled_from([(), (2,)]))
def test_each_cell_holds_what_was_so_many_cells_on_and_new_ones_are_blank(n: int, di: int, dj: int, more: tuple[int, ...]) -> None:
    grid = np.arange(n * n * (2 if more else 1), dtype=float).reshape(n, n, *more)
    before = grid.copy()
    shift(grid, di, dj, -1.0)
    for i in range(n):
        for j in range(n):
            is_known = 0 <= i + di < n and 0 <= j + dj < n
            np.testing.assert_array_equal(grid[i, j], before[i + di, j + dj] if is_known else -1.0)
