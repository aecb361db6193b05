"""The path beside a wall: inside a second ball that rolls along what the first one, which picks the wall, has touched."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills.outline import Array
from pluto_bt.skills.rolling import roll

STEP_M = 0.06
STEPS = 240  # at most
BEHIND_M = 0.9  # the ball is let down so far behind the robot …
BEGIN_EVERY = 5  # … or by so many steps of the first ball farther on, where it fits
ASIDE_M = 0.3  # a ball that is pushed farther aside where it begins does not fit between the sides
BENDS_M = 0.35  # points lie as close in bends as on an arc that is so much wider
X, Y, TOUCHED_X, TOUCHED_Y = range(4)  # columns of what `roll` gives
NORMAL = 2  # column of a path
EVERY, LEFT_OUT_M = 4, 1.5  # a place of the first ball that the second one comes no nearer to is left out; so many steps are compared at once


def inside(chain: Array, first: Array, radius_m: float, large_m: float, distance_m: float) -> Array | None:
    """The path (n, 5) x, y, heading, touched x, y; None if the ball does not roll along the whole wall.

    Args:
        chain: (m, 2) what the first ball touches.
        first: (k, 4) how that one rolls: middle x, y, touched x, y. radius_m: its size.
        large_m: radius of the second ball.
        distance_m: of the path from where the second ball touches.
    """
    start, end = _let_down(chain, first, radius_m, large_m), first[-1]
    if start is None or len(rows := roll(chain, *start, large_m, STEP_M, STEPS)) < STEPS:
        return None
    normals_rad = np.arctan2(rows[:, 1] - rows[:, 3], rows[:, 0] - rows[:, 2])
    path = along(rows, normals_rad, first, math.atan2(end[1] - end[3], end[0] - end[2]), large_m - distance_m)
    if not len(path):
        return None
    normals_rad = path[:, NORMAL].copy()
    path[:, X] -= (large_m - distance_m) * np.cos(normals_rad)
    path[:, Y] -= (large_m - distance_m) * np.sin(normals_rad)
    path[:, NORMAL] += 0.5 * math.pi
    return path


def warm() -> None:
    """Use the kernel once, so that no later use waits for its compilation."""
    along(np.zeros((2, 4)), np.zeros(2), np.zeros((1, 4)), 0.0, 0.0)


def _let_down(chain: Array, first: Array, radius_m: float, large_m: float) -> tuple[float, float] | None:
    """Where the ball fits that touches where the first one does, as far behind the robot as there is room for it."""
    for row in first[: int(BEHIND_M / STEP_M) : BEGIN_EVERY]:
        x_m, y_m = (row[2:] + large_m / radius_m * (row[:2] - row[2:])).tolist()
        rows = roll(chain, x_m, y_m, large_m, STEP_M, 1)
        if len(rows) and math.hypot(rows[0, 0] - x_m, rows[0, 1] - y_m) <= ASIDE_M:
            return x_m, y_m
    return None


@kernel
def along(rows: Array, normals_rad: Array, first: Array, end_rad: float, inner_m: float) -> Array:
    """Where the second ball is on its way to the end of the first one, so closely that a path `inner_m` from its middle has no gaps.

    Args:
        rows, first: (n, 4), (k, 4) how the balls roll, as `roll` gives them.
        normals_rad: (n,) direction from what the second ball touches to its middle. end_rad: the same of the first ball at its end.
    Returns: (m, 5) middle x, y, normal (not wrapped), touched x, y; where the ball stops and touches anew its normal turns in small steps.
        None of them if the ball never comes to the end, or leaves something out.
    """
    count = way_to(rows, normals_rad, first[-1, TOUCHED_X], first[-1, TOUCHED_Y], end_rad)
    if count == 0 or leaves_out(rows, count, first):
        return np.zeros((0, 5))
    steps, turned_rad, total = np.ones(count, dtype=np.intp), np.zeros(count), 0
    for k in range(1, count):
        turned_rad[k] = turned_rad[k - 1] + leap_rad(normals_rad[k] - normals_rad[k - 1])
        turn_rad = abs((normals_rad[k] + turned_rad[k]) - (normals_rad[k - 1] + turned_rad[k - 1]))
        steps[k] = max(1, math.ceil(turn_rad * (inner_m + BENDS_M) / STEP_M))
        total += steps[k]
    path, at = np.zeros((total, 5)), 0
    for k in range(1, count):
        x, y, normal_rad = rows[k - 1, X], rows[k - 1, Y], normals_rad[k - 1] + turned_rad[k - 1]
        for step in range(steps[k]):
            share = step / steps[k]
            path[at, X], path[at, Y] = x + share * (rows[k, X] - x), y + share * (rows[k, Y] - y)
            path[at, NORMAL] = normal_rad + share * ((normals_rad[k] + turned_rad[k]) - normal_rad)
            path[at, 3], path[at, 4], at = rows[k - 1, TOUCHED_X], rows[k - 1, TOUCHED_Y], at + 1
    return path


@inline_kernel
def way_to(rows: Array, normals_rad: Array, end_x: float, end_y: float, end_rad: float) -> int:
    """How many rows there are up to where the ball touches the end and has turned as far as the first one; beyond that nothing is known."""
    for k in range(rows.shape[0]):
        is_at_end = rows[k, TOUCHED_X] == end_x and rows[k, TOUCHED_Y] == end_y
        if is_at_end and (normals_rad[k] - end_rad + math.pi) % math.tau - math.pi >= 0.0:
            return max(k, 2)
    return 0


@inline_kernel
def leaves_out(rows: Array, count: int, first: Array) -> bool:
    """True if the ball turns back where the first one goes on to its last point: between two walls that it jams between."""
    asked = 0
    for i in range(first.shape[0]):
        if first[i, TOUCHED_X] == first[-1, TOUCHED_X]:
            continue
        if asked % EVERY == 0:
            least = math.inf
            for k in range(0, count, EVERY):
                dx, dy = first[i, X] - rows[k, X], first[i, Y] - rows[k, Y]
                least = min(least, dx * dx + dy * dy)
            if least > LEFT_OUT_M**2:
                return True
        asked += 1
    return False


@inline_kernel
def leap_rad(turn_rad: float) -> float:
    """What must be added to all angles after a turn that is more than half a circle, for the shorter way round to be meant."""
    if abs(turn_rad) < math.pi:
        return 0.0
    shorter_rad = (turn_rad + math.pi) % math.tau - math.pi
    return (math.pi if shorter_rad == -math.pi and turn_rad > 0.0 else shorter_rad) - turn_rad
