"""The way beside a wall, wall on the left: what counts as wall, and a smooth path at a distance from it.

Two balls roll along the wall. The first, as wide as the narrowest opening that is entered, says what the wall is: doors and gaps that it does
not fit into are passed by, posts that stand near belong to the wall. The second rolls along what the first has touched. It is larger than the
distance to keep, so that it rounds off inner corners, and the path runs inside it at that distance from where it touches: arcs of the
distance around outer corners, arcs of the fillet in inner ones. Where there is no room for that it shrinks, down to the first ball.
Where the camera would be left too far from everything, or come too near, the path leans (`camera_lean.py`).

All is in the robot frame, metres and radians; for a wall on the right the caller mirrors points and path.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pluto_bt.skills import wall_kernels
from pluto_bt.skills.camera_lean import leaned
from pluto_bt.skills.outline import Array
from pluto_bt.skills.rolling import roll
from pluto_bt.skills.wall_kernels import keeps_away, nearest_of

STEP_M = 0.06
BEHIND_M = 0.9  # the first ball begins so far behind the robot …
AHEAD_M = 3.0  # … and rolls on so far before it
STEPS = 120
ENOUGH_M = 1.5  # a path that ends earlier is none …
ASIDE_M = 0.3  # a ball that is pushed farther aside where it begins does not fit between the sides
GROWTH = 1.15  # of a ball that has found more room, from step to step
LATER_M_PER_M = 0.1
SLACK = 1.06  # a ball that has not so much more room would jam
HALVINGS = 5
LEAN_M = 0.35  # so far at most the path leans to the wall
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
    """

    distance_m: float
    camera_m: tuple[float, float, float]
    fillet_m: float
    opening_m: float
    least_m: float


class WallPath(NamedTuple):
    """Points (n, 3) x, y, heading of the path, from behind the robot on; the distance that it really keeps; where the next ball begins."""

    points: Array
    foot: int
    distance_m: float
    ball: Ball

    @property
    def off_m(self) -> float:
        """How far the robot is from the path."""
        return math.hypot(*self.points[self.foot, :2])


def warm() -> None:
    """Use the kernel once, so that no later use waits for its compilation."""
    roll(np.zeros((1, 2)), 0.0, 1.0, 1.0, STEP_M, 1)
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


def plan(points: Array, ball: Ball, wish: Wish) -> WallPath | None:
    """The path along the wall on which the ball of the step before rests; None if no ball finds room there."""
    rolled = _rolled(points, ball, wish)
    if rolled is None:
        return None
    ball, rows = rolled
    chain = _without_doubles(rows[:, 2:])
    end = rows[-1]
    low, high, best = 0.0, 1.0, None
    for halving in range(HALVINGS + 1):
        share = 1.0 if halving == 0 else 0.5 * (low + high)
        path = _inside(chain, rows[0], end, ball.radius_m, share, wish)
        if path is not None and len(path) - foot_of(path) > ENOUGH_M / STEP_M and _is_clear(path, points, wish.least_m):
            low, best = share, path
            if halving == 0:
                break
        else:
            high = share
    path = best if best is not None else _inside(chain, rows[0], end, ball.radius_m, 0.0, wish)
    if path is None:
        return None
    path = _leaning(path, points, wish)
    foot = foot_of(path)
    distance_m = min(wish.distance_m, ball.radius_m + low * (_full_m(ball.radius_m, wish) - ball.radius_m))
    return WallPath(np.ascontiguousarray(path[:, :3]), foot, distance_m, _next_ball(rows, path[foot, 3:], ball.radius_m))


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


def _full_m(radius_m: float, wish: Wish) -> float:
    """Radius of the second ball where nothing is in its way."""
    return max(wish.distance_m + wish.fillet_m, radius_m)


def _inside(chain: Array, first: Array, end: Array, radius_m: float, share: float, wish: Wish) -> Array | None:
    """The path (n, 5) x, y, heading, touched x, y inside a second ball that is `share` of the way from the first one to its full size."""
    large_m = radius_m + share * (_full_m(radius_m, wish) - radius_m)
    distance_m = min(wish.distance_m, large_m)
    nx, ny = (first[0] - first[2]) / radius_m, (first[1] - first[3]) / radius_m
    x_m, y_m = float(first[2] + large_m * nx), float(first[3] + large_m * ny)
    rows = roll(chain, x_m, y_m, large_m, STEP_M, 2 * STEPS)
    if len(rows) < 2 * STEPS or math.hypot(rows[0, 0] - x_m, rows[0, 1] - y_m) > ASIDE_M:
        return None
    normals = np.arctan2(rows[:, 1] - rows[:, 3], rows[:, 0] - rows[:, 2])
    last = np.flatnonzero((rows[:, 2] == end[2]) & (rows[:, 3] == end[3]))
    turned = np.remainder(normals[last] - math.atan2(end[1] - end[3], end[0] - end[2]) + math.pi, math.tau) - math.pi
    over = last[turned >= 0.0]
    if not len(over):
        return None  # it never came to the end
    count = max(int(over[0]), 2)  # beyond the last point nothing is known
    rows, normals = rows[:count], normals[:count]
    return _offset(rows, np.unwrap(normals), large_m - distance_m)


def _offset(rows: Array, normals_rad: Array, inner_m: float) -> Array:
    """The path `inner_m` from the ball's middle towards where it touches; where it stops and touches anew, an arc around its middle."""
    steps = np.maximum(1, np.ceil(np.abs(np.diff(normals_rad)) * (inner_m + LEAN_M) / STEP_M)).astype(np.intp)
    which = np.repeat(np.arange(len(steps)), steps)
    share = (np.arange(len(which)) - np.repeat(np.cumsum(steps) - steps, steps)) / steps[which]
    normal = normals_rad[which] + share * np.diff(normals_rad)[which]
    middle = rows[which, :2] + share[:, None] * np.diff(rows[:, :2], axis=0)[which]
    path = np.zeros((len(which), 5))
    path[:, 0], path[:, 1] = middle[:, 0] - inner_m * np.cos(normal), middle[:, 1] - inner_m * np.sin(normal)
    path[:, 2] = normal + 0.5 * math.pi
    path[:, 3:] = rows[which, 2:]
    return path


def _leaning(path: Array, points: Array, wish: Wish) -> Array:
    """The path, leaning such that the camera keeps its distance, where there is room for that."""
    limits_m = -0.5 * wish.fillet_m, max(0.0, min(LEAN_M, wish.distance_m - wish.least_m))
    lean = leaned(path, foot_of(path), points, wish.camera_m, limits_m)
    return lean if lean is path or _is_clear(lean, points, wish.least_m) else path


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
