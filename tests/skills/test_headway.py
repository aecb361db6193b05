"""Ray after ray that leads nowhere; and the ground that is given up for it."""

from __future__ import annotations

from pluto_bt.skills.headway import MOST_DECISIONS, PLACE_M, Headway
from pluto_bt.skills.local_map import LocalMap
from pluto_bt.skills.motion_parameters import MotionParameters


def test_so_many_decisions_in_one_place_are_enough() -> None:
    headway = Headway()
    told = [headway.decide((1.0 + 0.1 * PLACE_M * (k % 2), 2.0)) for k in range(MOST_DECISIONS + 1)]
    assert told == [True] * MOST_DECISIONS + [False]


def test_a_decision_elsewhere_begins_anew() -> None:
    headway = Headway()
    for _ in range(MOST_DECISIONS + 1):
        headway.decide((0.0, 0.0))
    assert headway.decide((2.0 * PLACE_M, 0.0))
    assert not all(headway.decide((2.0 * PLACE_M, 0.0)) for _ in range(MOST_DECISIONS))


def test_ground_that_is_given_up_counts_as_covered_there_and_nowhere_else() -> None:
    map = LocalMap(MotionParameters())
    map.give_up(3.0, -2.0, 0.6)
    assert map.covered[map.cell(3.0, -2.0)] and map.covered[map.cell(3.4, -2.0)]
    assert not map.covered[map.cell(4.5, -2.0)] and not map.covered[map.cell(3.0, 0.0)]
