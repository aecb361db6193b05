"""The path beside a wall: inside a second ball that rolls along what the first one, which picks the wall, has touched."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.skills.outline import Array
from pluto_bt.skills.rolling import roll

STEP_M = 0.06
STEPS = 240  # at most
BEHIND_M = 0.9  # the ball is let down so far behind the robot …
BEGIN_EVERY = 5  # … or by so many steps of the first ball farther on, where it fits
ASIDE_M = 0.3  # a ball that is pushed farther aside where it begins does not fit between the sides
BENDS_M = 0.35  # points lie as close in bends as on an arc that is so much wider
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
    normals = np.arctan2(rows[:, 1] - rows[:, 3], rows[:, 0] - rows[:, 2])
    last = np.flatnonzero((rows[:, 2] == end[2]) & (rows[:, 3] == end[3]))
    turned = np.remainder(normals[last] - math.atan2(end[1] - end[3], end[0] - end[2]) + math.pi, math.tau) - math.pi
    over = last[turned >= 0.0]
    if not len(over):
        return None  # it never came to the end
    count = max(int(over[0]), 2)  # beyond the last point nothing is known
    rows, normals = rows[:count], normals[:count]
    return None if _leaves_out(rows, first) else _offset(rows, np.unwrap(normals), large_m - distance_m)


def _let_down(chain: Array, first: Array, radius_m: float, large_m: float) -> tuple[float, float] | None:
    """Where the ball fits that touches where the first one does, as far behind the robot as there is room for it."""
    for row in first[: int(BEHIND_M / STEP_M) : BEGIN_EVERY]:
        x_m, y_m = (row[2:] + large_m / radius_m * (row[:2] - row[2:])).tolist()
        rows = roll(chain, x_m, y_m, large_m, STEP_M, 1)
        if len(rows) and math.hypot(rows[0, 0] - x_m, rows[0, 1] - y_m) <= ASIDE_M:
            return x_m, y_m
    return None


def _leaves_out(rows: Array, first: Array) -> bool:
    """True if the ball turns back where the first one goes on to its last point: between two walls that it jams between."""
    asked = first[first[:, 2] != first[-1, 2]][::EVERY]
    apart_x, apart_y = asked[:, :1] - rows[::EVERY, 0], asked[:, 1:2] - rows[::EVERY, 1]
    return bool(((apart_x**2 + apart_y**2).min(axis=1) > LEFT_OUT_M**2).any())


def _offset(rows: Array, normals_rad: Array, inner_m: float) -> Array:
    """The path `inner_m` from the ball's middle towards where it touches; where it stops and touches anew, an arc around its middle."""
    steps = np.maximum(1, np.ceil(np.abs(np.diff(normals_rad)) * (inner_m + BENDS_M) / STEP_M)).astype(np.intp)
    which = np.repeat(np.arange(len(steps)), steps)
    share = (np.arange(len(which)) - np.repeat(np.cumsum(steps) - steps, steps)) / steps[which]
    normal = normals_rad[which] + share * np.diff(normals_rad)[which]
    middle = rows[which, :2] + share[:, None] * np.diff(rows[:, :2], axis=0)[which]
    path = np.zeros((len(which), 5))
    path[:, 0], path[:, 1] = middle[:, 0] - inner_m * np.cos(normal), middle[:, 1] - inner_m * np.sin(normal)
    path[:, 2] = normal + 0.5 * math.pi
    path[:, 3:] = rows[which, 2:]
    return path
