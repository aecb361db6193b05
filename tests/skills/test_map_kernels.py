"""The hot loops of local map, path smoothing and path following against slow twins."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.skills.grid_kernels import draw_tight, under_places
from pluto_bt.skills.map_kernels import HIT, LEAST, MISS, MOST, SAMPLE, Bytes, Counts, changes, mark_level
from pluto_bt.skills.outline import Array
from pluto_bt.skills.path_following import BACK_M, can_cut, nearest_ahead

N = 60
LOOK, COVER, JOIN = 25.0, 12.0, 3.0
SEEDS = st.integers(0, 2**32 - 1)


def plain_level(evidence: Bytes, covered: Bytes, x: float, y: float, bearings: Array, ranges: Array) -> None:
    """A level scan, sample by sample; each cell is changed by the first that touches it."""
    touched: Counts = np.zeros((N, N), dtype=np.int32)

    def touch(i: int, j: int, change: int) -> bool:
        is_inside = 0 <= i < N and 0 <= j < N
        if is_inside and not touched[i, j]:
            touched[i, j] = 1
            evidence[i, j] = min(MOST, max(LEAST, evidence[i, j] + change))
        return is_inside

    last: tuple[float, float] | None = None
    for bearing, r in zip(bearings.tolist(), ranges.tolist(), strict=True):
        if not 0.0 < r < LOOK:
            last = None
            continue
        hit = x + r * math.cos(bearing), y + r * math.sin(bearing)
        gap = math.inf if last is None else math.dist(hit, last)
        steps = int(gap / SAMPLE) + 1 if gap < JOIN else 1
        for s in range(1, steps + 1):
            share = 0.0 if steps == 1 or last is None else 1.0 - s / steps
            to = hit if last is None else last
            touch(math.floor(hit[0] + share * (to[0] - hit[0])), math.floor(hit[1] + share * (to[1] - hit[1])), HIT)
        last = hit
    for k, bearing in enumerate(bearings.tolist()):
        r = ranges[k]
        if not r > 0.0:
            continue
        if 0 < k < len(ranges) - 1:
            r = min(r, max(ranges[k - 1], ranges[k + 1]) + JOIN)
        for m in range(int((min(r, LOOK) - 1.0) / SAMPLE)):
            i, j = math.floor(x + m * SAMPLE * math.cos(bearing)), math.floor(y + m * SAMPLE * math.sin(bearing))
            if not touch(i, j, -MISS):
                break
            if m * SAMPLE < COVER:
                covered[i, j] = 1


@given(SEEDS)
@settings(max_examples=40, deadline=None)
def test_a_level_scan_marks_the_cells_that_its_samples_lie_in(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(1.0, N - 1.0, 2).tolist()
    bearings = rng.uniform(-3.0, 3.0) + np.radians(np.arange(61) * 3.0)
    ranges = rng.uniform(3.0, 30.0) + rng.uniform(0.0, 6.0) * np.sin(np.arange(61) / rng.uniform(1.0, 9.0)) + rng.normal(0.0, 0.3, 61)
    ranges[rng.random(61) < 0.04] = -1.0
    evidence: Bytes = rng.integers(LEAST, MOST + 1, (N, N)).astype(np.int8)
    covered: Bytes = np.zeros((N, N), dtype=np.int8)
    plain_evidence, plain_covered = evidence.copy(), covered.copy()
    before, touched = evidence.copy(), np.zeros((N, N), dtype=np.int8)
    i0, i1, j0, j1 = mark_level(evidence, covered, touched, 1, x, y, bearings, ranges, LOOK, COVER, JOIN)
    plain_level(plain_evidence, plain_covered, x, y, bearings, ranges)
    before[i0:i1, j0:j1] = evidence[i0:i1, j0:j1]
    assert np.array_equal(before, evidence), "the window holds all that changed"
    assert np.array_equal(evidence, plain_evidence) and np.array_equal(covered, plain_covered)


@given(SEEDS, st.integers(0, 5))
@settings(max_examples=60, deadline=None)
def test_the_window_of_changes_holds_all_that_is_not_as_it_was(seed: int, changed: int) -> None:
    rng = np.random.default_rng(seed)
    evidence: Bytes = rng.integers(LEAST, MOST + 1, (N, N)).astype(np.int8)
    low_s = np.where(rng.random((N, N)) < 0.9, -1.0, rng.uniform(0.0, 9.0, (N, N))).astype(np.float32)
    now: Bytes = ((evidence > 0) | (low_s > np.float32(4.3))).astype(np.int8)
    stands = now.copy()
    for i, j in rng.integers(0, N, (changed, 2)).tolist():
        stands[i, j] ^= 1
    (i0, i1), (j0, j1) = (sorted(rng.integers(0, N + 1, 2).tolist()) for _ in range(2))
    at = np.argwhere(stands[i0:i1, j0:j1] != now[i0:i1, j0:j1]) + np.array([i0, j0])
    wanted = (at[:, 0].min(), at[:, 0].max() + 1, at[:, 1].min(), at[:, 1].max() + 1) if len(at) else (N, 0, N, 0)
    expected = stands.copy()
    expected[i0:i1, j0:j1] = now[i0:i1, j0:j1]
    assert changes(evidence, low_s, 4.3, stands, i0, i1, j0, j1) == wanted
    assert np.array_equal(stands, expected)


def winding(rng: np.random.Generator, count: int) -> Array:
    headings = np.cumsum(rng.normal(0.0, 0.5, count))
    return np.cumsum(0.1 * np.column_stack((np.cos(headings), np.sin(headings))), axis=0)


@given(SEEDS)
@settings(max_examples=30, deadline=None)
def test_a_way_is_drawn_tight_as_all_its_points_at_once_are(seed: int) -> None:
    rng = np.random.default_rng(seed)
    grid = rng.uniform(0.0, 12.0, (50, 50)).astype(np.float32)
    origin = (-2.0, -2.0, float(rng.uniform(-0.3, 0.3)))
    way = winding(rng, 30)
    room = np.minimum(under_places(grid, way, origin, 0.1), 0.6)
    plain = way.copy()
    for _ in range(20):
        new = plain[1:-1] + 0.5 * (0.5 * (plain[:-2] + plain[2:]) - plain[1:-1])
        may = under_places(grid, new, origin, 0.1) >= room[1:-1]
        plain[1:-1][may] = new[may]
    draw_tight(way, room, 20, 0.5, grid, origin, 0.1)
    assert np.array_equal(way, plain)


@given(SEEDS)
@settings(max_examples=60, deadline=None)
def test_the_nearest_point_is_the_least_before_the_way_leads_away_again(seed: int) -> None:
    rng = np.random.default_rng(seed)
    way, (x, y) = winding(rng, int(rng.integers(1, 40))), rng.uniform(-1.0, 1.0, 2).tolist()
    away_m = np.hypot(way[:, 0] - x, way[:, 1] - y)
    leads_away = np.flatnonzero(away_m > np.minimum.accumulate(away_m) + BACK_M)
    assert nearest_ahead(way, x, y) == np.argmin(away_m[: leads_away[0]] if len(leads_away) else away_m)


@given(SEEDS, st.floats(0.01, 0.6))
@settings(max_examples=60, deadline=None)
def test_a_short_cut_leaves_no_point_farther_aside_than_it_may(seed: int, most_m: float) -> None:
    rng = np.random.default_rng(seed)
    way, robot = winding(rng, int(rng.integers(1, 25))), rng.uniform(-0.3, 0.3, 2)
    cut_m, ahead = most_m * rng.uniform(0.5, 1.0, len(way)), way[-1] - robot
    share = np.clip((way - robot) @ ahead / max(float(ahead @ ahead), 1e-12), 0.0, 1.0)
    aside_m = np.hypot(*(way - robot - share[:, None] * ahead).T)
    off_m = math.dist(way[0], robot)
    if np.abs(aside_m - np.maximum(cut_m, off_m)).min() > 1e-9:  # else rounding decides
        assert can_cut(way, cut_m, *robot.tolist()) == bool((aside_m <= np.maximum(cut_m, off_m)).all())
