"""What a round of the sonar tells of people, and who has walked into the robot, against slow twins in plain numpy."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.skills.approach import HEAR_M, MOST_LOST, NEARER_M, heard_anew
from pluto_bt.skills.outline import outline_of
from pluto_bt.skills.protection import who_is_inside
from pluto_bt.skills.seen_kernels import CAME
from tests.chain.robots import ATRV2

SEEDS = st.integers(0, 2**32 - 1)
MOST_M, LEAST_M, RING = 8.0, 0.3, 16
PLANES = outline_of(ATRV2.body.outline_m).planes


@given(SEEDS, st.booleans())
@settings(max_examples=60, deadline=None)
def test_a_round_tells_transducer_by_transducer_what_it_tells_all_at_once(seed: int, is_alone: bool) -> None:
    rng = np.random.default_rng(seed)
    ranges, before, first = (np.where(rng.random(RING) < 0.3, MOST_M, rng.uniform(0.2, 4.0, RING)) for _ in range(3))
    lost = rng.integers(0, MOST_LOST + 3, RING).astype(np.intp)
    news = np.where(rng.random(RING) < 0.03, rng.integers(1, 4, RING), 0).astype(np.intp)

    is_silent = ranges >= MOST_M
    lost_now = np.where(is_silent, lost + 1, 0)
    filled = np.where(is_silent & (lost_now <= MOST_LOST), before, ranges)
    nearer = np.abs(first - filled) if is_alone else first - filled
    near = (filled < HEAR_M) & (nearer > NEARER_M) & (filled > LEAST_M)

    heard_m, found, is_anything = heard_anew(ranges, before, first, lost, news, MOST_M, LEAST_M, is_alone)
    assert heard_m.tolist() == filled.tolist() and found.tolist() == near.tolist()
    assert is_anything == (near | (news >= CAME)).any() and lost.tolist() == lost_now.tolist()


@given(SEEDS, st.integers(0, 40))
@settings(max_examples=60, deadline=None)
def test_who_has_walked_into_the_robot_is_the_first_point_inside_that_moves(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    points = np.column_stack((rng.uniform(-1.5, 1.5, (count, 2)), np.full(count, 0.1), rng.normal(0.0, 1.0, (count, 2))))
    points[rng.random(count) < 0.7, 3:] = 0.0
    walks = points[:, 3:].any(axis=1)
    inside = np.flatnonzero(walks & (points[:, :2] @ PLANES[:, :2].T < PLANES[:, 2]).all(axis=1))
    assert who_is_inside(points, PLANES) == (walks.any(), inside[0] if len(inside) else -1)
