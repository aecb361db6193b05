"""Rotations in space: the angles come back, and the laser's axes point where a person would point them."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimation.se3 import angles, compose, rotation


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_angles_of_a_rotation_come_back(theta: float, phi: float, psi: float) -> None:
    assert angles(rotation(theta, phi, psi)) == pytest.approx((theta, phi, psi), abs=1e-6)


def test_a_laser_panned_left_and_tilted_down() -> None:
    robot = (1.0, 2.0, 0.0, math.pi / 2, 0.0, 0.0)
    laser = compose(robot, (0.5, 0.0, 0.6, 0.3, 0.2, 0.0))
    assert laser == pytest.approx((1.0, 2.5, 0.6, math.pi / 2 + 0.3, 0.2, 0.0))
    ahead = compose(laser, (1.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert ahead[2] == pytest.approx(0.6 - math.sin(0.2))  # positive tilt looks down


def test_straight_down_psi_is_taken_as_zero() -> None:
    theta, phi, psi = angles(rotation(0.7, math.pi / 2, 0.0))
    assert (theta, phi, psi) == pytest.approx((0.7, math.pi / 2, 0.0), abs=1e-6)
