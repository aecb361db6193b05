"""Backing out: the trail, the way back between walls, and when the robot may turn."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pluto_bt.skills.backing import Backing
from pluto_bt.skills.outline import Array, outline_of
from pluto_bt.skills.trail import Trail

OUTLINE = outline_of([(0.6, 0.4), (-0.6, 0.4), (-0.6, -0.4), (0.6, -0.4)])


def walls(left_m: float, right_m: float, turned_rad: float) -> Array:
    """Two walls beside the robot, which is turned against them."""
    along = np.arange(-0.5, 3.0, 0.05)
    points = np.vstack([np.column_stack((along, np.full(len(along), y_m))) for y_m in (left_m, -right_m)])
    c, s = math.cos(turned_rad), math.sin(turned_rad)
    out = np.zeros((len(points), 5))
    out[:, 0], out[:, 1], out[:, 2] = c * points[:, 0] + s * points[:, 1], c * points[:, 1] - s * points[:, 0], 0.08
    return out


@pytest.mark.parametrize("turned_deg", [-8.0, 0.0, 6.0])
def test_a_robot_backs_along_the_walls_however_it_stands(turned_deg: float) -> None:
    turn_rad, _ = Backing(OUTLINE).way_back(walls(0.65, 0.65, math.radians(turned_deg)), (0.0, 0.0, 0.0), (0.5, 0.5))
    assert math.degrees(turn_rad) == pytest.approx(-turned_deg, abs=2.1)


def test_it_backs_towards_the_wall_that_is_farther_away() -> None:
    nearer_left, _ = Backing(OUTLINE).way_back(walls(0.5, 0.8, 0.0), (0.0, 0.0, 0.0), (0.5, 0.5))
    nearer_right, _ = Backing(OUTLINE).way_back(walls(0.8, 0.5, 0.0), (0.0, 0.0, 0.0), (0.5, 0.5))
    assert nearer_left > 0.05 > -0.05 > nearer_right, "nose to the left = tail to the right"


def test_between_walls_that_are_too_near_it_cannot_turn_round_and_in_the_open_it_can() -> None:
    assert max(Backing(OUTLINE).turnable_rad(walls(0.65, 0.65, 0.0))) < 1.0
    assert Backing(OUTLINE).turnable_rad(np.zeros((0, 5))) == (math.pi, math.pi)


def test_a_way_back_ends_a_little_beyond_where_the_robot_can_turn() -> None:
    backing = Backing(OUTLINE)
    backing.begin((0.0, 0.0, 0.0), math.pi, is_blind=False)
    went = [x_m for x_m in np.arange(0.0, -3.0, -0.05).tolist() if backing.is_on and backing.goes_on((x_m, 0.0, 0.0), 0.5, x_m < -1.0)]
    assert -1.2 <= went[-1] <= -1.1


def test_who_is_blind_backs_no_farther_than_his_trail_leads() -> None:
    backing = Backing(OUTLINE)
    for x_m in np.arange(0.0, 1.01, 0.05).tolist():
        backing.note((x_m, 0.0, 0.0))
    backing.begin((1.0, 0.0, 0.0), math.pi, is_blind=True)
    went = [x_m for x_m in np.arange(1.0, -3.0, -0.05).tolist() if backing.is_on and backing.goes_on((x_m, 0.0, 0.0), 0.5, False)]
    assert 0.0 <= went[-1] <= 0.3


def test_going_back_on_what_it_left_is_no_wish_until_it_has_turned() -> None:
    backing = Backing(OUTLINE)
    backing.begin((0.0, 0.0, 0.0), 3.0, is_blind=False)
    assert backing.aim(0.0, 0.0) == pytest.approx(3.0), "ahead is where it came out of"
    assert backing.aim(0.0, 2.0) == 0.0 and not backing.is_leaving, "it has turned"


def test_a_trail_leads_back_the_way_it_was_driven() -> None:
    trail = Trail()
    for angle_rad in np.linspace(0.0, math.pi / 2.0, 40).tolist():  # a quarter of a circle to the left, 2 m round
        pose = (2.0 * math.sin(angle_rad), 2.0 - 2.0 * math.cos(angle_rad), angle_rad)
        trail.note(pose, is_backing=False)
    assert trail.length_m == pytest.approx(math.pi, abs=0.2)
    turn_rad = trail.turn_rad(pose, 1.0)
    assert turn_rad == pytest.approx(-0.25, abs=0.06), "half of the arc's angle, to the right"
    length_m = trail.length_m
    trail.note((2.0 * math.sin(1.0), 2.0 - 2.0 * math.cos(1.0), 1.0), is_backing=True)
    assert trail.length_m < length_m
    trail.note((9.0, 9.0, 0.0), is_backing=False)
    assert trail.length_m == 0.0, "carried away"
