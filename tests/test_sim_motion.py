"""Wheels and body: closed forms of the motion kernels, the motors' latency and dead-man, the car's steering."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.maps.platform import Body as BodyFigures
from pluto_bt.maps.platform import Limits, Platform, Steering
from sim import motion
from sim.body import Body
from sim.motors import DEAD_MAN_S, Motors
from sim.noise import Noise
from sim.simtime import TICK_NS, TICK_S, SimTime
from sim.steering import SteeringServo

SQUARE = ((0.5, 0.4), (-0.5, 0.4), (-0.5, -0.4), (0.5, -0.4))
NO_LAG = {"motor_latency_s": 0.0, "motor_time_constant_s": 0.0}
CAR = BodyFigures(kinematics="ackermann", outline_m=SQUARE, track_m=0.25, min_turn_radius_m=0.83, min_turn_radius_percent=90.0)


def robot(kinematics: str = "differential", **limits: float) -> Platform:
    """A robot with quick motors unless told otherwise."""
    figures = {"max_speed_mps": 2.0, "max_turn_rate_dps": 180.0, "acceleration_mps2": 1000.0, "deceleration_mps2": 1000.0,
               "turn_acceleration_dps2": 1e6, **NO_LAG, **limits}  # fmt: skip
    body = CAR if kinematics == "ackermann" else BodyFigures(kinematics="differential", outline_m=SQUARE, track_m=0.5)
    return Platform(name="test", body=body, limits=Limits(**figures))


class Drive:
    """A body on open ground, driven tick by tick with the command repeated as a controller does."""

    def __init__(self, platform: Platform, ideal: bool = True) -> None:
        self.time = SimTime()
        self.body = Body(platform, (0.0, 0.0, 0.0), 0, ideal, self.time)

    def run(self, seconds: float, speed_mps: float, turn_rate_radps: float, slip: float = 0.0) -> Body:
        for _ in range(round(seconds / TICK_S)):
            self.body.motors.drive(speed_mps, turn_rate_radps)
            self.body.apply_commands(self.time.now_ns)
            self.body.advance(1, slip, False)
            self.time.jump_to(self.time.now_ns + TICK_NS)
        return self.body


@given(speed=st.floats(-2.0, 2.0), turn_rate=st.floats(-3.0, 3.0), x=st.floats(-50, 50), theta=st.floats(-4, 4), dt=st.floats(-2, 2))
def test_an_arc_is_undone_by_going_back(speed: float, turn_rate: float, x: float, theta: float, dt: float) -> None:
    there = motion.along_arc((x, 1.0, theta), speed, turn_rate, dt)
    assert motion.along_arc(there, speed, turn_rate, -dt) == pytest.approx((x, 1.0, theta), abs=1e-9)


def test_a_constant_command_draws_an_exact_circle() -> None:
    drive = Drive(robot())
    drive.run(0.01, 1.0, 0.5)
    x, y, theta = drive.body.pose
    body = drive.run(3.0, 1.0, 0.5)
    assert body.pose == pytest.approx(motion.along_arc((x, y, theta), 1.0, 0.5, 3.0), abs=1e-9)
    centre = (x - 2.0 * math.sin(theta), y + 2.0 * math.cos(theta))
    assert math.hypot(body.x_m - centre[0], body.y_m - centre[1]) == pytest.approx(2.0, abs=1e-9)


@settings(max_examples=40, deadline=None)
@given(ticks=st.integers(2, 90), deceleration=st.sampled_from([0.5, 1.0, 2.0]))
def test_braking_takes_half_v_squared_by_a(ticks: int, deceleration: float) -> None:
    speed = ticks * deceleration * TICK_S
    drive = Drive(robot(deceleration_mps2=deceleration, max_speed_mps=5.0))
    start = drive.run(0.5, speed, 0.0).x_m
    assert drive.run(speed / deceleration + 0.1, 0.0, 0.0).x_m - start == pytest.approx(speed**2 / (2.0 * deceleration), abs=1e-9)
    assert drive.body.speed_mps == 0.0


def test_latency_and_lag_of_the_motors_lengthen_the_way_to_a_stop() -> None:
    latency, lag, speed, deceleration = 0.08, 0.05, 0.6, 1.0
    drive = Drive(robot(deceleration_mps2=deceleration, motor_latency_s=latency, motor_time_constant_s=lag))
    start = drive.run(3.0, speed, 0.0).x_m
    way = drive.run(3.0, 0.0, 0.0).x_m - start
    lag_discrete = TICK_S / (1.0 - math.exp(-TICK_S / lag)) - 0.5 * TICK_S  # the lag's own area, in ticks with mean velocities
    assert way == pytest.approx(speed * (latency + lag_discrete) + speed**2 / (2.0 * deceleration), abs=speed * TICK_S)


def test_acceleration_is_limited_in_both_axes() -> None:
    drive = Drive(robot(acceleration_mps2=0.4, turn_acceleration_dps2=60.0))
    assert drive.run(1.0, 2.0, 3.0).speed_mps == pytest.approx(0.4)
    assert drive.body.turn_rate_radps == pytest.approx(math.radians(60.0))


def test_reversing_brakes_first_and_then_speeds_up() -> None:
    drive = Drive(robot(acceleration_mps2=0.5, deceleration_mps2=2.0))
    drive.run(3.0, 1.0, 0.0)
    assert drive.run(0.5, -1.0, 0.0).speed_mps == pytest.approx(0.0, abs=1e-9)
    assert drive.run(1.0, -1.0, 0.0).speed_mps == pytest.approx(-0.5)


@pytest.mark.parametrize("slip", [0.0, 0.25, 0.8, 1.0])
def test_slip_takes_its_share_from_the_body_and_not_from_the_wheels(slip: float) -> None:
    body = Drive(robot()).run(2.0, 0.5, 0.0, slip)
    assert body.x_m == pytest.approx((1.0 - slip) * body.wheel_distance_m)
    assert body.wheel_distance_m == pytest.approx(1.0, rel=0.01)


def test_a_batch_of_ticks_gives_the_bits_of_single_ticks() -> None:
    one, many = Drive(robot(acceleration_mps2=0.7)), Drive(robot(acceleration_mps2=0.7))
    for drive in (one, many):
        drive.body.motors.drive(0.9, 0.4)
        drive.body.apply_commands(0)
    for _ in range(7):
        one.body.advance(1, 0.1, False)
    many.body.advance(7, 0.1, False)
    assert one.body.pose == many.body.pose
    assert one.body.path_m == many.body.path_m


def test_the_compiled_kernel_agrees_with_the_plain_function() -> None:
    plant = np.array([TICK_S, 0.4, 1.0, 1.0, 0.2, 400.0, 0.0134])
    fast, plain = np.zeros(motion.STATE_SIZE), np.zeros(motion.STATE_SIZE)
    motion.advance_wheels(fast, plant, 0.7, -0.3, 0.9, 50)
    for _ in range(50):
        step_by_hand(plain, plant, 0.7, -0.3, 0.9)
    assert fast == pytest.approx(plain, abs=1e-12)


def step_by_hand(state: np.ndarray, plant: np.ndarray, speed: float, turn_rate: float, grip: float) -> None:
    """One tick of a base that speeds up from rest, written down again without kernels."""
    state[3] = min(speed, state[3] + plant[1] * plant[0])
    state[4] = max(turn_rate, state[4] - plant[3] * plant[0])
    v, w = state[5] + plant[4] * (state[3] - state[5]), state[6] + plant[4] * (state[4] - state[6])
    mean_v, mean_w = 0.5 * (v + state[5]), 0.5 * (w + state[6])
    pose = motion.along_arc(tuple(state[:3]), grip * mean_v, grip * mean_w, plant[0])
    state[:3] = pose
    state[5:9] = v, w, grip * v, grip * w
    state[9] += mean_v * plant[0]
    state[10] += mean_w * plant[0]
    state[11] += grip * abs(mean_v) * plant[0]
    state[12:14] = grip * mean_v, grip * mean_w
    state[16] += grip * mean_v * plant[0]


@pytest.mark.parametrize(
    ("percent_wished", "radius_m"), [(90.0, 0.83), (45.0, 1.66), (100.0, 0.747), (180.0, 0.747), (-90.0, -0.83)],
)  # fmt: skip
def test_the_car_turns_on_the_radius_of_its_steering(percent_wished: float, radius_m: float) -> None:
    drive = Drive(robot("ackermann"))
    curvature = percent_wished / 90.0 / 0.83
    drive.run(1.0, 0.5, 0.5 * curvature)
    x, y, theta = drive.body.pose
    body = drive.run(2.0, 0.5, 0.5 * curvature)
    assert body.turn_rate_radps == pytest.approx(0.5 / radius_m)
    centre = (x - radius_m * math.sin(theta), y + radius_m * math.cos(theta))
    assert math.hypot(body.x_m - centre[0], body.y_m - centre[1]) == pytest.approx(abs(radius_m), abs=1e-9)


def test_a_standing_car_holds_its_steering_and_does_not_turn() -> None:
    drive = Drive(robot("ackermann"))
    drive.run(1.0, 0.5, 0.3)
    theta = drive.run(0.5, 0.0, 0.0).theta_rad
    assert drive.run(1.0, 0.0, 1.0).theta_rad == theta
    assert drive.body.servo is not None and drive.body.servo.percent == pytest.approx(0.3 / 0.5 * 0.83 * 90.0)


def test_steering_error_is_drawn_once_for_each_new_command() -> None:
    servo = SteeringServo(CAR, Steering(noise_percent=5.0), Noise(3, "steering"), ideal=False)
    errors = []
    for turn_rate in (0.2, 0.2, 0.2001, -0.3, -0.3, 0.2):
        servo.command(0.5, turn_rate)
        errors.append(servo.error)
    assert errors[0] == errors[1] == errors[2] != errors[3] == errors[4] != errors[5]
    assert errors[5] != errors[0]
    draws = []
    for i in range(2000):
        servo.command(0.5, 0.1 if i % 2 else -0.1)
        draws.append(servo.error)
    assert np.std(draws) == pytest.approx(0.05, rel=0.1)


def test_the_dead_man_stops_the_base() -> None:
    time = SimTime()
    motors = Motors(robot().limits, time)
    motors.drive(0.5, 0.1)
    motors.advance(0)
    assert motors.command == (0.5, 0.1)
    assert motors.next_change_ns() == round(DEAD_MAN_S * 1e9)
    motors.advance(round(DEAD_MAN_S * 1e9) - 1)
    assert motors.command == (0.5, 0.1)
    motors.advance(round(DEAD_MAN_S * 1e9))
    assert motors.command == (0.0, 0.0)


def test_commands_are_held_within_the_limits_and_nan_is_a_stop() -> None:
    motors = Motors(robot(max_speed_mps=0.9, max_turn_rate_dps=45.0).limits, SimTime())
    motors.drive(5.0, -9.0)
    motors.advance(0)
    assert motors.command == pytest.approx((0.9, -math.pi / 4))
    motors.drive(math.nan, math.inf)
    motors.advance(0)
    assert motors.command == pytest.approx((0.0, math.pi / 4))
