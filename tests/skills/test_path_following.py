"""Following a path by points ahead on it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pluto_bt.skills.path_following import PathFollowing
from pluto_bt.skills.plan_parameters import PlanParameters

CORNER = np.vstack([np.column_stack((np.arange(0.0, 5.0, 0.1), np.zeros(50))), np.column_stack((np.full(51, 5.0), np.arange(0.0, 5.05, 0.1)))])
BACK = np.vstack([np.column_stack((np.arange(0.0, 5.0, 0.1), np.zeros(50))), np.column_stack((np.arange(5.0, -0.05, -0.1), np.zeros(51)))])


def following(points: np.ndarray, room_m: float = 0.5, **parameters: float) -> PathFollowing:  # type: ignore[type-arg]
    made = PathFollowing(points, lambda p: np.full(len(p), room_m), 0.4, PlanParameters(**parameters))
    made.begin((*points[0], 0.0), 0.0)
    return made


def test_on_the_straight_the_point_lies_as_far_ahead_as_it_may() -> None:
    assert following(CORNER, ahead_m=2.0).step((0.0, 0.0, 0.0), 0.0) == pytest.approx((2.0, 0.0))


@pytest.mark.parametrize(("room_m", "cut_m"), [(0.42, 0.25), (1.0, 0.35), (9.0, 0.7)])
def test_a_corner_is_cut_only_as_far_as_there_is_room(room_m: float, cut_m: float) -> None:
    path = following(CORNER, room_m, ahead_m=2.5)
    x, y, farthest = 0.0, 0.0, 0.0
    for tick in range(400):
        target = path.step((x, y, 0.0), 0.1 * tick)
        away = math.dist((x, y), target)
        if target == path.end and away < 0.1:
            break
        x, y = x + 0.05 * (target[0] - x) / away, y + 0.05 * (target[1] - y) / away
        farthest = max(farthest, min(5.0 - x, y) if y > 0.0 else 0.0)
    assert math.dist((x, y), path.end) < 0.2
    assert farthest < cut_m


CORNERS = [[(0, 0), (5, 0), (5, 5)], [(0, 0), (0, 0), (5, 0), (5, 5), (5, 5)], [(0, 0), (5, 5)], [(0, 0), (0.2, 0)], [(3, 1)]]


@pytest.mark.parametrize("corners", CORNERS)
def test_a_path_of_which_only_the_corners_are_given_is_followed_like_any_other(corners: list[tuple[float, float]]) -> None:
    path = following(np.array(corners, dtype=float))
    x, y = map(float, corners[0])
    for tick in range(400):
        target = path.step((x, y, 0.0), 0.1 * tick)
        away = math.dist((x, y), target)
        if away > 0.0:
            x, y = x + min(0.05, away) * (target[0] - x) / away, y + min(0.05, away) * (target[1] - y) / away
        if math.dist((x, y), path.end) < 0.02:
            break
    assert math.dist((x, y), corners[-1]) < 0.1 and path.left_m < 0.3 and path.stuck_s(0.1 * tick) < 2.0


@pytest.mark.parametrize("turn_deg", [30, 90, 120, 150, 170, 180])
@pytest.mark.parametrize("ahead_m", [1.0, 2.5])
def test_who_is_content_near_each_point_passes_every_sharp_corner(turn_deg: float, ahead_m: float) -> None:
    back = 3.0 * np.array((math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))))
    path = following(np.array([(0.0, 0.0), (4.0, 0.0), (4.0 + back[0], back[1])]), ahead_m=ahead_m)
    x, y, farthest = 0.0, 0.0, 0.0
    for tick in range(600):
        target = path.step((x, y, 0.0), 0.1 * tick)
        away = math.dist((x, y), target)
        if away > (0.05 if target == path.end else 0.3):
            x, y = x + 0.03 * (target[0] - x) / away, y + 0.03 * (target[1] - y) / away
        farthest = max(farthest, x)
    assert math.dist((x, y), path.end) < 0.1
    assert farthest > 3.4


def test_a_path_that_comes_back_by_the_same_way_is_followed_to_its_turn_first() -> None:
    path = following(BACK)
    x, reached = 0.0, 0.0
    for tick in range(300):
        target = path.step((x, 0.0, 0.0), 0.1 * tick)
        x += math.copysign(min(0.05, abs(target[0] - x)), target[0] - x)
        reached = max(reached, x)
    assert reached > 4.6
    assert x == pytest.approx(0.0, abs=0.3)


def test_a_new_path_is_taken_up_where_the_robot_is() -> None:
    path = following(CORNER)
    path.begin((3.02, 0.1, 0.0), 0.0)
    assert path.left_m == pytest.approx(7.0, abs=0.11)
    assert path.off_m((3.02, 0.1, 0.0)) == pytest.approx(0.1, abs=0.01)


def test_who_makes_no_headway_is_stuck_but_not_while_he_waits() -> None:
    path = following(CORNER)
    for tick in range(50):
        path.step((1.0, 0.0, 0.0), 0.1 * tick)
    assert path.stuck_s(5.0) == pytest.approx(5.0, abs=0.2)
    path.wait(5.0)
    assert path.stuck_s(5.0) == 0.0


def test_a_path_of_one_point() -> None:
    path = following(np.array([(1.0, 2.0)]))
    assert path.step((0.0, 0.0, 0.0), 0.0) == (1.0, 2.0) and path.left_m == 0.0 and path.off_m((0.0, 0.0, 0.0)) == -2.0


def test_who_was_pushed_aside_is_led_back_gently() -> None:
    path = following(CORNER, 0.5, ahead_m=2.0)
    x, y = path.step((1.0, 0.6, 0.0), 0.0)
    assert x - 1.0 >= 1.9 and y == 0.0
