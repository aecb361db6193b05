"""The measure of wall follow: how far a camera is from the nearest wall, beside straight walls and at corners."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pluto_bt.bench.buildings import Kept, kept_distance

DISTANCE_M, CORNER_M = 0.8, 2.24
STRAIGHT = np.array([[-9.0, 0.0, 9.0, 0.0]])


def notch(width_m: float, depth_m: float = 1.5) -> np.ndarray:
    """A straight wall along x with a notch in the middle that goes away from the robot, who is below it."""
    a, b = -width_m / 2, width_m / 2
    return np.array([[-9.0, 0.0, a, 0.0], [a, 0.0, a, depth_m], [a, depth_m, b, depth_m], [b, depth_m, b, 0.0], [b, 0.0, 9.0, 0.0]])


def line(y_m: float) -> np.ndarray:
    x = np.arange(-5.0, 5.0, 0.1)
    return np.column_stack((x, np.full_like(x, y_m)))


@pytest.mark.parametrize(("y_m", "off_m"), [(-0.8, 0.0), (-0.3, 0.5), (-2.0, 1.2)])
def test_beside_a_straight_wall_it_is_the_distance_from_the_wall(y_m: float, off_m: float) -> None:
    kept = kept_distance(line(y_m), STRAIGHT, DISTANCE_M, CORNER_M)
    assert (kept.straight_m, kept.corner_m, kept.straight_share) == (pytest.approx(off_m), 0.0, 1.0)


@pytest.mark.parametrize("width_m", [0.4, 1.2, 2.4, 2.8])
def test_a_camera_that_passes_a_notch_straight_on_is_too_far_from_its_edges(width_m: float) -> None:
    kept = kept_distance(line(-0.8), notch(width_m), DISTANCE_M, CORNER_M)
    assert kept.corner_m == pytest.approx(math.hypot(width_m / 2, 0.8) - 0.8, abs=0.03)
    assert kept.straight_m == pytest.approx(0.0, abs=1e-9) and 0.1 < kept.straight_share < 0.9


def test_a_detour_around_a_notch_is_told() -> None:
    x = np.arange(-5.0, 5.0, 0.1)
    round_about = np.column_stack((x, -0.8 - 0.9 * np.exp(-(x**2))))
    assert kept_distance(round_about, notch(2.0), DISTANCE_M, CORNER_M).corner_m > 0.9


def test_too_near_counts_as_too_far_does() -> None:
    kept = kept_distance(np.array([[0.0, 0.6]]), notch(1.0), DISTANCE_M, CORNER_M)
    assert isinstance(kept, Kept) and kept.corner_m == pytest.approx(0.3, abs=0.01)
