"""The gyro at rest: its bias is found anew, nothing turns meanwhile, and a robot turned by hand has turned."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimation.gyro_rest import GyroRest

DT_S, BIAS, NOISE = 0.02, 0.01, 0.002


def played(rest: GyroRest, rates: list[float], is_still: bool = True, seed: int = 1) -> float:
    """The turn believed while the robot turns at these rates and the gyro adds what is its bias now, with noise."""
    rng = np.random.default_rng(seed)
    turned = 0.0
    for rate in rates:
        measured = rate + NOISE * rng.normal()
        turned += rest.step(DT_S, measured, (measured - rest.bias_radps) * DT_S, is_still)
    return turned


@given(st.floats(-0.5, 0.5), st.integers(0, 10_000))
def test_any_jump_of_the_bias_at_rest_is_found_and_turns_nothing(jump: float, seed: int) -> None:
    rest = GyroRest(BIAS, NOISE, 1000)
    assert abs(played(rest, [BIAS] * 70, seed=seed)) < 0.01
    assert abs(played(rest, [BIAS + jump] * 170, seed=seed + 1)) < 0.01, "it jumps in the middle of a second that is judged"
    assert rest.bias_radps == pytest.approx(BIAS + jump, abs=0.0035)


def test_a_small_drift_is_followed_without_a_jump() -> None:
    rest, jumps = GyroRest(BIAS, NOISE, 1000), 0
    for second in range(60):
        played(rest, [BIAS + 0.00002 * second] * 50, seed=second)
        jumps += rest.jumped
    assert jumps == 0
    assert rest.bias_radps == pytest.approx(BIAS + 0.0012, abs=0.0008)


def test_a_robot_turned_by_hand_has_turned_and_keeps_its_bias() -> None:
    rest = GyroRest(BIAS, NOISE, 1000)
    played(rest, [BIAS] * 115)
    by_hand = [BIAS + 0.8 * np.sin(np.pi * k / 120) for k in range(120)]
    turned = played(rest, by_hand) + played(rest, [BIAS] * 200)
    assert turned == pytest.approx(sum(by_hand) * DT_S - 120 * BIAS * DT_S, abs=0.02)
    assert rest.bias_radps == pytest.approx(BIAS, abs=0.001)


def test_what_the_gyro_shows_right_after_the_wheels_have_stopped_still_counts() -> None:
    rest = GyroRest(BIAS, NOISE, 1000)
    played(rest, [0.5] * 20, is_still=False)
    assert played(rest, [0.2 + BIAS] * 10) == pytest.approx(0.2 * 10 * DT_S, abs=0.002), "motors' lag: the body still turns"


def test_motion_begins_before_the_second_is_over() -> None:
    rest = GyroRest(BIAS, NOISE, 1000)
    played(rest, [BIAS] * 40)
    assert played(rest, [0.5 + BIAS] * 50, is_still=False) == pytest.approx(0.5, abs=0.02)
