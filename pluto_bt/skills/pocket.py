"""Pockets: inner corners at which the camera, which swings behind the robot as it turns, would be left too far from everything.

A path at a distance from the wall turns where the ball touches two walls at once. In a plain corner that is right. Between a post and a corner,
or before a gap, the wall lies deeper there: so the robot leaves its path, drives in, turns on the spot and comes back to its path.

A pocket is kept from step to step, until the robot has turned there and is back, for the ways in and out may lie close by one another.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pluto_bt.skills import turning_place
from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.turning_place import Ground, Room, way_in, way_out
from pluto_bt.skills.wall_kernels import camera_off, seen_from

TOO_FAR_M = 0.2  # a camera that would be so much too far makes a pocket
SEEN_M = 2.2  # so far ahead on the path pockets are looked for …
BACK_M = 1.5  # … and so far beyond one the robot comes back to the path
AT_PATH_M, GONE_M = 0.1, 0.6  # a robot that has turned is out of the pocket when it is so near to its path, and so far beyond the corner
SAME_M = 0.5  # so far the corner of a pocket may move from step to step
STEP_M = 0.06  # between points of the path


class Pocket(NamedTuple):
    """In the robot frame: the corner of the path, the place to turn at, and whether the robot has turned there."""

    corner_x_m: float
    corner_y_m: float
    x_m: float
    y_m: float
    is_turned: bool

    def seen_from(self, before: Planar, now: Planar) -> Pocket:
        """The pocket given in the frame `before`, in that of now."""
        places = seen_from(np.array([[self.corner_x_m, self.corner_y_m, 0.0], [self.x_m, self.y_m, 0.0]]), before, now)
        (corner_x, corner_y), (x, y) = places[:, :2].tolist()
        return Pocket(corner_x, corner_y, x, y, self.is_turned)


class Visit(NamedTuple):
    """A path (n, 3 or more) by way of a pocket, its row at the place to turn at, 0 if there is none ahead; without a pocket the path as it was."""

    path: Array
    turn: int
    pocket: Pocket | None


def warm() -> None:
    """Use the kernels once, so that no later use waits for their compilation."""
    camera_off(np.zeros((1, 5)), 0, 1, np.zeros((1, 2)), 0.0, 0.0, 0.0)
    turning_place.warm()


def visited(path: Array, foot: int, points: Array, room: Room, last: Pocket | None) -> Visit:
    """The path by way of the next pocket on it.

    Args:
        path: (n, 5) x, y, heading, touched x, y.
        foot: its row where the robot is.
        points: (m, 2) what stands.
        last: the pocket of the step before, seen from here. Where the path has no such corner any more, it is forgotten.
    """
    if last is not None:
        corner = int(np.argmin(np.hypot(path[:, 0] - last.corner_x_m, path[:, 1] - last.corner_y_m)))
        is_there = math.hypot(path[corner, 0] - last.corner_x_m, path[corner, 1] - last.corner_y_m) < SAME_M
        if last.is_turned:
            is_back = foot > (corner + GONE_M / STEP_M if is_there else 0) and math.hypot(*path[foot, :2]) < AT_PATH_M
            return Visit(path, 0, None) if is_back else _back(path, corner if is_there else foot, points, room, last)
        if is_there:
            return _by_way_of(path, min(foot, corner), corner, points, room, last)
    off_m = camera_off(path, foot, foot + int(SEEN_M / STEP_M), points, *room.camera_m)
    is_far = np.append(off_m > TOO_FAR_M, False)
    if not is_far.any():
        return Visit(path, 0, None)
    first = int(np.argmax(is_far))
    until = first + int(np.argmin(is_far[first:]))
    return _by_way_of(path, foot, foot + first + int(np.argmax(off_m[first:until])), points, room, None)


def _by_way_of(path: Array, foot: int, corner: int, points: Array, room: Room, last: Pocket | None) -> Visit:
    """The path with a turn in the pocket at a row of it."""
    ground = Ground.around(path[foot : _beyond(path, corner)], path[corner], points, room)
    turn = way_in(ground, path[corner], corner - foot, None if last is None else (last.x_m, last.y_m))
    if turn is None:
        return Visit(path, 0, None)
    before = path[foot : foot + turn.leave + 1] if turn.leave >= 0 else _at_robot(path[corner])
    there, beyond = _leg(before[-1], turn.x_m, turn.y_m), path[foot + turn.join :]
    back = _leg(np.array([turn.x_m, turn.y_m, 0.0, *beyond[0, 3:]]), *beyond[0, :2].tolist())
    pocket = Pocket(float(path[corner, 0]), float(path[corner, 1]), turn.x_m, turn.y_m, False)
    return Visit(np.vstack((before, there, back, beyond)), len(before) + len(there) - 1, pocket)


def _back(path: Array, corner: int, points: Array, room: Room, pocket: Pocket) -> Visit:
    """From the robot, which has turned in the pocket, back to the path."""
    turn = way_out(Ground.around(path[corner : _beyond(path, corner)], path[corner], points, room))
    if turn is None:
        return Visit(path, 0, pocket)
    start, beyond = _at_robot(path[corner]), path[corner + turn.join :]
    return Visit(np.vstack((start, _leg(start[0], *beyond[0, :2].tolist()), beyond)), 0, pocket)


def _beyond(path: Array, corner: int) -> int:
    """One after the last row of the path to which the robot may come back from a pocket."""
    way_m = np.cumsum(np.hypot(*np.diff(path[corner:, :2], axis=0).T))
    return corner + 1 + int(np.searchsorted(way_m, BACK_M))


def _at_robot(beside: Array) -> Array:
    """(1, n) a row of a path at the robot, with what is touched beside it."""
    return np.array([[0.0, 0.0, 0.0, *beside[3:]]])


def _leg(start: Array, x_m: float, y_m: float) -> Array:
    """Rows on a straight way, without its start and with its end."""
    dx, dy = x_m - start[0], y_m - start[1]
    count = 1 + int(math.hypot(dx, dy) / STEP_M)
    share = np.arange(1, count + 1)[:, None] / count
    out = np.repeat(start[None, :], count, axis=0)
    out[:, :2] = start[:2] + share * (dx, dy)
    out[:, 2] = math.atan2(dy, dx)
    return out
