"""Covariance propagation against matrices, and against many noisy runs."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from estimation.covariance import ZERO, Covariance, as_nine, blended, from_nine, moved, stepped
from estimation.se2 import arc, compose

small = st.floats(-3, 3)


@st.composite
def covariances(draw: st.DrawFn) -> Covariance:
    A = np.array(draw(st.lists(st.floats(-2, 2), min_size=9, max_size=9))).reshape(3, 3)
    return from_nine(tuple((A @ A.T).ravel()))


def matrix(P: Covariance) -> NDArray[np.float64]:
    return np.array(as_nine(P)).reshape(3, 3)


@given(covariances(), small, small)
def test_moved_is_f_p_ft(P: Covariance, dx: float, dy: float) -> None:
    F = np.array([[1, 0, -dy], [0, 1, dx], [0, 0, 1]])
    np.testing.assert_allclose(matrix(moved(P, dx, dy)), F @ matrix(P) @ F.T, atol=1e-9)


@given(covariances(), covariances(), st.floats(0, 1), small, small, small)
def test_covariances_stay_positive(P: Covariance, Q: Covariance, share: float, dx: float, dy: float, heading: float) -> None:
    for R in (blended(P, Q, share), stepped(P, dx, dy, heading, 0.1, 0.2)):
        assert np.linalg.eigvalsh(matrix(R)).min() > -1e-9


def test_predicted_covariance_is_that_of_many_noisy_runs() -> None:
    rng = np.random.default_rng(1)
    distance_var, turn_var, n = 1e-4, 4e-5, 4000
    P, pose, ends = ZERO, (0.0, 0.0, 0.5), [(0.0, 0.0, 0.5)] * n
    for _ in range(40):
        after = compose(pose, arc(0.1, 0.03))
        P = stepped(P, after[0] - pose[0], after[1] - pose[1], 0.5 * (pose[2] + after[2]), distance_var, turn_var)
        pose = after
        noise = rng.normal(size=(n, 2)) * [math.sqrt(distance_var), math.sqrt(turn_var)]
        ends = [compose(end, arc(0.1 + d, 0.03 + t)) for end, (d, t) in zip(ends, noise, strict=True)]
    seen = np.cov(np.array(ends).T)
    np.testing.assert_allclose(matrix(P), seen, rtol=0.12, atol=3e-4)


def test_nine_numbers_are_wanted() -> None:
    with pytest.raises(ValueError, match="9 numbers, not 4"):
        from_nine((1.0, 2.0, 3.0, 4.0))
