"""The free ways of all headings against a slow twin that looks at one heading after another."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.skills.outline import Array
from pluto_bt.skills.steering import CLEAR_M, HEADINGS, STEP_RAD, corridors

FRONT_M, BACK_M, SIDE_M, LOOK_M, FAR_M = 0.6, 0.5, 0.4, 1.5, 3.0
NONE: Array = np.zeros((0, 5))
ALL_ROUND: Array = np.append(-math.pi + STEP_RAD * np.arange(HEADINGS), 0.3)


def plain_way(points: Array, heading_rad: float) -> tuple[float, float]:
    """(free m, room m) of one heading."""
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    free_m, room_m = FAR_M, 1.0
    for x, y, margin_m, _, _ in points.tolist():
        ahead_m, aside_m = c * x + s * y, abs(c * y - s * x)
        if ahead_m < -BACK_M or ahead_m > FAR_M + FRONT_M:
            continue
        gap_m = aside_m - SIDE_M
        if gap_m < margin_m + CLEAR_M:
            if ahead_m > 0.0:
                free_m = min(free_m, max(0.0, ahead_m - FRONT_M - margin_m))
        elif ahead_m < LOOK_M:
            room_m = min(room_m, gap_m)
    return free_m, room_m


@given(st.integers(0, 2**32 - 1), st.integers(0, 300))
@settings(max_examples=40, deadline=None)
def test_ways_shortened_point_by_point_are_those_found_heading_by_heading(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    points = np.column_stack((rng.uniform(-4.0, 4.0, (count, 2)), rng.choice((0.1, 0.3), count), rng.normal(0.0, 1.0, (count, 2))))
    ways = corridors(points, ALL_ROUND, FRONT_M, BACK_M, SIDE_M, LOOK_M, FAR_M)
    assert ways.T.tolist() == [list(plain_way(points, heading_rad)) for heading_rad in ALL_ROUND.tolist()]


def test_where_nothing_stands_every_way_is_free() -> None:
    ways = corridors(NONE, ALL_ROUND, FRONT_M, BACK_M, SIDE_M, LOOK_M, FAR_M)
    assert (ways[0] == FAR_M).all() and (ways[1] == 1.0).all()
