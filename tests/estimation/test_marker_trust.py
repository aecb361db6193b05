"""Who is believed when markers contradict the estimate."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimation.marker_trust import Contradiction, MarkerTrust

ALIKE_RAD = math.radians(8.0)
TURNED = (0.3, -0.2, math.radians(120.0))
ASIDE = (0.9, 0.1, 0.02)


def trust(*agreed: int) -> MarkerTrust:
    found = MarkerTrust(ALIKE_RAD)
    for marker in agreed:
        found.agree(marker)
    return found


def told(found: MarkerTrust, *readings: tuple[int, tuple[float, float, float]]) -> MarkerTrust:
    """Contradicted three times a second."""
    for k, (marker, off) in enumerate(readings):
        found.contradict(Contradiction(k / 3.0, marker, *off))
    return found


@pytest.mark.parametrize("off", [TURNED, ASIDE])
@pytest.mark.parametrize(
    ("agreed", "markers", "alike", "is_confirmed", "is_elsewhere"),
    [
        ((5,), (5,), 1, True, False),  # one reading may be nonsense
        ((5,), (5, 5), 2, True, True),  # it told the truth before
        ((5,), (6, 6, 6, 6), 3, False, False),  # it never agreed, and stands alone: it may hang wrong
        ((5,), (6, 7), 2, True, True),  # two do not lie alike
        ((5,), (6, 6, 6, 7), 3, True, True),
        ((5,), (6, 6, 6, 5), 3, True, True),
        ((), (6, 6, 6), 3, False, False),  # nobody has agreed yet
    ],
)
def test_who_can_be_right(
    off: tuple[float, float, float], agreed: tuple[int, ...], markers: tuple[int, ...], alike: int, is_confirmed: bool, is_elsewhere: bool
) -> None:
    found = told(trust(*agreed), *((marker, off) for marker in markers))
    assert (found.alike, found.is_confirmed, found.is_elsewhere, found.is_fresh) == (alike, is_confirmed, is_elsewhere, not agreed)


def test_who_agrees_in_between_settles_it() -> None:
    found = told(trust(5), (5, TURNED), (5, TURNED))
    found.agree(6)
    assert (found.alike, found.is_confirmed, found.is_elsewhere) == (0, False, False)


def test_a_car_that_keeps_turning_while_its_gyro_says_it_does_not_should_stand() -> None:
    turning = [(5, (0.1 * k, 0.0, math.radians(50.0 + 20.0 * k))) for k in range(3)]
    assert not told(trust(5), *turning[:2]).is_elsewhere
    found = told(trust(5), *turning)
    assert (found.alike, found.is_elsewhere) == (1, True)


def test_a_car_that_points_elsewhere_drives_away_from_the_estimate_and_is_still_the_same_car() -> None:
    """At 0.9 m/s each, in opposite directions."""
    assert told(trust(5), *((5, (0.6 * k, 0.0, math.pi)) for k in range(4))).alike == 3


@given(st.lists(st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6), st.floats(-3.1, 3.1)), min_size=2, max_size=12))
def test_nonsense_is_alike_only_by_chance(offs: list[tuple[float, float, float]]) -> None:
    found = told(trust(5), *((5, off) for off in offs))
    near = any(math.dist(one[:2], offs[-1][:2]) < 2.0 for one in offs[-3:-1])
    assert near or found.alike == 1
