"""The heading regulator."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.skills.drive import DriveParameters, drive_limits
from pluto_bt.skills.heading import Line, regulate
from pluto_bt.skills.limits import within
from tests.chain.robots import ATRV2, CAR

LIMITS = drive_limits(ATRV2, DriveParameters())


@given(st.floats(-math.pi, math.pi), st.floats(0.0, 1.0))
def test_it_turns_towards_the_target_and_never_faster_than_it_may(error: float, speed: float) -> None:
    v, w = regulate(error, speed, LIMITS)
    assert w * error >= 0.0
    assert abs(w) <= LIMITS.turn_rate_radps
    assert 0.0 <= v <= speed


def test_it_drives_full_speed_on_course_and_turns_on_the_spot_when_far_off() -> None:
    assert regulate(0.0, 0.5, LIMITS) == (0.5, 0.0)
    assert regulate(math.radians(60.0), 0.5, LIMITS)[0] == 0.0


def test_a_given_turn_rate_lowers_the_limit() -> None:
    assert regulate(2.0, 0.5, LIMITS, 0.1)[1] == pytest.approx(0.1)


@pytest.mark.parametrize("target", [0.3, -1.0, 3.0])
def test_it_settles_without_overshoot(target: float) -> None:
    heading, w = 0.0, 0.0
    for _ in range(400):
        wanted = regulate(wrap_angle(target - heading), 0.0, LIMITS)[1]
        w += max(-1.0, min(1.0, (wanted - w) / (LIMITS.turn_acceleration_radps2 * 0.02))) * LIMITS.turn_acceleration_radps2 * 0.02
        heading += w * 0.02
        assert (target - heading) * math.copysign(1.0, target) > -0.03
    assert heading == pytest.approx(target, abs=0.002)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_it_comes_back_to_the_line_it_was_pushed_off(direction: float) -> None:
    line = Line()
    y, heading, x = 0.0, 0.0, 0.0
    line.error_rad(0.0, 0.0, 0.0)
    for step in range(400):
        if step == 20:
            heading += 0.3  # a stone turns the robot
        v, w = regulate(line.error_rad(0.0, heading, x), 0.5 * direction, LIMITS)
        heading += w * 0.05
        x += v * 0.05
        y += v * 0.05 * math.sin(heading)
    assert y == pytest.approx(0.0, abs=0.03)
    assert heading == pytest.approx(0.0, abs=0.03)


def test_a_new_target_begins_a_new_line() -> None:
    line = Line()
    line.error_rad(0.0, 0.0, 0.0)
    for k in range(10):
        line.error_rad(0.0, 0.1, 0.05 * k)
    assert line.offset_m > 0.02
    line.error_rad(0.2, 0.1, 0.5)
    assert line.offset_m == 0.0


def test_a_car_keeps_rolling_while_it_turns() -> None:
    car = drive_limits(CAR, DriveParameters())
    v, w = within(regulate(2.0, 0.5, car), car)
    assert v > 0.1
    assert abs(w) * car.min_turn_radius_m <= v + 1e-12
