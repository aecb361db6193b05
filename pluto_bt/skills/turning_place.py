"""The place at which a robot should turn in a pocket: of a coarse net of places the best one, then the best of those around it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pluto_bt.skills.near_field import CELL_M, near_field
from pluto_bt.skills.outline import Array
from pluto_bt.skills.turn_search import path_cost, search

DEEP_M, WIDE_M, APART_M = 1.2, 0.6, 0.2  # the net: from the corner on towards the wall and to both sides
FINE_M = 0.07  # between places around the best of those
WORTH = 0.7  # a turning place must cost at most so much of what the path costs …
BETTER = 0.7  # … and another one so much of what the one before costs
FINER = 1.5  # so much more a place of the net may cost, for those around it may cost less
NOISE_M = 0.08  # a place that was chosen may have so much less room, for what is seen varies
SURE_M = 0.6  # a place that is so near is not changed any more
CARES_M = 0.7  # a camera that is farther off than that is as bad as can be


class Room(NamedTuple):
    """x m, y m of the camera in the robot frame and its distance; how near the robot's middle may come on its way, and where it turns."""

    camera_m: tuple[float, float, float]
    least_m: float
    turn_m: float


class Turn(NamedTuple):
    """A place, the rows of the path where the robot leaves it and comes back to it (-1 = it leaves where it is), and what that costs."""

    x_m: float
    y_m: float
    leave: int
    join: int
    cost: float


class Ground(NamedTuple):
    """What a search asks: path (n, 3) and field, from the middle of the field's first cell on, which is `low_m` from the robot."""

    low_m: Array
    path: Array
    field: Array
    room: Room

    @classmethod
    def around(cls, path: Array, at: Array, points: Array, room: Room) -> Ground:
        """The ground of a pocket at a row of the path: all places where the robot may be."""
        reach_m = room.camera_m[2] + math.hypot(*room.camera_m[:2])
        places = np.vstack((path[:, :2], _net(at), np.zeros((1, 2))))
        low = places.min(axis=0) - reach_m
        rows, columns = (2 + ((places.max(axis=0) + reach_m - low) / CELL_M).astype(np.intp)).tolist()
        field = near_field(points[:, :2] - low, rows, columns, room.camera_m[2] + CARES_M)
        return cls(low, path[:, :3] - (*low, 0.0), field, room)

    def best(self, places: Array, corner: int, turn_m: float, most: float = math.inf) -> Turn | None:
        """The best of places (m, 2) in the robot frame for a pocket at a row of the path; None where there is no room, or all cost `most`."""
        camera, least_m = np.array(self.room.camera_m), self.room.least_m - CELL_M
        place, leave, join, cost = search(self._robot, self.path, corner, places - self.low_m, self.field, camera, least_m, turn_m, most)
        return Turn(float(places[place, 0]), float(places[place, 1]), leave, join, cost) if place >= 0 else None

    def path_cost(self) -> float:
        """What the path costs as it is."""
        return path_cost(self._robot, self.path, self.field, np.array(self.room.camera_m))

    @property
    def _robot(self) -> Array:
        return np.array((*-self.low_m, 0.0))


def warm() -> None:
    """Use the kernels once, so that no later use waits for their compilation."""
    ground = Ground.around(np.zeros((1, 3)), np.zeros(3), np.zeros((1, 2)), Room((0.0, 0.0, 0.0), 0.0, 0.0))
    ground.best(np.zeros((1, 2)), 0, 0.0)
    ground.path_cost()


def way_in(ground: Ground, at: Array, corner: int, last_m: tuple[float, float] | None) -> Turn | None:
    """The turn in the pocket at a row of the path: the one before at `last_m`, unless another one is much better. None where the path serves."""
    turn_m = ground.room.turn_m
    held = ground.best(np.array([last_m]), corner, turn_m - NOISE_M) if last_m is not None else None
    if last_m is not None and held is not None and math.hypot(*last_m) < SURE_M:
        return held
    most = BETTER * held.cost if held is not None else WORTH * ground.path_cost()
    best = ground.best(_net(at), corner, turn_m, FINER * most)
    return held if best is None else ground.best(_around(best), corner, turn_m, most) or held


def way_out(ground: Ground) -> Turn | None:
    """From the robot back to the path; None where there is no room."""
    return ground.best(np.zeros((1, 2)), -1, 0.0)


def _net(at: Array) -> Array:
    """(n, 2) places from a row of the path on towards the wall."""
    deep, wide = np.mgrid[0.0:DEEP_M:APART_M, -WIDE_M : WIDE_M + 0.5 * APART_M : APART_M].reshape(2, -1)
    c, s = math.cos(at[2]), math.sin(at[2])
    return np.column_stack((at[0] + c * wide - s * deep, at[1] + s * wide + c * deep))


def _around(turn: Turn) -> Array:
    """(n, 2) that place and those around it."""
    x, y = FINE_M * np.mgrid[-1:2, -1:2].reshape(2, -1)
    return np.column_stack((turn.x_m + x, turn.y_m + y))
