"""Straight looks over the local map: how far a path of a given width is open, and whether the side of a street opens."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from pluto_bt.skills.local_map import LocalMap
from pluto_bt.skills.outline import Planar

OPENING_LOOK_M = 15.0  # how deep sides are looked into
BEFORE = 12  # how many earlier looks at a side say how deep it usually is
APART_SHARE = 0.25  # looks are so far apart, in half widths of a path
SAME_OPENING_HALF_WIDTHS = 4.0  # an opening so near to one that was told before is the same


def is_open(map: LocalMap, a: tuple[float, float], b: tuple[float, float], half_width_m: float, from_m: float = 0.0) -> bool:
    """True if a corridor of this half width from a to b holds nothing that stands; its first `from_m` metres may be narrower."""
    free = map.clearances_between_m(a, b)[math.ceil(from_m / map.cell_m) :]
    return bool((free >= half_width_m).all())


def free_m(map: LocalMap, x_m: float, y_m: float, heading_rad: float, half_width_m: float, most_m: float) -> float:
    """How far a corridor of this half width is open from a point on a heading."""
    end = (x_m + most_m * math.cos(heading_rad), y_m + most_m * math.sin(heading_rad))
    free = map.clearances_between_m((x_m, y_m), end)
    blocked = np.flatnonzero(free < half_width_m)
    return most_m if not len(blocked) else float(blocked[0]) * map.cell_m


class Openings:
    """Watches both sides while the robot goes along: a side that suddenly lies much deeper is an opening, told once."""

    def __init__(self, map: LocalMap) -> None:
        self._map = map
        p = map.parameters
        self._apart_m = APART_SHARE * p.path_half_width_m
        self._same_m = SAME_OPENING_HALF_WIDTHS * p.path_half_width_m
        self._sides: dict[str, deque[float]] = {"left": deque(maxlen=BEFORE), "right": deque(maxlen=BEFORE)}
        self._last: tuple[float, float] | None = None
        self._told: list[tuple[float, float]] = []

    def turn(self) -> None:
        """The robot turns into another street: what lay beside it until now says nothing of the new sides."""
        for depths in self._sides.values():
            depths.clear()

    def look(self, robot: Planar, heading_rad: float) -> str:
        """ "left" or "right" where an opening begins, else "". `heading_rad` is that of the street."""
        here = robot[:2]
        if self._last is not None and math.dist(here, self._last) < self._apart_m:
            return ""
        self._last = here
        found = ""
        for side, turn_rad in (("left", math.pi / 2.0), ("right", -math.pi / 2.0)):
            depth_m = free_m(self._map, *here, heading_rad + turn_rad, 0.8 * self._map.parameters.path_half_width_m, OPENING_LOOK_M)
            before = self._sides[side]
            usual_m = sorted(before)[len(before) // 2] if len(before) >= BEFORE // 2 else math.inf
            if depth_m > usual_m + self._map.parameters.opening_m and not self._is_told(here):
                found = side
            before.append(depth_m)
        if found:
            self._told.append(here)
        return found

    def _is_told(self, here: tuple[float, float]) -> bool:
        return any(math.dist(here, place) < self._same_m for place in self._told)
