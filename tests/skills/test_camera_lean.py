"""The lean of a path beside a wall: none where the camera is well, towards the wall in pockets, never beyond its limits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pluto_bt.skills.camera_lean import SPARE_M, leaned
from pluto_bt.skills.camera_lean import _camera as camera_and_slope
from pluto_bt.skills.outline import Array

CAMERA = (-0.45, 0.65, 0.8)
LIMITS = (-0.05, 0.35)
STEP_M = 0.06


def straight(y_m: float = 0.0, length_m: float = 5.0) -> Array:
    """A path along x, the robot at its middle."""
    x = np.arange(-length_m / 2, length_m / 2, STEP_M)
    return np.column_stack((x, np.full_like(x, y_m), np.zeros_like(x)))


def wall(a: tuple[float, float], b: tuple[float, float]) -> Array:
    count = int(math.dist(a, b) / 0.03) + 2
    return np.linspace(a, b, count)


def cameras_off(path: Array, points: Array) -> Array:
    x, y, away_m = CAMERA
    c, s = np.cos(path[:, 2:3]), np.sin(path[:, 2:3])
    cx, cy = path[:, :1] + c * x - s * y, path[:, 1:2] + s * x + c * y
    return np.asarray(np.sqrt(((cx - points[:, 0]) ** 2 + (cy - points[:, 1]) ** 2).min(axis=1)) - away_m)


@pytest.mark.parametrize("y_m", [0.0, 0.09, -0.09])
def test_beside_a_straight_wall_nothing_leans(y_m: float) -> None:
    path = straight(y_m)
    assert leaned(path, len(path) // 2, wall((-4.0, 1.45), (4.0, 1.45)), CAMERA, LIMITS) is path


@pytest.mark.parametrize("gap_m", [1.0, 1.6, 2.2])
def test_before_a_pocket_the_camera_comes_nearer_to_its_distance(gap_m: float) -> None:
    points = np.vstack((wall((-4.0, 1.45), (-gap_m / 2, 1.45)), wall((gap_m / 2, 1.45), (4.0, 1.45)), wall((-gap_m / 2, 2.6), (gap_m / 2, 2.6))))
    path = straight()
    foot = len(path) // 6
    lean = leaned(path, foot, points, CAMERA, LIMITS)
    before, after = cameras_off(path[foot:], points), cameras_off(lean[foot:], points)
    if before.max() <= SPARE_M:
        assert lean is path
        return
    assert after.max() < before.max() and after.min() > -0.2
    assert lean[:, 1].min() >= -0.051 and lean[:, 1].max() <= 0.351
    turns = np.abs(np.diff(np.unwrap(lean[:, 2])))
    assert turns.max() < 0.5, "no kinks"
    assert np.hypot(*np.diff(lean[:, :2], axis=0).T).max() < 1.5 * STEP_M


def test_the_slope_is_that_of_the_distance() -> None:
    rng = np.random.default_rng(4)
    path = straight(length_m=2.0)[::2]
    left = np.tile((0.0, 1.0), (len(path), 1))
    points = rng.uniform((-2.0, 1.2), (2.0, 2.2), (40, 2))
    lean = rng.uniform(0.0, 0.1, len(path))
    off, slope = camera_and_slope(path[:, :2] + lean[:, None] * left, left, points, CAMERA)
    for i in range(len(path)):
        step = np.zeros(len(path))
        step[i] = 1e-6
        other, _ = camera_and_slope(path[:, :2] + (lean + step)[:, None] * left, left, points, CAMERA)
        assert (other - off) / 1e-6 == pytest.approx(slope[:, i], abs=1e-3)


def test_where_nothing_stands_near_the_path_stays() -> None:
    path = straight()
    assert leaned(path, 10, np.array([[40.0, 40.0]]), CAMERA, LIMITS) is path
    assert leaned(path[:2], 0, np.array([[0.0, 1.0]]), CAMERA, LIMITS).shape == (2, 3)
