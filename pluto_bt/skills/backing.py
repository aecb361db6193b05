"""Backing out of where a robot can neither go on nor turn: in the middle between what stands beside it, until it can turn to where it wants to go."""

from __future__ import annotations

import math
from enum import Enum, auto
from typing import Final

import numpy as np

from pluto_bt.skills.outline import Array, Outline, Planar
from pluto_bt.skills.sweep import first_contact
from pluto_bt.skills.trail import Trail

TURNS_RAD: Final = np.radians(np.arange(-16.0, 16.1, 2.0))  # directions in which a wall beside the robot may run
BEHIND_RAD: Final = 0.5 * math.pi  # what lies farther aside lies behind
BESIDE_M: Final = 0.8  # so near to its sides a wall matters …
ALONG_M: Final = 2.5  # … that begins at its tail and is looked at up to here
FEW: Final = 6  # points are no wall
AIM_M: Final = 1.0  # so far behind its tail is in the middle between the walls
FAR_M: Final = 3.0  # a way back that is free so far counts as free
ROOM_TO_TURN_M: Final = 0.1  # so much farther than to where it can turn: what is remembered is not that exact
MOST_M: Final = 12.0
HEADWAY_M: Final = 0.1  # less is none
NEAR_M: Final = 0.2  # beyond the outline's corners nothing is touched by turning


class Behind(Enum):
    """What a robot knows of what lies behind it: a sonar listens there, the laser saw it on the way, or nothing."""

    HEARD = auto()
    SEEN = auto()
    UNKNOWN = auto()


class Backing:
    """One way back after the other."""

    def __init__(self, outline: Outline) -> None:
        self._outline = outline
        self._trail = Trail()
        self.forget()

    def forget(self) -> None:
        """A new goal."""
        self._from: Planar | None = None
        self._can_turn_m: float | None = None  # the way to where it could turn first
        self._is_blind, self._most_m = False, MOST_M
        self._aim_rad: float | None = None  # by the odometry, where it wanted to go when it began to back, until it has turned there
        self._farthest_m = 0.0

    @property
    def is_on(self) -> bool:
        """True while the robot backs."""
        return self._from is not None

    @property
    def is_leaving(self) -> bool:
        """True from the beginning of a way back until the robot has turned round, if that is what it backs for."""
        return self._aim_rad is not None

    def aim(self, wish_rad: float, heading_rad: float) -> float:
        """Where the robot has to turn to, relative to its heading: `wish_rad`, but for one that has backed. Going back on what it left is no wish."""
        if self._aim_rad is None:
            return wish_rad
        if abs(wish_rad) > BEHIND_RAD:
            self._aim_rad = heading_rad + wish_rad
        aim_rad = math.remainder(self._aim_rad - heading_rad, math.tau)
        if abs(aim_rad) <= BEHIND_RAD:
            self._aim_rad = None
            return wish_rad
        return aim_rad

    def note(self, odometry: Planar) -> None:
        """The robot is here now."""
        self._trail.note(odometry, self.is_on)

    @property
    def known_m(self) -> float:
        """How far back the robot's own trail leads."""
        return self._trail.length_m

    def begin(self, odometry: Planar, aim_rad: float, is_blind: bool) -> None:
        """From here, because the robot cannot turn to `aim_rad`, relative to its heading; or is held by what it does not see. One that is blind
        behind goes no farther back than along its trail: it would not notice a wall that it rubs along while its wheels slip."""
        if abs(aim_rad) > BEHIND_RAD:
            self._aim_rad = odometry[2] + aim_rad
        self._from, self._can_turn_m = odometry, None
        self._is_blind, self._most_m = is_blind, min(MOST_M, self.known_m) if is_blind else MOST_M

    def end(self) -> None:
        """Drive on, or try something else."""
        self._from = None

    def goes_on(self, odometry: Planar, least_m: float, can_turn: bool) -> bool:
        """Whether to back any farther: at least `least_m`, and until the robot can turn to where it wants to go."""
        assert self._from is not None  # begin() comes first
        way_m = math.dist(odometry[:2], self._from[:2])
        self._can_turn_m = None if not can_turn else self._can_turn_m if self._can_turn_m is not None else way_m
        has_room = self._can_turn_m is not None and way_m >= self._can_turn_m + ROOM_TO_TURN_M
        if way_m >= self._most_m or (way_m >= least_m and has_room):
            self.end()
        return self.is_on

    def makes_way(self, odometry: Planar) -> bool:
        """True if the robot is farther back than it ever was: that is headway; backing out of the same place again is none."""
        way_m = 0.0 if self._from is None else math.dist(odometry[:2], self._from[:2])
        if way_m < self._farthest_m + HEADWAY_M:
            return False
        self._farthest_m = way_m
        return True

    def turnable_rad(self, points: Array) -> tuple[float, float]:
        """How far the robot can turn on the spot, to the right and to the left, both positive; points (n, 5) as for `first_contact`."""
        near = points[np.hypot(points[:, 0], points[:, 1]) < self._outline.reach_m + NEAR_M]
        right_rad, _ = first_contact(near, self._outline.planes, 0.0, -1.0, math.pi)
        left_rad, _ = first_contact(near, self._outline.planes, 0.0, 1.0, math.pi)
        return right_rad, left_rad

    def way_back(self, points: Array, odometry: Planar, turnable_rad: tuple[float, float]) -> tuple[float, float]:
        """The turn with which the robot backs in the middle between what stands beside it, or along its trail where it is blind; and how far that
        way is free from its tail on."""
        wanted_rad = self._trail.turn_rad(odometry, AIM_M) if self._is_blind else self._to_the_middle_rad(points)
        turn_rad = max(-turnable_rad[0], min(turnable_rad[1], wanted_rad))
        c, s = math.cos(turn_rad), math.sin(turn_rad)
        turned = points.copy()
        for x, y in ((0, 1), (3, 4)):  # places and velocities
            turned[:, x], turned[:, y] = c * points[:, x] + s * points[:, y], c * points[:, y] - s * points[:, x]
        return turn_rad, first_contact(turned, self._outline.planes, -1.0, 0.0, FAR_M)[0]

    def _to_the_middle_rad(self, points: Array) -> float:
        """Between two walls along them, as straight as they run, and a little towards the one that is farther away; else straight back."""
        o = self._outline
        gaps_m = np.abs(points[:, 1]) - o.side_m
        beside = points[(gaps_m > 0.0) & (gaps_m < BESIDE_M) & (points[:, 0] > -o.back_m) & (points[:, 0] < ALONG_M), :2]
        walls = [side for side in (beside[beside[:, 1] > 0.0], beside[beside[:, 1] < 0.0]) if len(side) >= FEW]
        if len(walls) < 2:
            return 0.0
        aside_m = [np.outer(np.cos(TURNS_RAD), wall[:, 1]) - np.outer(np.sin(TURNS_RAD), wall[:, 0]) for wall in walls]
        rough_m = sum(np.abs(y - np.median(y, axis=1, keepdims=True)).mean(axis=1) for y in aside_m)
        along = int(np.argmin(rough_m))
        middle_m = 0.5 * sum(float(np.median(y[along])) for y in aside_m)
        return float(TURNS_RAD[along]) - math.atan2(middle_m, AIM_M)
