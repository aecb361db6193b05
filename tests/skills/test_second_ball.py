"""The second ball's kernel against a slow twin in numpy, and what the path inside the ball is."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.skills.outline import Array
from pluto_bt.skills.rolling import roll
from pluto_bt.skills.second_ball import BENDS_M, EVERY, LEFT_OUT_M, STEP_M, STEPS, along, inside

SEEDS = st.integers(0, 2**32 - 1)


def wall(rng: np.random.Generator) -> Array:
    """A wall with posts, niches and gaps, left of somebody who goes along +x."""
    x = np.sort(rng.uniform(-4.0, 8.0, int(rng.integers(60, 300))))
    return np.column_stack((x, 1.5 + rng.choice([0.0, 0.0, 0.0, 0.8, 2.0], x.size) + 0.05 * rng.normal(size=x.size)))


def twin(rows: Array, normals_rad: Array, first: Array, end_rad: float, inner_m: float) -> Array:
    """`along`, an array at a time."""
    nothing = np.zeros((0, 5))
    at_end = np.flatnonzero((rows[:, 2] == first[-1, 2]) & (rows[:, 3] == first[-1, 3]))
    over = at_end[np.remainder(normals_rad[at_end] - end_rad + math.pi, math.tau) - math.pi >= 0.0]
    if not len(over):
        return nothing
    count = max(int(over[0]), 2)
    rows, normals_rad = rows[:count], np.unwrap(normals_rad[:count])
    asked = first[first[:, 2] != first[-1, 2]][::EVERY]
    apart = (asked[:, :1] - rows[::EVERY, 0]) ** 2 + (asked[:, 1:2] - rows[::EVERY, 1]) ** 2
    if (apart.min(axis=1) > LEFT_OUT_M**2).any():
        return nothing
    steps = np.maximum(1, np.ceil(np.abs(np.diff(normals_rad)) * (inner_m + BENDS_M) / STEP_M)).astype(np.intp)
    which = np.repeat(np.arange(len(steps)), steps)
    share = (np.arange(len(which)) - np.repeat(np.cumsum(steps) - steps, steps)) / steps[which]
    middle = rows[which, :2] + share[:, None] * np.diff(rows[:, :2], axis=0)[which]
    return np.column_stack((middle, normals_rad[which] + share * np.diff(normals_rad)[which], rows[which, 2:]))


@settings(max_examples=60, deadline=None)
@given(SEEDS)
def test_the_ball_goes_along_a_wall_as_its_slow_twin(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, radius_m = wall(rng), float(rng.uniform(0.3, 0.6))
    first = roll(points, -4.0, 0.8, radius_m, STEP_M, 120)
    rows = roll(first[:, 2:].copy(), -4.0, 0.8, radius_m * float(rng.uniform(1.0, 3.0)), STEP_M, STEPS)
    if not len(first) or not len(rows):
        return
    normals_rad = np.arctan2(rows[:, 1] - rows[:, 3], rows[:, 0] - rows[:, 2])
    end_rad, inner_m = math.atan2(first[-1, 1] - first[-1, 3], first[-1, 0] - first[-1, 2]), float(rng.uniform(0.0, 0.5))
    np.testing.assert_array_equal(
        along(rows, normals_rad, first, end_rad, inner_m), twin(rows, normals_rad, first, end_rad, inner_m)
    )  # fmt: skip


def test_the_path_keeps_its_distance_from_a_straight_wall_and_has_no_gaps_round_its_end() -> None:
    flat = np.column_stack((np.arange(-3.0, 0.0, 0.02), np.full(150, 1.0)))
    chain = np.vstack((flat, np.column_stack((np.full(100, flat[-1, 0]), np.arange(1.02, 3.02, 0.02)))))  # goes on to the left
    first = roll(chain, -2.5, 0.5, 0.5, STEP_M, 70)
    path = inside(first[:, 2:].copy(), first, 0.5, 0.6, 0.5)
    assert path is not None
    beside = path[path[:, 0] < -0.3]
    np.testing.assert_allclose(beside[:, 1], 0.5, atol=0.005)
    assert np.hypot(*np.diff(path[:, :2], axis=0).T).max() < 2.0 * STEP_M
    assert path[-1, 2] > math.pi / 4  # it has turned round the corner


def test_nothing_leads_along_a_wall_that_the_ball_never_comes_to_the_end_of() -> None:
    points = np.column_stack((np.arange(-3.0, 3.0, 0.05), np.full(120, 1.0)))
    first = roll(points, -2.5, 0.5, 0.5, STEP_M, 40)
    rows = roll(points, -2.5, 0.5, 0.5, STEP_M, 10)
    assert not len(along(rows, np.full(len(rows), -math.pi / 2), first, -math.pi / 2, 0.0))
