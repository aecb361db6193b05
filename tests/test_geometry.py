"""Poses compose, and points move with them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.maps.geometry import compose, transform_points, wrap_angle

metres = st.floats(-1e3, 1e3)
poses = st.tuples(metres, metres, st.floats(-10.0, 10.0))
points = st.lists(st.tuples(metres, metres), max_size=5)


def same_pose(a, b):
    return math.isclose(a[0], b[0], abs_tol=1e-9) and math.isclose(a[1], b[1], abs_tol=1e-9) and abs(wrap_angle(a[2] - b[2])) < 1e-9


@given(poses, poses, poses)
def test_composing_does_not_depend_on_brackets(a, b, c):
    assert same_pose(compose(compose(a, b), c), compose(a, compose(b, c)))


@given(poses, poses, points)
def test_points_moved_twice_are_moved_by_the_composed_pose(a, b, points):
    twice = transform_points(a, transform_points(b, points))
    assert transform_points(compose(a, b), points) == pytest.approx(twice, abs=1e-9)


@given(poses, points)
def test_points_move_as_the_places_of_poses_do(pose, points):
    moved = transform_points(pose, points)
    assert moved.shape == (len(points), 2)
    for point, after in zip(points, moved, strict=True):
        assert tuple(after) == compose(pose, (*point, 0.0))[:2]


@given(st.floats(-1e6, 1e6))
def test_a_wrapped_angle_points_the_same_way(angle_rad):
    wrapped = wrap_angle(angle_rad)
    assert -math.pi <= wrapped <= math.pi
    assert math.sin(wrapped) == pytest.approx(math.sin(angle_rad), abs=1e-9)
    assert math.cos(wrapped) == pytest.approx(math.cos(angle_rad), abs=1e-9)


@pytest.mark.parametrize("angle_rad", [0.0, math.pi, -math.pi, 1e-300, -3.0])
def test_an_angle_within_half_a_turn_is_returned_as_it_is(angle_rad):
    assert wrap_angle(angle_rad) == angle_rad


def test_laser_on_a_turned_robot():
    pose_map_robot, pose_robot_laser = (1.0, 2.0, math.pi / 2), (0.5, 0.0, 0.0)
    assert compose(pose_map_robot, pose_robot_laser) == pytest.approx((1.0, 2.5, math.pi / 2))


def test_points_are_not_changed_in_place():
    points = np.array([[1.0, 0.0]])
    transform_points((0.0, 0.0, 1.0), points)
    assert points.tolist() == [[1.0, 0.0]]
