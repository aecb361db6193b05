"""What a tilted laser tells of the walls: the same as a level one, where it meets them above the ground."""

from __future__ import annotations

import math

import numpy as np
import pytest

from estimation.levelled_scan import LEAST_M, levelled
from estimation.se2 import Pose2
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import Shape, World

ANGLES = np.linspace(-math.pi / 2, math.pi / 2, 361)
STEP = float(ANGLES[1] - ANGLES[0])
HEIGHT_M = 0.6
ROOM = World("room", shapes=(
    Shape("walls", "wall", np.array([(-6.0, -3.0), (5.0, -3.0), (5.0, 2.5), (-6.0, 2.5), (-6.0, -3.0)])),
    Shape("crate", "polygon", np.array([(1.5, 1.0), (2.5, 1.2), (2.3, 2.0), (1.5, 2.0)])),
))  # fmt: skip


def scan(pose: Pose2, tilt_rad: float) -> np.ndarray:
    ranges = np.zeros(len(ANGLES))
    Scene(ROOM).scan(pose, HEIGHT_M, tilt_rad, ANGLES, 80.0, ranges)
    return ranges


@pytest.mark.parametrize("tilt_deg", [-8.0, 3.0, 7.0, 14.0, 28.0])
@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0), (-2.0, 1.0, 0.8), (3.0, -1.0, -2.4)])
def test_where_it_tells_something_it_tells_what_a_level_scan_does(pose: Pose2, tilt_deg: float) -> None:
    level, told = scan(pose, 0.0), levelled(scan(pose, math.radians(tilt_deg)), float(ANGLES[0]), STEP, math.radians(tilt_deg), HEIGHT_M)
    tells = told > 0.0
    assert np.count_nonzero(tells) >= 30
    edge = np.convolve(np.abs(np.diff(level, prepend=level[0])) > 0.1, np.ones(7), "same") > 0  # between two things a beam meets the one or the other
    assert np.abs(told - level)[tells & ~edge].max() < 0.03


def test_the_ground_is_left_out() -> None:
    tilt_rad = math.radians(28.0)
    ground = np.full(361, 0.0)
    ahead = np.cos(ANGLES) > 0.1
    ground[ahead] = HEIGHT_M / (math.sin(tilt_rad) * np.cos(ANGLES[ahead]))
    assert not levelled(ground, float(ANGLES[0]), STEP, tilt_rad, HEIGHT_M).any()
    nearer = np.where(ground > 0.0, ground * (1.0 - 1.2 * LEAST_M / HEIGHT_M), 0.0)
    assert np.count_nonzero(levelled(nearer, float(ANGLES[0]), STEP, tilt_rad, HEIGHT_M)) > 250


def test_beams_without_a_number_tell_nothing() -> None:
    assert not levelled(np.zeros(361), float(ANGLES[0]), STEP, 0.1, HEIGHT_M).any()
    assert not levelled(np.full(361, np.nan), float(ANGLES[0]), STEP, 0.1, HEIGHT_M).any()
