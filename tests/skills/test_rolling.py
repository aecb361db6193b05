"""The rolling ball, which looks only at points near by, against one that looks at all of them at every step."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.skills.outline import Array
from pluto_bt.skills.rolling import FIT_M, PUSHES, WEDGED_M, roll

Rows = list[list[float]]


def plain_roll(points: Array, x: float, y: float, radius_m: float, step_m: float, count: int) -> Rows:
    """As `roll`, with the nearest of all points each time."""
    places: Rows = points.tolist()
    rows: Rows = []
    touched = -1
    for k in range(count):
        first, overlap_m, i = -1, 0.0, -1
        for _ in range(PUSHES):
            squares = [(px - x) * (px - x) + (py - y) * (py - y) for px, py in places]
            i = squares.index(min(squares))
            distance_m = math.sqrt(squares[i])
            overlap_m = radius_m - distance_m
            if overlap_m < FIT_M:
                break
            first = i if first < 0 and i != touched else first
            x += overlap_m * (x - places[i][0]) / max(distance_m, 1e-6)
            y += overlap_m * (y - places[i][1]) / max(distance_m, 1e-6)
        if overlap_m > WEDGED_M:
            break
        touched = first if first >= 0 and k > 0 else i
        dx, dy = x - places[touched][0], y - places[touched][1]
        distance_m = max(math.sqrt(dx * dx + dy * dy), 1e-6)
        if first < 0 or k == 0:
            x, y = places[touched][0] + radius_m * dx / distance_m, places[touched][1] + radius_m * dy / distance_m
        rows.append([x, y, *places[touched]])
        x, y = x - step_m * dy / distance_m, y + step_m * dx / distance_m
    return rows


@given(st.integers(0, 2**32 - 1), st.integers(1, 120), st.floats(0.2, 1.2), st.floats(0.03, 0.3))
@settings(max_examples=60, deadline=None)
def test_a_ball_that_looks_near_by_rolls_as_one_that_looks_everywhere(seed: int, count: int, radius_m: float, step_m: float) -> None:
    rng = np.random.default_rng(seed)
    bearings = np.sort(rng.uniform(0.0, math.tau, count))
    ranges_m = np.abs(rng.uniform(1.5, 5.0) + np.cumsum(rng.normal(0.0, 0.1, count))) + 0.5
    points = np.column_stack((ranges_m * np.cos(bearings), ranges_m * np.sin(bearings)))
    x, y = rng.uniform(-2.0, 2.0, 2).tolist()
    assert roll(points, x, y, radius_m, step_m, 60).tolist() == plain_roll(points, x, y, radius_m, step_m, 60)


def test_a_ball_rolls_nowhere_where_nothing_stands() -> None:
    assert len(roll(np.zeros((0, 2)), 0.0, 0.0, 0.5, 0.1, 10)) == 0
