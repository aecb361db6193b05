"""The dynamic constraints of the drive."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.skills.drive import DriveParameters, drive_limits
from pluto_bt.skills.limits import STILL, Limits, ramp, within
from tests.chain.robots import ATRV2, CAR

SKID = drive_limits(ATRV2, DriveParameters())
ACKERMANN = drive_limits(CAR, DriveParameters())
speeds = st.floats(-3.0, 3.0)
rates = st.floats(-4.0, 4.0)


def test_limits_of_zero_are_the_platforms_own() -> None:
    assert SKID.speed_mps == 0.9
    assert SKID.turn_rate_radps == pytest.approx(0.8, abs=0.001)
    assert drive_limits(ATRV2, DriveParameters(max_speed_mps=0.4)).speed_mps == 0.4
    assert drive_limits(ATRV2, DriveParameters(max_speed_mps=4.0)).speed_mps == 0.9


def test_the_cars_tightest_curve_is_that_of_full_lock() -> None:
    assert ACKERMANN.min_turn_radius_m == pytest.approx(0.83 * 0.9)


@given(speeds, rates)
def test_within_keeps_the_limits(v: float, w: float) -> None:
    for limits in (SKID, ACKERMANN):
        slow, turn = within((v, w), limits)
        assert abs(slow) <= limits.speed_mps
        assert limits.min_turn_radius_m == 0.0 or abs(turn) * limits.min_turn_radius_m <= abs(slow) + 1e-12


def test_a_car_keeps_its_curvature_when_its_speed_is_cut() -> None:
    v, w = within((1.8, 0.9), ACKERMANN)
    assert v == 0.9
    assert w / v == pytest.approx(0.5)


def test_a_car_does_not_turn_on_the_spot() -> None:
    assert within((0.0, 1.0), ACKERMANN) == STILL


@given(speeds, rates, speeds, rates, st.floats(0.001, 0.1))
def test_a_ramp_never_exceeds_the_accelerations(v: float, w: float, to_v: float, to_w: float, dt: float) -> None:
    new_v, new_w = ramp((v, w), (to_v, to_w), SKID, dt)
    most = max(SKID.acceleration_mps2, SKID.deceleration_mps2)
    assert abs(new_v - v) <= most * dt + 1e-12
    assert abs(new_w - w) <= SKID.turn_acceleration_radps2 * dt + 1e-12
    if abs(new_v) > abs(v):
        assert abs(new_v - v) <= SKID.acceleration_mps2 * dt + 1e-12


def test_a_ramp_to_a_stop_takes_the_time_on_paper() -> None:
    twist, steps = (0.9, 0.0), 0
    while twist != STILL:
        twist, steps = ramp(twist, STILL, SKID, 0.05), steps + 1
    assert steps * 0.05 == pytest.approx(0.9 / SKID.deceleration_mps2)


def test_a_ramp_through_zero_stops_first() -> None:
    limits = Limits(1.0, 1.0, 0.5, 10.0, 1.0)
    assert ramp((0.3, 0.0), (-1.0, 0.0), limits, 0.1)[0] == 0.0


def test_a_braking_car_stays_on_its_curve() -> None:
    twist = (0.8, 0.4)
    for _ in range(5):
        twist = ramp(twist, STILL, ACKERMANN, 0.05)
        assert twist[1] / twist[0] == pytest.approx(0.5)
    assert math.isfinite(twist[1])
