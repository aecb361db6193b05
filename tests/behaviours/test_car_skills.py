"""The car's skills, clause by clause (seed 002; DESIGN.md, section 9)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.maps.platform import Body
from pluto_bt.maps.world import Area, World
from pluto_bt.skills.car_goto import CarGoto, CarState
from pluto_bt.skills.car_steering import bearing_deg, heading_deg, turn_rate, wrap180
from pluto_bt.skills.make_turn import MakeTurn
from pluto_bt.skills.map_area import MapArea

FREE = MapArea(()).has_line
BODY = Body(kinematics="ackermann", outline_m=((1, 0), (0, 1), (-1, 0)), track_m=0.2, min_turn_radius_m=0.83)


def goto(x: float = 0.0, y: float = 100.0) -> CarGoto:
    return CarGoto(x, y, 1.0, FREE)


def at(heading: float, speed: float = 0.5, x: float = 0.0, y: float = 0.0) -> CarState:
    return CarState(x, y, heading, speed)


@pytest.mark.parametrize(
    ("heading", "percent"), [(-5.0, 20.0), (5.0, -20.0), (-22.0, 88.0), (-23.0, 90.0), (170.0, -90.0), (-170.0, 90.0), (0.0, 0.0)]
)
def test_first_round_steers_four_percent_a_degree_up_to_90(heading: float, percent: float) -> None:
    assert goto().step(at(heading)).steering_percent == pytest.approx(percent)


def test_later_rounds_steer_up_to_50_and_end_at_10_degrees() -> None:
    skill = goto()
    skill.step(at(-19.0))  # below 20: the first round is over
    assert skill.step(at(-60.0)).steering_percent == 50.0
    assert skill.rounds == 2
    skill.step(at(-15.0))  # above 10: still turning in round 2
    assert skill.step(at(-9.0)).steering_percent == pytest.approx(36.0)
    assert skill.rounds == 2
    skill.step(at(-9.0))
    assert skill.rounds == 3


def test_the_first_turn_goes_on_until_the_error_is_below_20() -> None:
    skill = goto()
    for heading in (-90.0, -60.0, -20.5):
        skill.step(at(heading))
        assert skill.rounds == 1
    skill.step(at(-19.0))
    skill.step(at(-19.0))
    assert skill.rounds == 2


def test_more_than_a_hundred_steps_end_the_turn_and_not_the_goto() -> None:
    skill = goto()
    orders = [skill.step(at(-90.0)) for _ in range(101)]
    assert skill.rounds == 1 and not any(order.ended for order in orders)
    assert skill.step(at(-90.0)).steering_percent == 50.0
    assert skill.rounds == 2


@pytest.mark.parametrize(("distance", "ended"), [(0.99, "reached"), (1.0, ""), (1.01, "")])
def test_nearer_than_a_metre_is_reached_also_while_turning(distance: float, ended: str) -> None:
    skill = goto(0.0, 10.0)
    skill.step(at(-90.0))
    assert skill.step(at(-90.0, y=10.0 - distance)).ended == ended


def test_after_ten_rounds_speed_0_is_hindered_and_not_before() -> None:
    skill = goto()
    ended = [skill.step(at(0.0, speed=0.0)).ended for _ in range(11)]
    assert ended == [""] * 10 + ["hindered"]


def test_after_ten_rounds_a_moving_car_is_not_hindered_until_it_stands() -> None:
    skill = goto()
    assert not any(skill.step(at(0.0)).ended for _ in range(50))
    assert skill.step(at(0.0, speed=0.0)).ended == "hindered"


def test_three_seconds_at_speed_0_are_hindered_also_in_a_turn() -> None:
    skill = goto()
    ended = [skill.step(at(-90.0, speed=0.0)).ended for _ in range(31)]
    assert ended == [""] * 30 + ["hindered"]


def test_speed_between_starts_the_three_seconds_again() -> None:
    skill = goto()
    speeds = [0.0] * 29 + [0.1] + [0.0] * 29
    assert not any(skill.step(at(-90.0, speed=speed)).ended for speed in speeds)


L_SHAPE = MapArea([((0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 2.0), (2.0, 6.0), (0.0, 6.0))])


def test_a_goal_outside_the_map_is_refused_at_once() -> None:
    assert CarGoto(3.0, 5.0, 1.0, L_SHAPE.has_line).step(at(0.0, x=1.0, y=1.0)).ended == "outside-map"


def test_a_straight_line_that_leaves_the_map_is_looked_at_each_round() -> None:
    skill = CarGoto(3.5, 1.0, 0.5, L_SHAPE.has_line)
    assert skill.step(at(110.0, x=1.0, y=1.5)).ended == ""
    assert skill.step(at(90.0, x=1.0, y=5.0)).ended == "outside-map"


@pytest.mark.parametrize(
    ("line", "is_in"),
    [
        ((1, 1, 3.5, 1), True),
        ((1, 5, 3.5, 1.5), False),
        ((1, 5, 1, 5), True),
        ((3, 3, 3, 3), False),
        ((0, 0, 0, 6), True),  # along the edge
        ((2, 2, 2, 6), True),
        ((0, 6, 4, 2), False),
        ((1, 5, 2, 2), True),  # touches the inner corner
        ((0, 6, 3, 0), True),
        ((-1, 1, 5, 1), False),
    ],
)
def test_lines_in_an_l(line: tuple[float, float, float, float], is_in: bool) -> None:
    assert L_SHAPE.has_line(*line) is is_in


def test_two_areas_that_touch_are_one_map() -> None:
    area = MapArea([((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)), ((2.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 2.0))])
    assert area.has_line(1.0, 1.0, 3.0, 1.0)
    assert not area.has_line(1.0, 1.0, 5.0, 1.0)


@given(*[st.floats(0.01, 3.99)] * 4)
def test_a_convex_area_holds_every_line_between_its_points(x0: float, y0: float, x1: float, y1: float) -> None:
    square = MapArea([((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0))])
    assert square.has_line(x0, y0, x1, y1)
    assert not square.has_line(x0, y0, x1 + 8.0, y1)


def test_only_areas_of_kind_map_count() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert MapArea.of(World("w", areas=(Area("a", "named", square),))).has_point(50.0, 50.0)
    assert not MapArea.of(World("w", areas=(Area("a", "map", square),))).has_point(50.0, 50.0)
    assert MapArea.of(None).has_point(50.0, 50.0)


@pytest.mark.parametrize(
    ("angle", "start", "heading", "is_done"),
    [
        (250.0, 0.0, -119.0, True),  # 241 is within 10 of 250
        (250.0, 0.0, -121.0, False),
        (250.0, 0.0, 0.0, False),
        (-180.0, 170.0, -1.0, True),
        (90.0, 0.0, 100.0, False),  # 10 is not within 10
        (90.0, 0.0, 99.9, True),
        (0.0, 33.0, 33.0, True),
        (360.0, 0.0, 0.0, True),  # the same heading
    ],
)
def test_a_turn_is_relative_and_done_within_10_degrees(angle: float, start: float, heading: float, is_done: bool) -> None:
    assert MakeTurn.begin(start, angle).is_done(heading) is is_done


def test_positive_is_clockwise_to_the_right() -> None:
    assert MakeTurn.begin(0.0, 90.0).steering_percent == 90.0
    assert MakeTurn.begin(0.0, -90.0).steering_percent == -90.0
    assert turn_rate(0.5, 90.0, BODY) == pytest.approx(-0.5 / 0.83)  # the world's theta falls in a right turn
    assert turn_rate(0.5, -45.0, BODY) == pytest.approx(0.5 / 0.83 / 2)


@pytest.mark.parametrize(("theta_deg", "heading"), [(90, 0), (0, 90), (180, -90), (-90, 180), (45, 45)])
def test_heading_of_the_car_frame(theta_deg: float, heading: float) -> None:
    assert wrap180(heading_deg(math.radians(theta_deg)) - heading) == pytest.approx(0.0, abs=1e-9)


@given(st.floats(0.1, 10), st.floats(-3.1, 3.1))
def test_bearing_and_heading_speak_of_one_frame(distance_m: float, theta_rad: float) -> None:
    bearing = bearing_deg(0.0, 0.0, distance_m * math.cos(theta_rad), distance_m * math.sin(theta_rad))
    assert abs(wrap180(bearing - heading_deg(theta_rad))) < 1e-9
