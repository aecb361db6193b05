"""Rays that leap over free squares see, bit for bit, what the plain walk from cell to cell sees."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from slow_rays import slow_walk

from pluto_bt.maps.free_squares import INSIDE, LONGEST, free_squares
from pluto_bt.maps.grid_rays import grid_range
from pluto_bt.maps.kernel import kernel

REACH = 50.0


@kernel
def grid_ranges(free, x, y, directions, reach, out):
    """`grid_range` along each of the (n, 2) unit directions; it is only there to be built into other kernels."""
    for i in range(directions.shape[0]):
        out[i] = grid_range(free, x, y, directions[i, 0], directions[i, 1], reach)


def ranges(occupied, x, y, angles, reach=REACH):
    directions = np.column_stack((np.cos(angles), np.sin(angles)))
    out = np.zeros(len(directions))
    grid_ranges(free_squares(occupied), x, y, directions, reach, out)
    return out, directions


def must_equal_the_walk(occupied, x, y, angles):
    out, directions = ranges(occupied, x, y, angles)
    for got, (dx, dy) in zip(out, directions, strict=True):
        assert got == slow_walk(occupied, x, y, float(dx), float(dy), REACH)


def random_grid(rng, share):
    return (rng.random((rng.integers(1, 30), rng.integers(1, 30))) < share).astype(np.uint8)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32), st.sampled_from([0.0, 0.01, 0.1, 0.4]))
def test_any_ray_from_anywhere_in_or_outside_of_any_grid(seed, share):
    rng = np.random.default_rng(seed)
    must_equal_the_walk(random_grid(rng, share), rng.uniform(-8, 35), rng.uniform(-8, 35), rng.uniform(-4, 4, 20))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32), st.integers(0, 60), st.integers(0, 60))
def test_rays_from_cell_borders_along_axes_and_diagonals(seed, x2, y2):
    occupied = random_grid(np.random.default_rng(seed), 0.1)
    must_equal_the_walk(occupied, x2 / 2, y2 / 2, np.arange(-8, 9) * math.pi / 8)


@pytest.mark.parametrize("seed", range(8))
def test_rays_that_begin_on_the_outer_border(seed):
    rng = np.random.default_rng(seed)
    occupied = random_grid(rng, 0.3)
    rows, columns = occupied.shape
    along_x, along_y = rng.integers(0, 2 * columns + 1) / 2, rng.integers(0, 2 * rows + 1) / 2
    for x, y in ((0.0, along_y), (columns, along_y), (along_x, 0.0), (along_x, rows)):
        must_equal_the_walk(occupied, float(x), float(y), np.arange(-8, 9) * math.pi / 8)


def test_a_ray_that_leaves_the_grid_through_a_corner_still_touches_the_cell_beside_it():
    occupied = np.zeros((4, 4), dtype=np.uint8)
    occupied[1, 0] = 1
    must_equal_the_walk(occupied, 0.0, 2.0, np.array([-2.0, -2.5, -3.0, 3.0]))
    must_equal_the_walk(occupied, 1.0, 3.0, np.array([-3 * math.pi / 4]))


@pytest.mark.parametrize(("dx", "dy", "expected"), [(1.0, 0.0, 2.5), (-1.0, 0.0, 2.5), (0.0, 1.0, 2.5), (0.0, -1.0, 2.5), (-0.0, 1.0, 2.5)])
def test_exactly_axis_parallel_rays_end_at_the_border_of_the_cell(dx, dy, expected):
    occupied = np.zeros((7, 7), dtype=np.uint8)
    occupied[[0, -1], :] = occupied[:, [0, -1]] = 1
    out = np.zeros(1)
    grid_ranges(free_squares(occupied), 3.5, 3.5, np.array([[dx, dy]]), REACH, out)
    assert out[0] == expected


def test_a_ray_on_a_line_between_cells_stays_in_the_cell_above():
    occupied = np.zeros((6, 6), dtype=np.uint8)
    occupied[2, 5] = 1
    out = np.zeros(1)
    grid_ranges(free_squares(occupied), 1.0, 3.0, np.array([[1.0, 0.0]]), REACH, out)
    assert out[0] == REACH
    occupied[3, 5] = 1
    grid_ranges(free_squares(occupied), 1.0, 3.0, np.array([[1.0, 0.0]]), REACH, out)
    assert out[0] == 4.0


def test_from_a_solid_cell_the_range_is_zero_also_deep_inside():
    occupied = np.ones((9, 9), dtype=np.uint8)
    assert free_squares(occupied)[0, 4, 4] == INSIDE
    for x, y in ((4.5, 4.5), (0.1, 0.1)):
        out, _ = ranges(occupied, x, y, np.linspace(-3, 3, 9))
        assert (out == 0.0).all()


def test_nothing_is_seen_behind_the_reach_or_outside_of_the_grid():
    occupied = np.zeros((20, 20), dtype=np.uint8)
    occupied[10, 15] = 1
    assert ranges(occupied, 5.5, 10.5, np.array([0.0]), 9.5)[0][0] == 9.5
    assert ranges(occupied, 5.5, 10.5, np.array([0.0]), 9.6)[0][0] == 9.5
    assert ranges(occupied, 5.5, 10.5, np.array([0.3]))[0][0] == REACH
    assert ranges(occupied, -5.0, 10.5, np.array([0.0]))[0][0] == 20.0
    assert ranges(occupied, -5.0, 10.5, np.array([math.pi]))[0][0] == REACH


def slow_square(occupied, ix, iy, way):
    """Side of the largest free square at a cell, by trying."""
    rows, columns = occupied.shape
    side = 0
    while side < LONGEST:
        xs = range(ix, ix + side + 1) if not way & 1 else range(ix - side, ix + 1)
        ys = range(iy, iy + side + 1) if not way & 2 else range(iy - side, iy + 1)
        if any(0 <= x < columns and 0 <= y < rows and occupied[y, x] for x in xs for y in ys):
            break
        side += 1
        if side > rows + columns:
            return LONGEST
    return side


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32))
def test_free_squares_are_free_and_the_largest(seed):
    rng = np.random.default_rng(seed)
    occupied = (rng.random((rng.integers(3, 9), rng.integers(3, 9))) < 0.2).astype(np.uint8)
    squares = free_squares(occupied)
    for way, iy, ix in np.ndindex(squares.shape):
        if squares[way, iy, ix] != INSIDE:
            assert squares[way, iy, ix] == slow_square(occupied, ix, iy, way)


def test_leaps_longer_than_a_byte_are_taken_in_steps():
    occupied = np.zeros((3, 900), dtype=np.uint8)
    occupied[1, 899] = 1
    out, _ = ranges(occupied, 0.25, 1.5, np.array([0.0]), 2000.0)
    assert out[0] == 898.75
