"""The rectangle in its frame, on paper and by properties."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.skills.rectangle import Rectangle

EAST = Rectangle(3.0, 10.0, (1.0, 2.0, 0.0))
NORTH = Rectangle(3.0, 10.0, (1.0, 2.0, math.pi / 2.0))
NUMBERS = st.floats(-50.0, 50.0)


@pytest.mark.parametrize(
    ("rectangle", "point", "depth_m"),
    [
        (EAST, (1.0, 2.0), 0.0),  # home lies on the base
        (EAST, (6.0, 2.0), 3.0),
        (EAST, (10.5, 2.0), 0.5),
        (EAST, (6.0, 4.5), 0.5),
        (EAST, (6.0, 6.0), -1.0),
        (EAST, (0.0, 2.0), -1.0),
        (NORTH, (1.0, 7.0), 3.0),
        (NORTH, (1.0, 13.0), -1.0),
        (NORTH, (-1.5, 7.0), 0.5),
    ],
)
def test_how_deep_inside_a_point_lies(rectangle: Rectangle, point: tuple[float, float], depth_m: float) -> None:
    assert rectangle.depth_m(*point) == pytest.approx(depth_m)


def test_who_stands_on_the_base_as_well_as_a_pose_can_tell_is_inside() -> None:
    assert EAST.holds(0.8, 2.0) and not EAST.holds(0.6, 2.0)


@given(x=NUMBERS, y=NUMBERS, depth_m=st.floats(0.0, 20.0))
def test_the_nearest_point_inside_is_as_deep_as_asked_or_as_the_rectangle_is_wide(x: float, y: float, depth_m: float) -> None:
    point = NORTH.inside(x, y, depth_m)
    deepest_m = min(NORTH.base_m, 0.5 * NORTH.height_m)
    assert NORTH.depth_m(*point) >= min(depth_m, deepest_m) - 1e-9
    if NORTH.depth_m(x, y) >= depth_m:
        assert point == pytest.approx((x, y)), "who is deep enough stays"


def test_who_comes_home_stops_in_front_of_the_base() -> None:
    assert EAST.inside(1.0, 2.0, 0.2) == pytest.approx((1.2, 2.0))
    assert NORTH.inside(1.0, 2.0, 0.2) == pytest.approx((1.0, 2.2))
