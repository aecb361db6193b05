"""Finding a past stamp among remembered moments."""

from __future__ import annotations

from collections import deque

import pytest

from estimation.history import enclosing
from estimation.reckoning import Sums

MOMENTS = deque([Sums(1.0), Sums(2.0), Sums(4.0)])


@pytest.mark.parametrize(
    ("stamp_s", "expected"),
    [(1.0, (1.0, 1.0, 0.0)), (1.5, (1.0, 2.0, 0.5)), (2.0, (2.0, 2.0, 0.0)), (3.5, (2.0, 4.0, 0.75)), (4.0, (4.0, 4.0, 0.0))],
)
def test_a_stamp_inside_the_memory(stamp_s: float, expected: tuple[float, float, float]) -> None:
    found = enclosing(MOMENTS, stamp_s)
    assert found is not None and (found[0].stamp_s, found[1].stamp_s, found[2]) == expected


@pytest.mark.parametrize("stamp_s", [0.9, 4.1])
def test_a_stamp_outside_the_memory(stamp_s: float) -> None:
    assert enclosing(MOMENTS, stamp_s) is None
