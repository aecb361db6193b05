"""The measure of wall follow: what a ball passes by in closed forms, and that no clumsy path is let off."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pluto_bt.bench.buildings import GRID_M, Kept, kept_distance, passed_m

BALL_M, DISTANCE_M, CORNER_M = 1.45, 0.8, 2.24
STRAIGHT = np.array([[-9.0, 0.0, 9.0, 0.0]])


def notch(width_m: float, depth_m: float = 1.5) -> np.ndarray:
    """A straight wall along x with a notch in the middle that goes away from the robot, who is below it."""
    a, b = -width_m / 2, width_m / 2
    return np.array([[-9.0, 0.0, a, 0.0], [a, 0.0, a, depth_m], [a, depth_m, b, depth_m], [b, depth_m, b, 0.0], [b, 0.0, 9.0, 0.0]])


def line(y_m: float) -> np.ndarray:
    x = np.arange(-5.0, 5.0, 0.1)
    return np.column_stack((x, np.full_like(x, y_m)))


@pytest.mark.parametrize("y_m", [-0.8, -0.3, -2.0])
def test_beside_a_straight_wall_it_is_the_distance_from_the_wall(y_m: float) -> None:
    assert passed_m(line(y_m), STRAIGHT, BALL_M) == pytest.approx(-y_m, abs=2 * GRID_M)


@pytest.mark.parametrize("width_m", [0.4, 1.2, 2.4, 2.8])
def test_a_notch_that_the_ball_does_not_fit_into_is_bridged_by_its_arc(width_m: float) -> None:
    sinks_m = BALL_M - math.sqrt(BALL_M**2 - (width_m / 2) ** 2)
    to_its_edges_m = math.hypot(width_m / 2, 0.8)
    assert passed_m(np.array([[0.0, -0.8]]), notch(width_m), BALL_M)[0] == pytest.approx(min(0.8 + sinks_m, to_its_edges_m), abs=2 * GRID_M)


def test_a_bay_that_the_ball_fits_into_is_wall() -> None:
    there = np.array([[0.0, 0.7]])
    assert passed_m(there, notch(3.2), BALL_M)[0] == pytest.approx(0.8, abs=2 * GRID_M)


def test_a_camera_that_passes_a_notch_straight_on_is_off_by_no_more_than_the_arc_sinks() -> None:
    kept = kept_distance(line(-0.8), notch(2.4), DISTANCE_M, BALL_M, CORNER_M)
    assert kept.corner_m == pytest.approx(BALL_M - math.sqrt(BALL_M**2 - 1.2**2), abs=2 * GRID_M)
    assert kept.pocket_m == pytest.approx(math.hypot(1.2, 0.8) - 0.8, abs=0.01)
    assert kept.straight_m == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize(("y_m", "off_m"), [(-1.4, 0.6), (-0.2, 0.6), (-2.8, 2.0)])
def test_a_camera_too_far_away_or_too_near_is_never_let_off(y_m: float, off_m: float) -> None:
    for edges in (STRAIGHT, notch(1.2), notch(2.6), notch(4.0)):
        kept = kept_distance(line(y_m), edges, DISTANCE_M, BALL_M, CORNER_M)
        assert max(kept.straight_m, kept.corner_m) > off_m - 3 * GRID_M
        assert kept.pocket_m >= kept.corner_m - 1e-9


def test_a_detour_around_a_pocket_is_told() -> None:
    x = np.arange(-5.0, 5.0, 0.1)
    round_about = np.column_stack((x, -0.8 - 0.9 * np.exp(-(x**2))))
    kept = kept_distance(round_about, notch(2.0), DISTANCE_M, BALL_M, CORNER_M)
    assert kept.corner_m > 0.9


def test_in_a_pocket_too_near_counts_from_its_walls() -> None:
    kept = kept_distance(np.array([[0.0, 0.6]]), notch(1.0), DISTANCE_M, BALL_M, CORNER_M)
    assert isinstance(kept, Kept) and kept.corner_m == pytest.approx(0.3, abs=0.01)
