"""Gyro bias, filtering, and the choice of the heading."""

from __future__ import annotations

import math

import numpy as np
import pytest

from estimation.gyro_bias import BiasNews, GyroBias
from estimation.heading import AbsoluteHeading, GyroHeading, WheelHeading
from estimation.inertial import InertialHeading, low_pass, theta_rate
from estimation.odometer import Odometer, SignedSpeed
from pluto_bt.maps.geometry import wrap_angle


def test_the_bias_is_the_mean_of_the_standstill_samples() -> None:
    rates = np.random.default_rng(3).normal(0.012, 0.01, 1000)
    bias = GyroBias(1000)
    news = [bias.add(rate, True) for rate in rates]
    assert news[:-1] == [BiasNews.NOTHING] * 999 and news[-1] is BiasNews.KNOWN
    assert bias.bias_radps == pytest.approx(rates.mean(), abs=1e-12)
    assert bias.spread_radps == pytest.approx(rates.std(), rel=1e-9)
    assert bias.add(9.0, False) is BiasNews.NOTHING and bias.known  # once known it stays


def test_a_robot_that_moves_is_told_and_the_samples_start_again() -> None:
    bias = GyroBias(10)
    assert [bias.add(1.0, True) for _ in range(9)] == [BiasNews.NOTHING] * 9
    assert [bias.add(1.0, False) for _ in range(3)] == [BiasNews.MOVED, BiasNews.NOTHING, BiasNews.NOTHING]
    assert [bias.add(0.5, True) for _ in range(10)][-1] is BiasNews.KNOWN
    assert bias.bias_radps == 0.5


def test_scattered_samples_are_refused() -> None:
    bias = GyroBias(4, max_spread_radps=0.1)
    assert [bias.add(rate, True) for rate in (0.0, 1.0, 0.0, 1.0)][-1] is BiasNews.UNSTEADY
    assert not bias.known and bias.taken == 0


def test_low_pass_reaches_63_percent_of_a_step_after_its_time_constant() -> None:
    filtered = (0.0, 0.0, 0.0)
    for _ in range(1000):
        filtered = low_pass(filtered, (1.0, 0.0, 0.0), 0.0001 / (0.1 + 0.0001))
    assert filtered[0] == pytest.approx(1.0 - math.exp(-1.0), abs=1e-3)


def test_stamp_delay_makes_up_for_the_filter_in_a_steady_turn() -> None:
    """Ramp in angle: the filtered theta, at a stamp one time constant earlier, is the true theta."""
    heading, rate = InertialHeading(0.04), 0.8
    heading.step(0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 9.8), 0.0, 0.0)
    for k in range(1, 201):
        heading.step(k * 0.02, (0.0, 0.0, rate), (0.0, 0.0, 9.8), 0.0, 0.0)
    assert heading.theta_rad == pytest.approx(rate * (4.0 - heading.delay_s), abs=0.002)


def test_a_sample_out_of_order_turns_nothing() -> None:
    heading = InertialHeading(0.0)
    for stamp_s in (0.0, 1.0, 0.5, 1.0):
        heading.step(stamp_s, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), 0.0, 0.0)
    assert heading.theta_rad == 1.0


def test_on_a_slope_the_rate_about_the_vertical_is_what_counts() -> None:
    slope = math.radians(20)  # nose down by phi; turning about the vertical at 1 rad/s shows as (-sin, 0, cos) in the body
    assert theta_rate((-math.sin(slope), 0.0, math.cos(slope)), slope, 0.0) == pytest.approx(1.0)
    assert theta_rate((0.0, math.sin(slope), math.cos(slope)), 0.0, slope) == pytest.approx(1.0)


def test_gyro_heading_falls_back_to_the_wheels_and_comes_back_without_a_jump() -> None:
    heading = GyroHeading()
    assert heading.turn(0.02, 0.1, 5.0) == (0.1, False)  # nothing to compare with yet
    assert heading.turn(0.02, 0.1, 5.2) == (pytest.approx(0.2), True)
    assert heading.turn(0.02, 0.1, None) == (0.1, False)
    assert heading.turn(0.02, 0.1, -2.0) == (0.1, False)  # theta has jumped meanwhile: no matter
    assert heading.turn(0.02, 0.1, -1.9) == (pytest.approx(0.1), True)


def test_while_the_bias_is_unknown_the_wheels_teach_it_on_straights() -> None:
    """Wheels that are 10 % wrong in turns, a gyro with 0.01 rad/s of bias: the heading after straights and turns is right."""
    heading, dt, bias, theta, total, true = GyroHeading(), 0.02, 0.01, 0.0, 0.0, 0.0
    rates = [0.0] * 25 + [0.8] * 100 + [0.0] * 200 + [-0.5] * 150 + [0.001] * 100
    for rate in rates:
        true += rate * dt
        theta += (rate + bias) * dt
        wheels = rate * dt * (1.1 if abs(rate) > 0.1 else 1.0)
        total += heading.turn(dt, wheels, theta, bias_known=False)[0]
    assert total == pytest.approx(true, abs=1e-6)


def test_without_a_straight_the_wheels_give_the_heading_and_the_car_has_none() -> None:
    turning, car = GyroHeading(), GyroHeading(teaches=False)
    for k in range(50):
        assert turning.turn(0.02, 0.01, 0.03 * k, bias_known=False) == (0.01, False)
        assert car.turn(0.02, 0.0, 0.03 * k, bias_known=False) == (0.0, False)


def test_absolute_heading_follows_its_sensor_whatever_the_wheels_say() -> None:
    heading, offset, true = AbsoluteHeading(0.5), 2.0, 0.5
    for _ in range(50):
        heading.turn(0.02, 0.0, true - offset)
    for _ in range(400):  # the wheels believe in twice the turn: they slip
        true += 0.01
        heading.turn(0.02, 0.02, wrap_angle(true - offset))
    assert heading.heading_rad == pytest.approx(true, abs=1e-9)


def test_absolute_heading_makes_up_a_gap_slowly() -> None:
    heading = AbsoluteHeading(0.0)
    heading.turn(0.02, 0.0, 0.0)
    heading.turn(0.02, 1e-9, 0.0)
    turn, _ = heading.turn(0.02, 0.0, 1.0)
    assert turn == pytest.approx(0.02)
    for _ in range(60):
        heading.turn(0.02, 0.0, 1.0)
    assert heading.heading_rad == pytest.approx(1.0)


def test_standstill_averages_the_noise_of_the_offset() -> None:
    rng, heading = np.random.default_rng(2), AbsoluteHeading(0.0)
    for _ in range(200):
        heading.turn(0.02, 0.0, 1.0 + rng.normal(0, 0.03))
    for _ in range(200):
        heading.turn(0.02, 1e-6, 1.0)
    assert abs(heading.heading_rad) < 0.008  # one sample alone would be off by 0.03


def test_a_counter_that_jumps_moves_nothing() -> None:
    odometer = Odometer(1.0)
    assert odometer.step(0.0, 100.0, 0.0) is None
    assert odometer.step(0.02, 100.01, 3.1) == (0.02, pytest.approx(0.01), pytest.approx(3.1))
    assert odometer.step(0.02, 100.02, 3.1) is None
    assert odometer.step(0.04, 0.0, 3.1) == (pytest.approx(0.02), 0.0, 0.0)
    assert odometer.jumps == 1
    assert odometer.step(0.06, 0.01, -3.1) == (pytest.approx(0.02), pytest.approx(0.01), pytest.approx(math.tau - 6.2))


def test_unsigned_speed_takes_the_sign_of_the_last_command_that_was_not_zero() -> None:
    signed = SignedSpeed()
    signed.step(0.0, 0.0, -0.3)
    assert signed.step(1.0, 0.5, 0.0) == (1.0, -0.5)
    assert signed.step(2.0, 0.5, 0.4) == (1.0, 0.5)


def test_the_wheels_alone_ask_no_sensor() -> None:
    assert WheelHeading().turn(0.02, 0.1, 2.0) == (0.1, False)
