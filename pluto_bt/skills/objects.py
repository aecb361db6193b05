"""Objects in the local map: things that stand alone and are small enough to walk around."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pluto_bt.skills.local_grid import CELLS
from pluto_bt.skills.local_map import LocalMap
from pluto_bt.skills.outline import Array, Planar

STEPS = 120  # of the search for the smallest circle around points
ASIDE_CELLS = 3  # beside the end of a thing; nearer cells may belong to it


class Thing(NamedTuple):
    """A thing seen from above, metres in dead reckoning: the smallest circle that holds what was seen of it."""

    x_m: float
    y_m: float
    radius_m: float


def smallest_circle(points: Array) -> Thing:
    """The smallest circle around points (n, 2), to about a hundredth of its radius.

    The centre is drawn to the farthest point by ever smaller steps. Ref: Bădoiu and Clarkson, Smaller core-sets for balls, 2003.
    """
    centre = points.mean(axis=0)
    for step in range(1, STEPS + 1):
        away = np.hypot(points[:, 0] - centre[0], points[:, 1] - centre[1])
        centre = centre + (points[int(np.argmax(away))] - centre) / (step + 1)
    radius_m = float(np.hypot(points[:, 0] - centre[0], points[:, 1] - centre[1]).max())
    return Thing(float(centre[0]), float(centre[1]), radius_m)


def things_around(map: LocalMap, robot: Planar) -> list[Thing]:
    """What stands alone within the reach and is no larger than an object may be, the nearest first."""
    p = map.parameters
    reach = math.ceil(p.object_reach_m / map.cell_m)
    i, j = map.cell(robot[0], robot[1])
    i0, j0 = max(0, i - reach), max(0, j - reach)
    stands = map.evidence[i0 : min(CELLS, i + reach + 1), j0 : min(CELLS, j + reach + 1)] > 0
    found = []
    for cells in _groups(stands):
        if cells.min() == 0 or cells[:, 0].max() == stands.shape[0] - 1 or cells[:, 1].max() == stands.shape[1] - 1:
            continue  # it goes on beyond the reach
        corners = np.array([map.middle_m(a + i0, b + j0) for a, b in cells.tolist()])
        thing = smallest_circle(corners)
        if 2.0 * thing.radius_m <= p.largest_object_m + 2.0 * map.cell_m and _ends_in_sight(map, robot, corners):
            found.append(thing)
    return sorted(found, key=lambda thing: math.hypot(thing.x_m - robot[0], thing.y_m - robot[1]) - thing.radius_m)


def _ends_in_sight(map: LocalMap, robot: Planar, cells_m: Array) -> bool:
    """True if on both sides of the cells (n, 2), as seen from the robot, something was seen: else it is a piece of what goes on there, a strip
    of wall in a doorway or at the limit of sight."""
    away = cells_m - robot[:2]
    middle_rad = math.atan2(away[:, 1].mean(), away[:, 0].mean())
    aside = away[:, 1] * math.cos(middle_rad) - away[:, 0] * math.sin(middle_rad)
    for end, side in ((int(np.argmax(aside)), 1.0), (int(np.argmin(aside)), -1.0)):
        step_m = side * ASIDE_CELLS * map.cell_m
        x_m, y_m = cells_m[end, 0] - step_m * math.sin(middle_rad), cells_m[end, 1] + step_m * math.cos(middle_rad)
        if map.evidence[map.cell(x_m, y_m)] == 0:
            return False
    return True


def _groups(stands: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> list[np.ndarray[tuple[int, ...], np.dtype[np.intp]]]:
    """The cells of each connected group (8 neighbours, one missing cell bridged), in the order in which their first cells come."""
    waiting = {(int(a), int(b)) for a, b in np.argwhere(stands)}
    groups = []
    for first in sorted(waiting):
        if first not in waiting:
            continue
        waiting.discard(first)
        group, open_cells = [first], [first]
        while open_cells:
            a, b = open_cells.pop()
            for da in (-2, -1, 0, 1, 2):
                for db in (-2, -1, 0, 1, 2):
                    near = (a + da, b + db)
                    if near in waiting:
                        waiting.discard(near)
                        group.append(near)
                        open_cells.append(near)
        groups.append(np.array(sorted(group)))
    return groups
