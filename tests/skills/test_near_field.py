"""The field of a small grid against the distances of all its cells from all points."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.skills.near_field import CELL_M, near_field
from tests.skills.field_probe import asked

ROWS, COLUMNS = 30, 22


def cells(points: np.ndarray) -> np.ndarray:
    """The cells in which points lie, those outside the grid left out."""
    near = np.round(points / CELL_M).astype(int)
    return near[((near >= 0) & (near < (ROWS, COLUMNS))).all(axis=1)]


@given(st.integers(0, 2**32 - 1), st.integers(0, 12), st.floats(0.2, 2.0))
@settings(max_examples=60, deadline=None)
def test_each_cell_says_how_far_the_nearest_point_is(seed: int, count: int, most_m: float) -> None:
    points = np.random.default_rng(seed).uniform(-0.5, 2.2, (count, 2))
    there = cells(points)
    i, j = np.indices((ROWS, COLUMNS))
    away_m = np.full((ROWS, COLUMNS), np.inf)
    for a, b in there:
        away_m = np.minimum(away_m, CELL_M * np.hypot(i - a, j - b))
    assert near_field(points, ROWS, COLUMNS, most_m) == pytest.approx(np.minimum(away_m, most_m))


@given(st.integers(0, 2**32 - 1), st.floats(-1.0, 3.0), st.floats(-1.0, 3.0))
@settings(max_examples=60, deadline=None)
def test_between_cells_it_is_between_their_values_and_outside_it_is_that_of_the_border(seed: int, x_m: float, y_m: float) -> None:
    points = np.random.default_rng(seed).uniform(0.0, 1.2, (5, 2))
    field = near_field(points, ROWS, COLUMNS, 3.0)
    x, y = np.clip(x_m / CELL_M, 0.0, ROWS - 1.001), np.clip(y_m / CELL_M, 0.0, COLUMNS - 1.001)
    i, j = int(x), int(y)
    four = field[i : i + 2, j : j + 2]
    u, v = np.array([1.0 - (x - i), x - i]), np.array([1.0 - (y - j), y - j])
    assert asked(field, x_m, y_m) == pytest.approx(u @ four @ v)
    assert four.min() - 1e-9 <= asked(field, x_m, y_m) <= four.max() + 1e-9
