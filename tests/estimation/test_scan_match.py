"""How far a laser moved, from two scans: in rooms exactly, in corridors across only, in the open not at all."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimation.scan_match import match_scans
from estimation.se2 import Pose2, compose
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import Shape, World

ANGLES = np.linspace(-math.pi / 2, math.pi / 2, 361)
STEP = float(ANGLES[1] - ANGLES[0])
ROOM = World("room", shapes=(
    Shape("walls", "wall", np.array([(-6.0, -5.0), (7.0, -5.0), (7.0, 8.0), (-6.0, 8.0), (-6.0, -5.0)])),
    Shape("crate", "polygon", np.array([(3.0, 2.0), (4.0, 2.2), (3.8, 3.0), (3.0, 3.0)])),
    Shape("post", "circle", np.array([[-3.0, 4.0]]), 0.2),
))  # fmt: skip
CORRIDOR = World("corridor", shapes=(
    Shape("left", "wall", np.array([(-99.0, 2.0), (99.0, 2.0)])), Shape("right", "wall", np.array([(-99.0, -2.0), (99.0, -2.0)])),
))  # fmt: skip


def scan(world: World, pose: Pose2, seed: int) -> np.ndarray:
    ranges = np.zeros(len(ANGLES))
    Scene(world).scan(pose, 0.6, 0.0, ANGLES, 80.0, ranges)
    return np.round(np.minimum(ranges + 0.01 * np.random.default_rng(seed).normal(size=len(ranges)), 80.0), 2)


def matched(world: World, start: Pose2, motion: Pose2, guess: Pose2, seed: int = 1) -> object:
    return match_scans(scan(world, start, seed), scan(world, compose(start, motion), seed + 1), float(ANGLES[0]), STEP, guess, 80.0)


@settings(max_examples=60, deadline=None)
@given(st.floats(-3, 3), st.floats(-2, 5), st.floats(-3, 3), st.floats(0, 0.5), st.floats(-0.25, 0.25), st.floats(-0.15, 0.15), st.floats(-0.1, 0.1))
def test_in_a_room_the_motion_is_found_from_a_poor_guess(x: float, y: float, theta: float, way: float, turn: float, dx: float, dt: float) -> None:
    step = matched(ROOM, (x, y, theta), (way, 0.0, turn), (way + dx, 0.0, turn + dt))
    if step.fits > 0.8:  # very near the crate much comes into view at once
        assert step.step == pytest.approx((way, 0.0, turn), abs=0.02)
        assert step.step[2] == pytest.approx(turn, abs=0.006)


def test_a_wrong_guess_fits_worse_and_the_match_says_so() -> None:
    step = matched(ROOM, (0.0, 0.0, 0.3), (0.1, 0.0, 0.0), (0.3, 0.0, 0.1))
    assert step.fits > 0.95 and step.fits_as_guessed < 0.5
    assert max(step.sigma_x_m, step.sigma_y_m) < 0.01 and step.sigma_theta_rad < 0.002


def test_along_a_corridor_the_guess_stays_and_is_told_to_be_uncertain() -> None:
    step = matched(CORRIDOR, (0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.1, 0.05, 0.02))
    assert step.step[0] == pytest.approx(0.1, abs=0.05), "nothing tells how far"
    assert step.step[1:] == pytest.approx((0.0, 0.0), abs=0.01), "but across and the turn are seen"
    assert step.sigma_x_m > 5 * step.sigma_y_m


def test_another_place_does_not_fit() -> None:
    before, now = scan(ROOM, (0.0, 0.0, 0.0), 1), scan(ROOM, (4.5, 5.0, 2.0), 2)
    assert match_scans(before, now, float(ANGLES[0]), STEP, (0.1, 0.0, 0.0), 80.0).fits < 0.4


def test_nobody_who_stands_before_the_laser_moves_it() -> None:
    """A third of the beams end on somebody who comes nearer by 0.2 m; half a metre away he fills that much."""
    before, now = scan(ROOM, (0.0, 0.0, 0.0), 1), scan(ROOM, (0.0, 0.0, 0.0), 2)
    before[120:240], now[120:240] = 0.7, 0.5
    step = match_scans(before, now, float(ANGLES[0]), STEP, (0.0, 0.0, 0.0), 80.0)
    assert step.step == pytest.approx((0.0, 0.0, 0.0), abs=0.01)


def test_an_empty_field_says_nothing() -> None:
    empty = np.full(361, 80.0)
    step = match_scans(empty, np.full(361, math.nan), float(ANGLES[0]), STEP, (0.1, 0.0, 0.2), 80.0)
    assert step.points == 0 and step.step == pytest.approx((0.1, 0.0, 0.2))


def test_scans_of_two_shapes_are_refused() -> None:
    with pytest.raises(ValueError, match="shapes"):
        match_scans(np.zeros(361), np.zeros(181), 0.0, STEP, (0.0, 0.0, 0.0), 80.0)
