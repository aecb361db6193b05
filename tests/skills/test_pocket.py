"""Pockets: where there is one, that the way by it leaves the camera less far off, and how it is kept until the robot is out of it."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.pocket import STEP_M, Pocket, Visit, visited
from pluto_bt.skills.turning_place import Room
from pluto_bt.skills.wall_path import Ball, Wish, plan

CAMERA = (-0.45, 0.65, 0.8)
ROOM = Room(CAMERA, 0.545, 0.84)
WISH = Wish(1.45, CAMERA, 0.1, 2.4, ROOM.least_m, ROOM.turn_m)


def wall(*corners: tuple[float, float]) -> Array:
    """Points 3 cm apart along a line through corners."""
    pieces = [np.linspace(a, b, int(math.dist(a, b) / 0.03) + 2) for a, b in itertools.pairwise(corners)]
    return np.vstack(pieces)


CORNER = wall((-4.0, 1.45), (3.8, 1.45), (3.8, -6.0))  # the robot comes along x, the wall on its left, and turns to the right
POST = np.column_stack((1.6 + 0.2 * np.cos(np.arange(0.0, math.tau, 0.1)), 1.1 + 0.2 * np.sin(np.arange(0.0, math.tau, 0.1))))
PASSED_POST = np.vstack((CORNER, POST))


def path_beside(points: Array) -> Array:
    """(n, 5) the path from the robot on, before any way by a pocket."""
    paths: list[Array] = []

    def spy(path: Array, foot: int, *_: object) -> Visit:
        paths.append(path[foot:])
        return Visit(path, 0, None)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("pluto_bt.skills.wall_path.visited", spy)
        assert plan(points, Ball(-0.9, 0.25, -0.9, 1.45, 1.2), WISH) is not None
    return paths[0]


def seen(robot: Planar, points: Array) -> Array:
    """Points (n, 2) in the frame of a robot."""
    c, s = math.cos(robot[2]), math.sin(robot[2])
    return np.asarray((points - robot[:2]) @ np.array([[c, -s], [s, c]]))


def visit_from(robot: Planar, path: Array, points: Array, last: Pocket | None, room: Room = ROOM) -> Visit:
    """What a robot at a place finds that has come from the origin; `last` is seen from the origin."""
    moved = np.column_stack((seen(robot, path[:, :2]), path[:, 2] - robot[2], path[:, 3:]))
    foot = int(np.argmin(np.hypot(moved[:, 0], moved[:, 1])))
    return visited(moved, foot, seen(robot, points), room, None if last is None else last.seen_from((0.0, 0.0, 0.0), robot))


def halfway(path: Array) -> Planar:
    """The robot where the path has come around the post."""
    x, y, heading = path[int(np.argmin(np.abs(path[:, 0] - 1.6))), :3].tolist()
    return x, y, heading


def off_m(path: Array, points: Array) -> Array:
    """How far off the camera is along the path, wherever the robot turns on the spot too."""
    x_m, y_m, away_m = CAMERA
    off = []
    for before, here in itertools.pairwise(path[:, :3]):
        turn = (here[2] - before[2] + math.pi) % math.tau - math.pi
        for heading in before[2] + turn * np.linspace(0.0, 1.0, 2 + int(abs(turn) / 0.1)):
            c, s = math.cos(heading), math.sin(heading)
            off.append(np.hypot(*(points - (before[0] + c * x_m - s * y_m, before[1] + s * x_m + c * y_m)).T).min() - away_m)
    return np.array(off)


def test_along_a_straight_wall_and_in_a_plain_corner_there_is_no_pocket() -> None:
    for points in (wall((-4.0, 1.45), (9.0, 1.45)), CORNER):
        path = path_beside(points)
        for x, y, heading in path[:60:5, :3].tolist():
            visit = visit_from((x, y, heading), path, points, None)
            assert visit.pocket is None and len(visit.path) == len(path)


def test_between_a_post_and_a_corner_the_robot_drives_in_turns_and_comes_back() -> None:
    path = path_beside(PASSED_POST)
    robot = halfway(path)
    visit = visit_from(robot, path, PASSED_POST, None)
    assert visit.pocket is not None and not visit.pocket.is_turned
    at_origin = visit.pocket.seen_from(robot, (0.0, 0.0, 0.0))
    assert visit.path[visit.turn, :2] == pytest.approx((visit.pocket.x_m, visit.pocket.y_m))
    assert np.hypot(*(path[:, :2] - at_origin[2:4]).T).min() > 0.1, "off the path"
    assert np.hypot(*(PASSED_POST - at_origin[2:4]).T).min() > ROOM.turn_m - 0.05, "with room to turn"
    assert np.hypot(*np.diff(visit.path[:, :2], axis=0).T).max() < 1.5 * STEP_M
    stands = seen(robot, PASSED_POST)
    begin = int(np.argmin(np.hypot(*(path[:, :2] - robot[:2]).T)))
    straight, by_pocket = off_m(path[begin : begin + 80], PASSED_POST), off_m(visit.path[:90], stands)
    assert straight.max() > 0.3 and np.abs(by_pocket).max() < straight.max() - 0.05


def test_a_robot_that_cannot_turn_on_the_spot_visits_no_pocket() -> None:
    path = path_beside(PASSED_POST)
    assert visit_from(halfway(path), path, PASSED_POST, None, ROOM._replace(turn_m=math.inf)).pocket is None


def test_a_pocket_is_kept_until_the_robot_has_turned_and_is_back() -> None:
    path = path_beside(PASSED_POST)
    robot = halfway(path)
    found = visit_from(robot, path, PASSED_POST, None).pocket
    assert found is not None
    pocket = found.seen_from(robot, (0.0, 0.0, 0.0))
    close = visit_from((pocket.x_m - 0.3, pocket.y_m, 0.1), path, PASSED_POST, pocket)
    assert close.pocket is not None and close.turn > 0
    assert math.hypot(close.pocket.x_m, close.pocket.y_m) == pytest.approx(0.3, abs=0.01), "so near it is not changed any more"
    turned = pocket._replace(is_turned=True)
    out = visit_from((pocket.x_m, pocket.y_m, -1.0), path, PASSED_POST, turned)
    assert out.pocket is not None and out.turn == 0
    assert out.path[0, :2] == pytest.approx((0.0, 0.0)), "from where it is"
    beyond = path[int(np.argmin(np.hypot(*(path[:, :2] - pocket[:2]).T))) + 30, :3].tolist()
    assert visit_from((beyond[0], beyond[1], beyond[2]), path, PASSED_POST, turned).pocket is None, "back on its path beyond the corner"


def test_a_corner_that_is_not_there_any_more_is_forgotten() -> None:
    path = path_beside(CORNER)
    assert visit_from((0.0, 0.0, 0.0), path, CORNER, Pocket(0.5, 3.0, 0.6, 3.2, False)).pocket is None
