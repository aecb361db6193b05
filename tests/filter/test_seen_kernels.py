"""The hot loops of the filter's space against slow twins that look at one cell after another, or at all of them at once."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.skills.outline import Array, outline_of
from pluto_bt.skills.seen_kernels import (
    ALONG,
    ANYHOW,
    BEAM_SLACK_M,
    BESIDE_M,
    CAME,
    CELL_M,
    CONE_SLACK_M,
    FRESH_S,
    HIDDEN,
    INSIDE,
    INSIDE_M,
    LATELY_S,
    LEVEL,
    LOW,
    NEVER,
    SUDDEN,
    SUDDEN_M,
    TOUCHING_M,
    TWICE_S,
    UNKNOWN,
    UNSEEN,
    hear_cones,
    see_beams,
    stand,
)
from tests.chain.robots import ATRV2

OUTLINE = outline_of(ATRV2.body.outline_m)
N = 81
CORNER = (-2.02, -1.97)
NOW_S, MOST_M, FLEETING_S = 2.0, 1.6, 1.0
SEEDS = st.integers(0, 2**32 - 1)
STEP_M = 0.7 * CELL_M


class Cells(NamedTuple):
    """The four arrays of a space."""

    seen: Array
    heard: Array
    stamps: Array
    spots: Array

    def copy(self) -> Cells:
        return Cells(*(cells.copy() for cells in self))

    def equals(self, other: Cells) -> bool:
        return all(np.array_equal(a, b) for a, b in zip(self, other, strict=True))


def cells(rng: np.random.Generator, free: float = 0.97) -> Cells:
    """A space in which something stands in few cells, each at its own place and time."""
    stamps = np.where(rng.random((2, N, N)) < free, NEVER, rng.uniform(0.0, NOW_S, (2, N, N)))
    at = np.stack(np.meshgrid(np.arange(N), np.arange(N)), axis=-1) + rng.random((2, N, N, 2))
    seen = np.where(rng.random((N, N)) < 0.5, NEVER, rng.uniform(0.0, NOW_S, (N, N)))
    heard = np.where(rng.random((2, N, N)) < 0.5, NEVER, rng.uniform(0.0, NOW_S, (2, N, N)))
    return Cells(seen, heard, stamps, at * CELL_M + CORNER)


def middles() -> tuple[Array, Array]:
    """x, y of the middle of each cell."""
    at = (np.arange(N) + 0.5) * CELL_M
    x, y = np.meshgrid(CORNER[0] + at, CORNER[1] + at)
    return x, y


def cell_at(x: float, y: float) -> tuple[int, int] | None:
    row, column = math.floor((y - CORNER[1]) / CELL_M), math.floor((x - CORNER[0]) / CELL_M)
    return (row, column) if 0 <= row < N and 0 <= column < N else None


def put(to: Cells, layer: int, x: float, y: float, from_x: float, from_y: float, stamp_s: float) -> None:
    at = cell_at(x, y)
    if at is None:
        return
    last = to.spots[layer][at]
    if to.stamps[layer][at] != stamp_s or math.hypot(x - from_x, y - from_y) < math.hypot(last[0] - from_x, last[1] - from_y):
        to.stamps[layer][at], to.spots[layer][at] = stamp_s, (x, y)


def plain_beams(to: Cells, x: float, y: float, first_rad: float, step_rad: float, ranges: Array, believed: Array) -> None:
    n = len(ranges)
    for i in range(0, n, 2):
        beside = [ranges[j] for j in (i, max(i - 1, 0), min(i + 1, n - 1))]
        if not all(r > 0.0 for r in beside):  # NaN compares False
            continue
        free_m = min(min(beside) - BEAM_SLACK_M, MOST_M)
        c, s = math.cos(first_rad + i * step_rad), math.sin(first_rad + i * step_rad)
        passed: list[tuple[int, int]] = []
        for k in range(int(free_m / STEP_M) + 1 if free_m >= 0.0 else 0):
            at = cell_at(x + c * min(STEP_M * k, free_m), y + s * min(STEP_M * k, free_m))
            if at is None:
                break
            to.seen[at] = NOW_S
            spot = to.spots[LEVEL][at]
            away_m, aside_m = math.hypot(spot[0] - x, spot[1] - y), abs(c * (spot[1] - y) - s * (spot[0] - x))
            if NEVER < to.stamps[LEVEL][at] < NOW_S and away_m < free_m and aside_m < max(BESIDE_M, 2.0 * away_m * step_rad):
                passed.append(at)
        for at in passed if len(set(passed)) < ALONG else ():
            to.stamps[LEVEL][at] = NEVER
    for i in np.flatnonzero((ranges > 0.0) & (ranges < MOST_M) & (believed != 0.0)).tolist():
        angle = first_rad + i * step_rad
        put(to, LEVEL, x + ranges[i] * math.cos(angle), y + ranges[i] * math.sin(angle), x, y, NOW_S)


@given(SEEDS)
@settings(max_examples=25, deadline=None)
def test_beams_free_and_fill_the_cells_that_they_do_one_by_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, y, first_rad = (float(rng.uniform(-most, most)) for most in (1.9, 1.9, 3.0))
    ranges = rng.uniform(0.0, 3.0) + 0.4 * np.sin(np.arange(91) / rng.uniform(1.0, 20.0)) + rng.normal(0.0, 0.05, 91)
    ranges[rng.random(91) < 0.05] = np.nan
    believed = (rng.random(91) < 0.9).astype(float)
    kernel_s = cells(rng)
    plain = kernel_s.copy()
    see_beams(kernel_s.seen, kernel_s.stamps, kernel_s.spots, *CORNER, x, y, first_rad, 0.035, ranges, believed, NOW_S, MOST_M)
    plain_beams(plain, x, y, first_rad, 0.035, ranges, believed)
    assert kernel_s.equals(plain)


def plain_stand(to: Cells, pose: tuple[float, float, float], grown_m: float, since_s: float, window_m: float) -> list[list[float]]:
    (x0, y0, theta), planes = pose, OUTLINE.planes
    c, s = math.cos(theta), math.sin(theta)

    def outside_m(dx: Array, dy: Array) -> Array:
        return np.asarray(np.max([nx * (c * dx + s * dy) + ny * (c * dy - s * dx) - at_m for nx, ny, at_m in planes], axis=0))

    x, y = middles()
    near_m = OUTLINE.reach_m + grown_m + CELL_M
    is_near = (np.abs(x - x0) < window_m + CELL_M) & (np.abs(y - y0) < window_m + CELL_M)  # far more than the robot
    to.seen[is_near & ((x - x0) ** 2 + (y - y0) ** 2 < near_m**2) & (outside_m(x - x0, y - y0) < grown_m - CELL_M)] = NOW_S
    rows, columns = (
        range(max(0, math.floor((at - window_m - low) / CELL_M)), min(N, math.floor((at + window_m - low) / CELL_M) + 1))
        for at, low in ((y0, CORNER[1]), (x0, CORNER[0]))
    )
    points = []
    for row in rows:
        for column in columns:
            for layer in (LEVEL, LOW):
                if to.stamps[layer, row, column] == NEVER:
                    continue
                dx, dy = to.spots[layer, row, column] - (x0, y0)
                beside = to.stamps[LEVEL, max(0, row - 1) : row + 2, max(0, column - 1) : column + 2]
                is_old = to.stamps[layer, row, column] < since_s or (layer == LOW and (beside > NEVER).any())
                if is_old or outside_m(dx, dy) < INSIDE_M:
                    to.stamps[layer, row, column] = NEVER
                else:
                    points.append([c * dx + s * dy, c * dy - s * dx, float(layer), 0.0])
    return points


@given(SEEDS, st.sampled_from((0.0, 0.5)))
@settings(max_examples=30, deadline=None)
def test_where_the_robot_stands_is_free_and_the_points_around_it_are_gathered_cell_by_cell(seed: int, grown_m: float) -> None:
    rng = np.random.default_rng(seed)
    x, y, theta = (float(rng.uniform(-most, most)) for most in (0.8, 0.8, 3.0))
    kernel_s, out = cells(rng), np.zeros((4000, 4))
    plain = kernel_s.copy()
    count = stand(
        kernel_s.seen, kernel_s.stamps, kernel_s.spots, *CORNER, x, y, theta, OUTLINE.planes, OUTLINE.reach_m, grown_m, NOW_S, 0.5, 1.4, out
    )  # fmt: skip
    assert out[:count].tolist() == plain_stand(plain, (x, y, theta), grown_m, 0.5, 1.4)
    assert kernel_s.equals(plain)


def covered(apex_m: float, axis_m: float, side_m: float, low_m: float) -> slice:
    """The rows or columns from a cone's apex to the end of its axis, and so much beside."""
    ends = apex_m + min(0.0, axis_m - abs(side_m)), apex_m + max(0.0, axis_m + abs(side_m))
    first, last = (math.floor((end - low_m) / CELL_M) for end in ends)
    return slice(max(0, first), max(0, min(N, last + 1)))


def square(cone: Array, far_m: float, opening: float) -> tuple[slice, slice]:
    c, s = math.cos(cone[2]), math.sin(cone[2])
    return covered(cone[1], s * far_m, abs(c) * far_m * opening, CORNER[1]), covered(cone[0], c * far_m, abs(s) * far_m * opening, CORNER[0])


def is_explained(by: Cells, layer: int, cone: Array, opening: float) -> bool:
    c, s, reach_m = math.cos(cone[2]), math.sin(cone[2]), cone[3] + 2.0 * CONE_SLACK_M
    at = square(cone, reach_m, opening)
    spots = by.spots[layer][at][by.stamps[layer][at] > NEVER] - cone[:2]
    ahead, aside = c * spots[:, 0] + s * spots[:, 1], np.abs(c * spots[:, 1] - s * spots[:, 0])
    return bool(((np.hypot(*spots.T) < reach_m) & (aside < ahead * opening + CELL_M)).any())


def plain_clear(to: Cells, cone: Array, opening: float) -> None:
    """What a cone hears through."""
    x, y = middles()
    clear_m = cone[4] - CONE_SLACK_M
    at = square(cone, min(clear_m, MOST_M), opening)
    c, s, dx, dy = math.cos(cone[2]), math.sin(cone[2]), x[at] - cone[0], y[at] - cone[1]
    ahead, aside = c * dx + s * dy, np.abs(c * dy - s * dx)
    is_in = (ahead > 0.0) & (aside <= ahead * opening) & (np.sqrt(dx * dx + dy * dy) < clear_m)
    is_sure = is_in & (to.heard[ANYHOW][at] > NOW_S - TWICE_S) & (aside < ahead * opening - CELL_M)
    to.seen[at][is_in], to.heard[ANYHOW][at][is_in], to.heard[INSIDE][at][is_sure] = NOW_S, NOW_S, NOW_S
    to.stamps[LOW][at][is_in] = NEVER
    to.stamps[LEVEL][at][is_sure & (to.stamps[LEVEL][at] < NOW_S - FRESH_S)] = NEVER


def plain_arc(to: Cells, cone: Array, opening: float) -> int:
    """Where an echo may have arisen; what is new about it."""
    is_near = cone[3] < SUDDEN_M and not is_explained(to, LOW, cone, opening)
    freed = []  # of each cell, whether it was well inside a cone that was free lately, and whether it was ever seen
    x, y = middles()
    arc_m = max(cone[3], cone[5])
    rows, columns = square(cone, arc_m + CELL_M, opening)
    c, s = math.cos(cone[2]), math.sin(cone[2])
    for row in range(rows.start, rows.stop):
        for column in range(columns.start, columns.stop):
            dx, dy = float(x[row, column]) - cone[0], float(y[row, column]) - cone[1]
            ahead, aside, away = c * dx + s * dy, abs(c * dy - s * dx), math.sqrt(dx * dx + dy * dy)
            if ahead > 0.0 and aside <= ahead * opening and abs(away - arc_m) < 0.75 * CELL_M and to.seen[row, column] < NOW_S:
                was_free = to.heard[ANYHOW, row, column] > NOW_S - LATELY_S
                freed.append((to.heard[INSIDE, row, column] > NOW_S - LATELY_S, to.seen[row, column] > NEVER))
                share = arc_m / max(away, 1e-6)
                put(to, LOW, cone[0] + dx * share, cone[1] + dy * share, cone[0], cone[1], NOW_S - FLEETING_S if was_free else NOW_S)
    if freed and all(is_lately for is_lately, _ in freed):
        return CAME
    if not all(ever for _, ever in freed):
        return HIDDEN if is_near else UNSEEN
    return SUDDEN if is_near else UNKNOWN


@given(SEEDS, st.floats(0.08, 0.5))
@settings(max_examples=30, deadline=None)
def test_cones_free_and_fill_the_cells_that_they_do_one_by_one(seed: int, half_cone_rad: float) -> None:
    rng = np.random.default_rng(seed)
    cones = np.zeros((9, 6))
    cones[:, :2], cones[:, 2], cones[:, 3] = rng.uniform(-0.6, 0.6, (9, 2)), rng.uniform(-3.2, 3.2, 9), rng.uniform(0.02, 2.2, 9)
    cones[0, 2] = round(cones[0, 2] / (math.pi / 2.0)) * math.pi / 2.0  # along a row or column
    cones[:, 4], cones[:, 5] = cones[:, 3] * (rng.random(9) < 0.7), 0.05
    kernel_s, news, opening = cells(rng), np.zeros(9, dtype=np.intp), math.tan(half_cone_rad)
    plain, heard = kernel_s.copy(), cones.copy()
    touching = hear_cones(*kernel_s, *CORNER, heard, half_cone_rad, NOW_S, MOST_M, FLEETING_S, news)
    for cone in cones:
        plain_clear(plain, cone, opening)
    touched, expected = [], [0] * 9
    for k, cone in enumerate(cones):
        if cone[3] < MOST_M and not is_explained(plain, LEVEL, cone, opening):
            if cone[3] <= cone[5]:
                touched.append(k)
            else:
                expected[k] = plain_arc(plain, cone, opening)
    assert news.tolist() == expected
    assert touching == len(touched) and np.flatnonzero(heard[:, 3] == TOUCHING_M).tolist() == touched
    assert np.array_equal(kernel_s.stamps > NEVER, plain.stamps > NEVER)
    assert np.array_equal(kernel_s.seen, plain.seen) and np.array_equal(kernel_s.heard, plain.heard)
    assert np.abs(kernel_s.spots - plain.spots).max() < 1e-9 and np.array_equal(kernel_s.stamps, plain.stamps)
