"""What creeps is learned and put right; what does not is left alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimation.trim import OF_GYRO, OF_WHEELS, Honesty, Trim

SIGMA = {OF_GYRO: math.radians(0.03), OF_WHEELS: 0.004}
KINDS = pytest.mark.parametrize(("honesty", "extent"), [(OF_GYRO, 2.4), (OF_WHEELS, 1.0), (OF_WHEELS, -1.0)], ids=["gyro", "wheels", "backwards"])


def learned(honesty: Honesty, extent: float, rate: float, count: int, seed: int = 1) -> tuple[Trim, float]:
    """A trim after `count` comparisons of a sensor whose figure is short by `rate` per extent, and the error that is left in the sum."""
    rng, trim, error = np.random.default_rng(seed), Trim(honesty), 0.0
    for _ in range(count):
        off = (rate - trim.rate) * extent
        error += off
        seen = off + 0.7 * SIGMA[honesty] * float(rng.normal())
        error -= trim.take(seen, SIGMA[honesty], extent)
    return trim, error


@KINDS
@pytest.mark.parametrize("share", [0.8, -0.8])
def test_a_rate_is_found_and_the_past_put_right(honesty: Honesty, extent: float, share: float) -> None:
    rate = share * honesty.rate
    trim, error = learned(honesty, extent, rate, 150)
    assert trim.rate == pytest.approx(rate, abs=0.25 * honesty.rate)
    assert abs(error) < 0.1 * abs(rate * extent * 150), "nine tenths of what had gathered"


@KINDS
@given(seed=st.integers(0, 200))
def test_a_perfect_sensor_is_left_alone_whatever_the_noise_of_the_comparisons(honesty: Honesty, extent: float, seed: int) -> None:
    trim, error = learned(honesty, extent, 0.0, 100, seed)
    assert trim.rate == 0.0 and error == 0.0


@KINDS
def test_what_is_far_off_is_no_creeping(honesty: Honesty, extent: float) -> None:
    trim = Trim(honesty)
    assert [trim.take(20.0 * honesty.rate * extent, SIGMA[honesty], extent) for _ in range(20)] == [0.0] * 20
    assert trim.rate == 0.0


def test_a_bias_that_was_measured_anew_is_not_taken_off_twice() -> None:
    bias = 0.8 * OF_GYRO.rate
    trim, _ = learned(OF_GYRO, 2.4, -bias, 150)
    before = trim.rate
    trim.moved(0.5 * bias)  # so much of it the gyro takes off by itself now
    assert trim.rate == pytest.approx(before + 0.5 * bias)
    trim.moved(5.0 * OF_GYRO.rate)
    assert trim.rate == 0.0, "another gyro: all begins anew"
