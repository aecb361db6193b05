"""The hot loops of wall follow against plain numpy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.skills.outline import Array, outline_of
from pluto_bt.skills.wall_kernels import bend_speed, keeps_away, nearest_of, seen_from, standing, way_lengths
from tests.chain.robots import ATRV2

PLANES = outline_of(ATRV2.body.outline_m).planes
SEEDS = st.integers(0, 2**32 - 1)


def path(rng: np.random.Generator, count: int = 40) -> Array:
    """A path that winds, with points 6 cm apart, beginning anywhere near the robot."""
    headings = rng.uniform(-3.0, 3.0) + np.cumsum(rng.normal(0.0, 0.3, count))
    steps = 0.06 * np.column_stack((np.cos(headings), np.sin(headings)))
    return np.column_stack((rng.uniform(-1.0, 1.0, 2) + np.cumsum(steps, axis=0), headings))


@given(SEEDS, st.integers(0, 300), st.sampled_from((1.0, -1.0)))
@settings(max_examples=60, deadline=None)
def test_what_stands_is_what_neither_moves_nor_lies_within_the_robot_nor_is_alone(seed: int, count: int, side: float) -> None:
    rng = np.random.default_rng(seed)
    points = np.zeros((count, 5))
    points[:, :2] = rng.uniform(-3.0, 3.0, (count, 2))
    points[:, 3:] = rng.normal(0.0, 1.0, (count, 2)) * (rng.random((count, 1)) < 0.2)
    rest = points[(points[:, 3:] == 0.0).all(axis=1), :2]
    squares = np.floor(rest / 0.25).astype(int)
    has_other = [(np.abs(squares - square).max(axis=1) <= 1).sum() > 1 for square in squares]
    is_far = np.hypot(*rest.T) >= 2.5
    is_outside = (rest @ PLANES[:, :2].T > PLANES[:, 2]).any(axis=1)
    assert np.array_equal(standing(points, PLANES, side, 0.25, 2.5), rest[is_outside & (np.array(has_other, dtype=bool) | is_far)] * (1.0, side))


@given(SEEDS)
@settings(max_examples=40, deadline=None)
def test_the_nearest_point_of_a_path_and_its_way(seed: int) -> None:
    way = path(np.random.default_rng(seed))
    assert nearest_of(way, 0.006) == np.argmin(np.hypot(way[:, 0], way[:, 1]) + 0.006 * np.arange(len(way)))
    steps = np.hypot(*np.diff(way[7:, :2], axis=0).T)
    assert way_lengths(way, 7) == pytest.approx(np.concatenate(([0.0], np.cumsum(steps))))


@given(SEEDS, st.floats(0.05, 1.0))
@settings(max_examples=60, deadline=None)
def test_a_path_keeps_away_if_no_third_point_of_its_stretch_is_nearer(seed: int, least_m: float) -> None:
    rng = np.random.default_rng(seed)
    way, points = path(rng), rng.uniform(-3.0, 3.0, (20, 2))
    asked = way[5:25:3]
    gaps = np.hypot(asked[:, :1] - points[:, 0], asked[:, 1:2] - points[:, 1])
    assert keeps_away(way, 5, 25, 3, points, least_m) == bool(gaps.min() >= least_m)
    assert keeps_away(way, 5, 25, 3, np.zeros((0, 2)), least_m)


@given(SEEDS)
@settings(max_examples=40, deadline=None)
def test_a_path_seen_from_elsewhere_lies_where_it_lay(seed: int) -> None:
    rng = np.random.default_rng(seed)
    way, before, now = path(rng), tuple(rng.uniform(-3.0, 3.0, 3).tolist()), tuple(rng.uniform(-3.0, 3.0, 3).tolist())
    world = before[0] + 1j * before[1] + (way[:, 0] + 1j * way[:, 1]) * np.exp(1j * before[2])
    here = (world - now[0] - 1j * now[1]) * np.exp(-1j * now[2])
    assert seen_from(way, before, now) == pytest.approx(np.column_stack((here.real, here.imag, way[:, 2] + before[2] - now[2])))


@given(SEEDS)
@settings(max_examples=60, deadline=None)
def test_the_speed_before_bends_is_the_least_that_any_of_them_allows(seed: int) -> None:
    way, first, bend_m, most_radps, brake_mps2 = path(np.random.default_rng(seed)), 6, 0.24, 0.5, 0.2
    way_m = way_lengths(way, first)
    later = np.minimum(np.searchsorted(way_m, way_m + bend_m), len(way_m) - 1)
    turns = np.abs(np.remainder(way[first:, 2][later] - way[first:, 2] + math.pi, math.tau) - math.pi)
    allowed = np.sqrt((most_radps / np.maximum(turns / bend_m, 1e-3)) ** 2 + 2.0 * brake_mps2 * way_m)
    assert bend_speed(way, first, way_m, bend_m, most_radps, brake_mps2) == pytest.approx(allowed.min())
