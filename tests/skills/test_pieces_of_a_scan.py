"""The pieces of a scan against a slow twin in plain numpy, and who is known from one scan to the next."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.skills.movers import APART_M, PERSON_M, RUN_BEAMS, WIDEST_M, Beams, Mask, Movers, apart
from pluto_bt.skills.outline import Array

SEEDS = st.integers(0, 2**32 - 1)


def plain_spans(points: Array, begins: Mask) -> tuple[Beams, Beams, Array]:
    """First point, the one behind the last, and width of each piece, given where they begin."""
    starts = np.flatnonzero(begins)
    ends = np.append(starts[1:], len(points))
    return starts, ends, np.hypot(*(points[ends - 1] - points[starts]).T)


def plain_apart(points: Array, beams: Beams, moved: Mask) -> tuple[Beams, Mask]:
    """Runs of moved beams are found in the whole scan, and looked up in the pieces."""
    begins = np.concatenate(([True], (np.hypot(*np.diff(points, axis=0).T) > APART_M) | (np.diff(beams) > 3)))
    starts, ends, widths = plain_spans(points, begins)
    is_rest = np.zeros(len(points), dtype=np.bool_)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], moved.astype(np.int8), [0]))))
    for first, end in edges.reshape(-1, 2).tolist():
        i = int(np.searchsorted(starts, first, side="right")) - 1
        if end - first >= RUN_BEAMS and end <= ends[i] and widths[i] > PERSON_M:
            is_rest[starts[i] : ends[i]] |= ~moved[starts[i] : ends[i]]
            begins[first], begins[end : end + 1] = True, True
    starts, _, widths = plain_spans(points, begins)
    return starts, (widths < WIDEST_M) & ~is_rest[starts]


def scan(rng: np.random.Generator, count: int) -> tuple[Array, Beams, Mask]:
    """Walls with gaps, things before them, and runs of beams that ended in former free space."""
    along = np.cumsum(rng.choice([0.02, 0.03, 0.1, 0.5], count, p=[0.5, 0.3, 0.15, 0.05]))
    points = np.column_stack((along, rng.normal(0.0, 0.02, count) + (rng.random(count) < 0.05)))
    beams = np.cumsum(rng.choice([1, 2, 5], count, p=[0.9, 0.07, 0.03])).astype(np.intp)
    moved = np.repeat(rng.random(count) < 0.4, rng.integers(1, 9, count))[:count]
    return points, beams, moved


@given(SEEDS, st.integers(1, 150))
@settings(max_examples=150, deadline=None)
def test_a_scan_falls_into_the_same_pieces_beam_by_beam_as_all_at_once(seed: int, count: int) -> None:
    points, beams, moved = scan(np.random.default_rng(seed), count)
    starts, is_narrow = apart(points[:, 0].copy(), points[:, 1].copy(), beams, moved)
    plain_starts, plain_is_narrow = plain_apart(points, beams, moved)
    assert starts.tolist() == plain_starts.tolist() and is_narrow.tolist() == plain_is_narrow.tolist()


@given(SEEDS)
@settings(max_examples=30, deadline=None)
def test_pieces_that_were_kept_lead_to_the_same_velocities_as_pieces_found_anew(seed: int) -> None:
    rng = np.random.default_rng(seed)
    keeps, anew = Movers(), Movers()
    for k in range(6):
        points, beams, moved = scan(rng, 90)
        anew._last_pieces = None
        walks, velocities = keeps.velocities(points, beams, moved, 0.2 * k)
        walks_anew, velocities_anew = anew.velocities(points, beams, moved, 0.2 * k)
        assert np.array_equal(walks, walks_anew) and np.array_equal(velocities, velocities_anew)
        assert np.array_equal(keeps.walkers, anew.walkers)
