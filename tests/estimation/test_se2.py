"""Poses in the plane: group laws, arcs, interpolation."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimation.se2 import IDENTITY, Pose2, arc, blend, compose, inverse, motion_of, twist_of
from pluto_bt.maps.geometry import wrap_angle

metres = st.floats(-1e3, 1e3)
angles = st.floats(-3.0, 3.0)
poses = st.tuples(metres, metres, angles)


def close(a: Pose2, b: Pose2, tolerance: float = 1e-6) -> bool:
    return math.dist(a[:2], b[:2]) < tolerance and abs(wrap_angle(a[2] - b[2])) < tolerance


@given(poses)
def test_a_pose_composed_with_its_inverse_is_identity(pose: Pose2) -> None:
    assert close(compose(pose, inverse(pose)), IDENTITY)
    assert close(compose(inverse(pose), pose), IDENTITY)


@given(poses, poses, poses)
def test_composing_is_associative(a: Pose2, b: Pose2, c: Pose2) -> None:
    assert close(compose(compose(a, b), c), compose(a, compose(b, c)))


@given(st.tuples(st.floats(-10, 10), st.floats(-10, 10), angles))
def test_twist_and_motion_are_inverse(step: Pose2) -> None:
    assert close(motion_of(twist_of(step)), step)


@pytest.mark.parametrize("turn_rad", [0.0, 1e-9, 1e-7, 1e-5, 0.5, -2.0, math.pi])
def test_an_arc_is_the_sum_of_its_halves(turn_rad: float) -> None:
    half = arc(1.0, turn_rad / 2)
    assert close(compose(half, half), arc(2.0, turn_rad), 1e-12)


def test_a_quarter_circle_to_the_left_ends_one_radius_ahead_and_left() -> None:
    assert close(arc(math.pi, math.pi / 2), (2.0, 2.0, math.pi / 2), 1e-12)


@given(poses, st.floats(-2, 2), st.floats(-2, 2), st.floats(0, 1))
def test_interpolation_is_exact_for_a_constant_twist(start: Pose2, distance_m: float, turn_rad: float, share: float) -> None:
    end = compose(start, arc(distance_m, turn_rad))
    assert close(blend(start, end, share), compose(start, arc(share * distance_m, share * turn_rad)))
