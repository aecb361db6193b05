"""Objects and circling: the smallest circle, what stands alone, and an exact robot on its round."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.skills.circling import Round, circle
from pluto_bt.skills.local_map import LocalMap
from pluto_bt.skills.motion_parameters import MotionParameters
from pluto_bt.skills.objects import Thing, smallest_circle, things_around


@given(seed=st.integers(0, 1000), radius_m=st.floats(0.1, 2.0))
@settings(max_examples=30, deadline=None)
def test_the_smallest_circle_around_points_on_a_circle_is_that_circle(seed: int, radius_m: float) -> None:
    angles = np.random.default_rng(seed).uniform(0.0, math.tau, 80)
    thing = smallest_circle(np.column_stack((3.0 + radius_m * np.cos(angles), -1.0 + radius_m * np.sin(angles))))
    assert math.dist(thing[:2], (3.0, -1.0)) < 0.05 * radius_m
    assert thing.radius_m == pytest.approx(radius_m, rel=0.05)


def test_two_sides_of_a_box_already_give_its_middle() -> None:
    sides = [(x, 0.0) for x in np.linspace(0.0, 3.0, 40)] + [(3.0, y) for y in np.linspace(0.0, 1.0, 14)]
    thing = smallest_circle(np.array(sides))
    assert math.dist(thing[:2], (1.5, 0.5)) < 0.05


def test_walls_are_no_objects_and_the_nearest_of_the_others_comes_first() -> None:
    map = LocalMap(MotionParameters())
    map.evidence[:] = -1  # seen to be free
    for x0, y0, x1, y1 in ((5.0, 5.0, 5.5, 5.5), (-4.0, 1.0, -3.0, 2.0), (-8.0, -6.0, 9.0, -5.75)):
        a, b = map.cell(x0, y0), map.cell(x1, y1)
        map.evidence[a.i : b.i + 1, a.j : b.j + 1] = 6
    things = things_around(map, (0.0, 0.0, 0.0))
    assert [round(thing.x_m) for thing in things] == [-3, 5] or [round(thing.x_m) for thing in things] == [-4, 5]


def test_a_strip_of_wall_that_goes_on_out_of_sight_is_no_object() -> None:
    map = LocalMap(MotionParameters())
    map.evidence[map.cell(0.0, -6.0).i : map.cell(5.0, 0.0).i, :] = -1
    for y0, y1 in ((-0.6, 0.6), (2.0, 3.0)):
        a, b = map.cell(5.0, y0), map.cell(5.3, y1)
        map.evidence[a.i : b.i + 1, a.j : b.j + 1] = 6
    assert things_around(map, (0.0, 0.0, 0.0)) == []
    map.evidence[map.cell(5.0, 0.0).i :, :][map.evidence[map.cell(5.0, 0.0).i :, :] == 0] = -1
    assert len(things_around(map, (0.0, 0.0, 0.0))) == 2


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("start", [(0.0, 0.0, 0.0), (4.0, 1.0, 2.0), (2.2, 0.1, -1.0)])
def test_an_exact_robot_comes_onto_the_circle_and_stays_on_it(side: float, start: tuple[float, float, float]) -> None:
    thing, x, y, theta, around = Thing(2.0, 0.0, 0.3), *start, Round()
    turns, off = 0.0, []
    for k in range(3000):
        v, w = circle((x, y, theta), thing, 1.5, 0.3, side)
        x, y, theta = x + 0.1 * v * math.cos(theta), y + 0.1 * v * math.sin(theta), theta + 0.1 * w
        turns = around.go((x, y, theta), thing)
        if k > 300:
            off.append(abs(math.hypot(x - 2.0, y) - 1.5))
        if turns >= 1.5:
            break
    assert turns >= 1.5
    assert max(off) < 0.05


def test_going_to_and_fro_is_no_round() -> None:
    around, thing = Round(), Thing(0.0, 0.0, 0.3)
    for _ in range(10):
        for angle in (0.0, 0.5, 1.0, 0.5):
            turns = around.go((math.cos(angle), math.sin(angle), 0.0), thing)
    assert turns == pytest.approx(1.0 / math.tau)
