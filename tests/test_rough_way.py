"""Rough lengths of ways: against lengths known on paper."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.maps.rough_way import RoughWays
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import Shape, World


def ways(radius_m: float, *shapes: Shape) -> RoughWays:
    world = World("w", shapes=shapes)
    return RoughWays(world, Scene(world), radius_m)


def wall(*points: tuple[float, float]) -> Shape:
    return Shape(str(points), "wall", np.array(points, dtype=float))


FRAME = wall((0, 0), (20, 0), (20, 10), (0, 10), (0, 0))


def test_in_the_open_it_is_the_straight_line_as_far_as_cells_allow() -> None:
    open_ways = ways(0.3, FRAME)
    assert open_ways.length_m((2, 5), (18, 5)) == pytest.approx(16.0, abs=0.2)
    straight_m = math.dist((2, 2), (17, 8))
    assert straight_m - 0.2 < open_ways.length_m((2, 2), (17, 8)) < 1.09 * straight_m  # the octagon of straight and diagonal steps


def test_round_a_wall_it_leads_past_its_end() -> None:
    around = ways(0.3, FRAME, wall((10, 0), (10, 8)))
    assert 2 * math.dist((5, 2), (10, 8.3)) - 0.3 < around.length_m((5, 2), (15, 2)) < 2.2 * math.dist((5, 2), (10, 8.3))


@pytest.mark.parametrize(("gap_m", "is_open"), [(0.3, False), (0.62, True), (1.0, True)])
def test_a_gap_lets_a_disc_through_that_fits(gap_m: float, is_open: bool) -> None:
    passage = ways(0.3, FRAME, wall((10, 0), (10, 5)), wall((10, 5 + gap_m), (10, 10)))
    assert passage.is_sure
    assert math.isfinite(passage.length_m((5, 5), (15, 5))) is is_open


@given(st.floats(0.0, 3.0), st.floats(0.0, math.pi), st.floats(0.61, 1.0))
@settings(max_examples=12, deadline=None)
def test_a_way_that_is_there_is_found_wherever_the_walls_stand(shift_m: float, angle_rad: float, gap_m: float) -> None:
    """Two half-planes with a gap, turned and shifted against the cells: the disc of 0.3 m fits, a wall without gap holds it."""
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)

    def at(along_m: float, across_m: float) -> tuple[float, float]:
        return shift_m + along_m * cos - across_m * sin, along_m * sin + across_m * cos

    box = [at(-8, -8), at(8, -8), at(8, 8), at(-8, 8), at(-8, -8)]
    for gap, is_open in ((gap_m, True), (0.0, False)):
        passage = ways(0.3, wall(*box), wall(at(-8, 0), at(-gap / 2, 0)), wall(at(gap / 2, 0), at(8, 0)))
        assert math.isfinite(passage.length_m(at(3, -4), at(-3, 4))) is is_open


def test_outside_of_everything_drawn_the_ground_is_free_and_a_closed_frame_stays_closed() -> None:
    around = ways(0.3, FRAME)
    assert around.length_m((-40, 5), (-2, 5)) == pytest.approx(38.0, abs=1.0)
    assert math.isinf(around.length_m((5, 5), (40, 5)))
    post = ways(0.3, wall((0, 0), (0.1, 0)))
    assert post.length_m((0, 1), (50, 1)) == pytest.approx(50.0, rel=0.1)
