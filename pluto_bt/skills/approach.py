"""Who comes nearer: echoes that shorten round by round faster than the robot's own motion can explain. Frame: dead reckoning."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.sonar import Mask, SonarRing

ROUNDS = 4
HEAR_M = 3.0
NEARER_M = 0.12  # over the rounds: four sigma of a difference of two echoes, and 0.4 m/s
EVENLY = 0.6  # of the whole, at most, in one round: what comes into a cone from its side comes in one leap
SLANT = 1.2  # a slanting wall comes nearer by so much more than one that stands across the way
WIDEST_RAD = math.radians(60.0)  # along a cone's edge farther off the way than this, what stands comes nearer without bound …
STANDING_M = 0.02  # … unless the robot as good as stands, and TURNING_M is how far the end of a cone may sweep
TURNING_M = 0.06
LONGEST_S = 0.7  # older rounds do not belong to the same approach


class Approach:
    """The newest rounds of the ring."""

    def __init__(self, ring: SonarRing) -> None:
        self._ring = ring
        self._rounds: list[tuple[Array, Planar, float]] = []

    def look(self, ranges_m: Array, robot: Planar, stamp_s: float) -> Array:
        """Take a round, heard from `robot`.

        Returns: (n, 3) x m, y m and how far beside that, for each transducer that hears somebody come.
        """
        self._rounds = [*self._rounds[1 - ROUNDS :], (ranges_m, robot, stamp_s)]
        first_m, _, first_s = self._rounds[0]
        if len(self._rounds) < ROUNDS or stamp_s - first_s > LONGEST_S:
            return NOTHING
        near = (ranges_m < HEAR_M) & (first_m - ranges_m > NEARER_M) & (ranges_m > self._ring.min_range_m)
        return self._steady(near) if near.any() else NOTHING

    def _steady(self, near: Mask) -> Array:
        """Those of the near ones that came evenly, own motion taken off."""
        heard = np.array([ranges_m for ranges_m, _, _ in self._rounds])
        places = [self._apexes(robot) for _, robot, _ in self._rounds]
        own_m = np.array([self._own_m(*two) for two in pairwise(places)])
        came_m = heard[:-1] - heard[1:] - own_m
        total_m = came_m.sum(axis=0)
        swept_m = np.minimum(heard[-1], HEAR_M) * np.abs(places[-1][2] - places[0][2])
        found = near & (total_m > NEARER_M) & (came_m.max(axis=0) < EVENLY * total_m) & (swept_m < TURNING_M)
        x, y, theta = places[-1]
        ranges_m = heard[-1]
        unsure_m = ranges_m * math.sin(self._ring.half_cone_rad)
        return np.column_stack((x + ranges_m * np.cos(theta), y + ranges_m * np.sin(theta), unsure_m))[np.flatnonzero(found)]

    def _apexes(self, robot: Planar) -> Array:
        """(3, k) x, y, theta of the transducers."""
        axes = self._ring.axes
        c, s = math.cos(robot[2]), math.sin(robot[2])
        return np.array((robot[0] + c * axes[:, 0] - s * axes[:, 1], robot[1] + s * axes[:, 0] + c * axes[:, 1], robot[2] + axes[:, 2]))

    def _own_m(self, before: Array, after: Array) -> Array:
        """(k,) how much nearer what stands can have come by the robot's own step; infinite where that cannot be said."""
        dx, dy = after[0] - before[0], after[1] - before[1]
        way_m = np.hypot(dx, dy)
        aside_rad = np.abs(np.remainder(np.arctan2(dy, dx) - after[2] + np.pi, 2.0 * np.pi) - np.pi)
        edge_rad = np.minimum(aside_rad + self._ring.half_cone_rad, WIDEST_RAD)
        known: Array = np.where((edge_rad < WIDEST_RAD) | (way_m < STANDING_M / ROUNDS), SLANT * way_m / np.cos(edge_rad), np.inf)
        return known


NOTHING: Array = np.zeros((0, 3))
