"""The way beside a wall, wall on the left: what counts as wall, and a smooth path at a distance from it.

Two balls roll along the wall. The first, as wide as the narrowest opening that is entered, says what the wall is: doors and gaps that it does
not fit into are passed by, posts that stand near belong to the wall. The second rolls along what the first has touched. It is larger than the
distance to keep, so that it rounds off inner corners, and the path runs inside it at that distance from where it touches: arcs of the
distance around outer corners, arcs of the fillet in inner ones. Where there is no room for that it shrinks, down to the first ball.
Where the camera would be left too far from everything, the path leads into the pocket and around there (`pocket.py`).

All is in the robot frame, metres and radians; for a wall on the right the caller mirrors points and path.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pluto_bt.skills import pocket, second_ball, wall_kernels
from pluto_bt.skills.outline import Array
from pluto_bt.skills.pocket import Pocket, Visit, visited
from pluto_bt.skills.rolling import roll
from pluto_bt.skills.second_ball import ASIDE_M, BEHIND_M, STEP_M, inside
from pluto_bt.skills.turning_place import Room
from pluto_bt.skills.wall_kernels import keeps_away, nearest_of

AHEAD_M = 3.0  # so far before the robot the path must be free
STEPS = 120  # of the first ball
ENOUGH_M = 1.5  # a path that ends earlier is none
GROWTH = 1.15  # of a ball that has found more room, from step to step
LATER_M_PER_M = 0.1
SLACK = 1.06  # a ball that has not so much more room would jam
HALVINGS = 5
AT_PATH_M = 0.3  # a robot that is farther away looks for no pocket
LEFT_RAD = (math.radians(-10.0), math.pi)  # where a wall on the left is looked for first


class Ball(NamedTuple):
    """A ball at rest on the wall."""

    x_m: float
    y_m: float
    touched_x_m: float
    touched_y_m: float
    radius_m: float


class Wish(NamedTuple):
    """What the path should be.

    Attributes:
        distance_m: of the robot's middle from the wall.
        camera_m: x, y where the camera is held in the robot frame, and its distance from the wall.
        fillet_m: radius of the path in inner corners.
        opening_m: narrower openings are passed by.
        least_m: nearer than this the robot's middle may come to nothing.
        turn_m: so far from everything it can turn on the spot.
    """

    distance_m: float
    camera_m: tuple[float, float, float]
    fillet_m: float
    opening_m: float
    least_m: float
    turn_m: float


class WallPath(NamedTuple):
    """What is followed.

    Attributes:
        points: (n, 3) x, y, heading, from behind the robot on or from it.
        foot: the point where the robot is.
        distance_m: that the path really keeps.
        ball: where the next one begins.
        turn: the point where the robot turns on the spot, in a pocket; 0 = nowhere, or there it is already.
        pocket: the one that the robot is in or comes to.
    """

    points: Array
    foot: int
    distance_m: float
    ball: Ball
    turn: int
    pocket: Pocket | None

    @property
    def off_m(self) -> float:
        """How far the robot is from the path."""
        return math.hypot(*self.points[self.foot, :2])

    def turned(self) -> WallPath:
        """The rest of the path, when the robot has come to where it turns."""
        pocket = self.pocket._replace(is_turned=True) if self.pocket is not None else None
        return self._replace(points=self.points[self.turn :], foot=0, turn=0, pocket=pocket)


def warm() -> None:
    """Use the kernel once, so that no later use waits for its compilation."""
    roll(np.zeros((1, 2)), 0.0, 1.0, 1.0, STEP_M, 1)
    second_ball.warm()
    pocket.warm()
    wall_kernels.warm()


def find_wall(points: Array, wish: Wish) -> Ball | None:
    """A ball at rest on the nearest thing, on the left if there is one; None where nothing stands or the ball has no room."""
    if not len(points):
        return None
    bearings, away = np.arctan2(points[:, 1], points[:, 0]), np.hypot(points[:, 0], points[:, 1])
    is_left = (bearings > LEFT_RAD[0]) & (bearings < LEFT_RAD[1])
    nearest = int(np.argmin(np.where(is_left, away, np.inf) if is_left.any() else away))
    x, y, away_m = float(points[nearest, 0]), float(points[nearest, 1]), float(away[nearest])
    most_m, radius_m = 0.5 * wish.opening_m, min(0.5 * wish.opening_m, 0.4 * away_m)
    ball: Ball | None = Ball(x * (1.0 - radius_m / away_m), y * (1.0 - radius_m / away_m), x, y, radius_m)
    found = None
    while ball is not None and (found is None or found.radius_m < most_m):
        found = ball
        ball = _seated(points, ball, min(most_m, GROWTH * ball.radius_m))
    return found if found is not None and found.radius_m >= wish.least_m else None


def plan(points: Array, ball: Ball, wish: Wish, last: Pocket | None = None) -> WallPath | None:
    """The path along the wall on which the ball of the step before rests; None if no ball finds room there. `last`: its pocket."""
    rolled = _rolled(points, ball, wish)
    if rolled is None:
        return None
    ball, rows = rolled
    path, distance_m = _widest(points, rows, ball.radius_m, wish)
    if path is None:
        return None
    foot = foot_of(path)
    visit = Visit(path, 0, None)
    if last is not None or math.hypot(*path[foot, :2]) < AT_PATH_M:
        visit = visited(path, foot, points, Room(wish.camera_m, wish.least_m, wish.turn_m), last)
    foot = foot_of(visit.path[: visit.turn + 1] if visit.turn else visit.path)
    next_ball = _next_ball(rows, visit.path[foot, 3:], ball.radius_m)
    return WallPath(np.ascontiguousarray(visit.path[:, :3]), foot, distance_m, next_ball, visit.turn, visit.pocket)


def _widest(points: Array, rows: Array, radius_m: float, wish: Wish) -> tuple[Array | None, float]:
    """The path inside the largest second ball for which there is room, up to the full size; and the distance that it keeps."""
    chain = _without_doubles(rows[:, 2:])
    full_m = max(wish.distance_m + wish.fillet_m, radius_m)
    low_m, high_m, best = radius_m, full_m, None
    for halving in range(HALVINGS + 1):
        large_m = full_m if halving == 0 else 0.5 * (low_m + high_m)
        path = inside(chain, rows, radius_m, large_m, min(wish.distance_m, large_m))
        if path is not None and len(path) - foot_of(path) > ENOUGH_M / STEP_M and _is_clear(path, points, wish.least_m):
            low_m, best = large_m, path
            if halving == 0:
                break
        else:
            high_m = large_m
    if best is None:
        best = inside(chain, rows, radius_m, radius_m, min(wish.distance_m, radius_m))
    return best, min(wish.distance_m, low_m)


def _rolled(points: Array, ball: Ball, wish: Wish) -> tuple[Ball, Array] | None:
    """The first ball, as large as it may be and has room for, and how it rolls; None if even one as wide as the robot does not fit."""
    radius_m = min(0.5 * wish.opening_m, GROWTH * ball.radius_m)
    while radius_m >= wish.least_m:
        if _seated(points, ball, SLACK * radius_m) is not None and (seated := _seated(points, ball, radius_m)) is not None:
            return seated, roll(points, seated.x_m, seated.y_m, radius_m, STEP_M, STEPS)
        radius_m /= GROWTH
    return None


def _seated(points: Array, ball: Ball, radius_m: float) -> Ball | None:
    """A ball of another size let down where `ball` touches the wall; None if it does not fit there."""
    dx, dy = ball.x_m - ball.touched_x_m, ball.y_m - ball.touched_y_m
    share = radius_m / max(math.hypot(dx, dy), 1e-6)
    x_m, y_m = ball.touched_x_m + share * dx, ball.touched_y_m + share * dy
    rows = roll(points, x_m, y_m, radius_m, STEP_M, 1)
    return None if not len(rows) or math.hypot(rows[0, 0] - x_m, rows[0, 1] - y_m) > ASIDE_M else _ball(rows[0], radius_m)


def _ball(row: Array, radius_m: float) -> Ball:
    x, y, touched_x, touched_y = row.tolist()
    return Ball(x, y, touched_x, touched_y, radius_m)


def foot_of(path: Array) -> int:
    """The point of a path that is nearest to the robot; of two that are equally near, the one that comes first."""
    return nearest_of(path, LATER_M_PER_M * STEP_M)


def _is_clear(path: Array, points: Array, least_m: float) -> bool:
    """True if nothing stands nearer to the next metres of the path than the robot needs."""
    foot = foot_of(path)
    return keeps_away(path, foot, foot + int(AHEAD_M / STEP_M), 3, points, least_m)


def _next_ball(rows: Array, touched: Array, radius_m: float) -> Ball:
    """Where the first ball begins in the next step: some way behind the robot's place at the wall."""
    beside = int(np.argmin(np.hypot(rows[:, 2] - touched[0], rows[:, 3] - touched[1])))
    return _ball(rows[max(0, beside - int(BEHIND_M / STEP_M))], radius_m)


def _without_doubles(points: Array) -> Array:
    """Points that follow each other, each once."""
    is_new = np.ones(len(points), dtype=bool)
    is_new[1:] = np.any(points[1:] != points[:-1], axis=1)
    return np.ascontiguousarray(points[is_new])
