"""Following a path by points ahead on it: as far ahead as the straight way there stays near enough to the path for the room it has."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable

import numpy as np

from pluto_bt.maps.kernel import kernel
from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.plan_parameters import PlanParameters

NEAREST_M = 0.6  # the point ahead is never nearer than this, so that the robot does not slow down before it
REACHED_M = 0.32  # what is nearer is reached: a goto is content with that, and would stand there for ever
COMES_BACK_M = 0.1
SEARCH_M = 3.0  # the robot is looked for so far along the path from where it was,
BACK_M = 0.3  # and not beyond where the path leads away from it by so much: it may come back by the same way
CUT_SHARE, MOST_CUT_M, LEAST_CUT_M = 0.5, 0.6, 0.08  # of the spare room beside the path, corners may be cut
SHARES = (1.0, 0.8, 0.6, 0.45, 0.3)  # of the longest look ahead, that are tried
CAME_ON_M = 0.3  # so much of the path is headway
FARTHEST_M = 0.25  # points of a path are no farther apart; who writes one by hand only gives its corners


class PathFollowing:
    """One path (n, 2) in metres. `place` is the index of the point nearest to the robot, which never goes back."""

    def __init__(self, points: Array, rooms_m: Callable[[Array], Array] | None, least_m: float, parameters: PlanParameters) -> None:
        """`rooms_m` tells how far points of the path are from what stands, if anybody knows; `least_m` of it the robot itself needs."""
        points = filled(points)
        self._points, self._parameters = points, parameters
        self._at_m: list[float] = [0.0, *np.cumsum(np.hypot(*np.diff(points, axis=0).T)).tolist()]
        spare = np.full(len(points), 0.3) if rooms_m is None else rooms_m(points) - least_m
        self._cut_m = np.clip(CUT_SHARE * spare, LEAST_CUT_M, MOST_CUT_M)

    def begin(self, robot: Planar, now_s: float) -> None:
        """Go on from where the robot is."""
        away_m = np.hypot(self._points[:, 0] - robot[0], self._points[:, 1] - robot[1])
        first = int(np.flatnonzero(away_m <= away_m.min() + BACK_M)[0])
        self.place = first + nearest_ahead(self._points[first:], robot[0], robot[1])
        self._best_m, self._best_s = self._at_m[self.place], now_s

    def wait(self, now_s: float) -> None:
        """Time in which the robot had to stand for another reason does not count as being stuck."""
        self._best_s = now_s

    def step(self, robot: Planar, now_s: float) -> tuple[float, float]:
        """The point of the path to steer to."""
        self._advance(robot, now_s)
        return self._ahead(robot)

    @property
    def end(self) -> tuple[float, float]:
        """The last point."""
        return float(self._points[-1, 0]), float(self._points[-1, 1])

    @property
    def left_m(self) -> float:
        """What is left of the path."""
        return self._at_m[-1] - self._at_m[self.place]

    def stuck_s(self, now_s: float) -> float:
        """How long there has been no headway."""
        return now_s - self._best_s

    def stretch(self, length_m: float) -> Array:
        """The next points (k, 2) of the path."""
        return self._points[self.place : bisect_right(self._at_m, self._at_m[self.place] + length_m)]

    def off_m(self, robot: Planar) -> float:
        """How far the robot is from the path: positive on its left."""
        at = min(self.place, len(self._points) - 2) if len(self._points) > 1 else 0
        a = self._points[at]
        heading_rad = self.heading_rad()
        return float(math.cos(heading_rad) * (robot[1] - a[1]) - math.sin(heading_rad) * (robot[0] - a[0]))

    def heading_rad(self) -> float:
        """Where the path leads here."""
        if len(self._points) < 2:
            return 0.0
        at = min(self.place, len(self._points) - 2)
        step = self._points[at + 1] - self._points[at]
        return math.atan2(step[1], step[0])

    def _advance(self, robot: Planar, now_s: float) -> None:
        self.place += nearest_ahead(self.stretch(SEARCH_M), robot[0], robot[1])
        come_m = self._at_m[self.place]
        if come_m > self._best_m + CAME_ON_M:
            self._best_m, self._best_s = come_m, now_s

    def _ahead(self, robot: Planar) -> tuple[float, float]:
        while True:
            for share in SHARES:
                stretch = self.stretch(max(NEAREST_M, share * self._parameters.ahead_m))
                if can_cut(stretch, self._cut_m[self.place : self.place + len(stretch)], robot[0], robot[1]):
                    break
            last = self.place + farthest_first(stretch, robot[0], robot[1])
            away_m = math.dist(self._points[last], robot[:2])
            if away_m >= REACHED_M or last == len(self._points) - 1:
                return float(self._points[last, 0]), float(self._points[last, 1])
            self.place = last + 1  # there already


def farthest_first(points: Array, x_m: float, y_m: float) -> int:
    """The last of the points (n, 2) of a way, or the one at a sharp corner from which on it comes back to the place."""
    best, most_m = 0, 0.0
    for k, (px, py) in enumerate(points.tolist()):
        away_m = math.hypot(px - x_m, py - y_m)
        if away_m < most_m - COMES_BACK_M:
            return best
        if away_m >= most_m:
            best, most_m = k, away_m
    return len(points) - 1


def filled(points: Array) -> Array:
    """The same way (n, 2) with points between those that are farther apart than `FARTHEST_M`; a copy, of one kind for the kernels."""
    points = np.array(points)
    pieces = np.maximum(1, np.ceil(np.hypot(*np.diff(points, axis=0).T) / FARTHEST_M)).astype(int)
    legs = np.repeat(np.arange(len(pieces)), pieces)
    if len(legs) == len(pieces):
        return points
    share = (np.arange(len(legs)) - np.repeat(np.cumsum(pieces) - pieces, pieces)) / pieces[legs]
    return np.vstack((points[legs] + share[:, None] * (points[legs + 1] - points[legs]), points[-1:]))


@kernel
def nearest_ahead(points: Array, x_m: float, y_m: float) -> int:
    """Which of the points (n, 2) of a way is nearest to a place, before it leads away again by `BACK_M`."""
    best, least_m = 0, np.inf
    for k in range(points.shape[0]):
        away_m = math.sqrt((points[k, 0] - x_m) ** 2 + (points[k, 1] - y_m) ** 2)
        if away_m < least_m:
            best, least_m = k, away_m
        elif away_m > least_m + BACK_M:
            break
    return best


@kernel
def can_cut(points: Array, cut_m: Array, x_m: float, y_m: float) -> bool:
    """True if the straight way from a place to the last of the points (n, 2) leaves none of them farther aside than its `cut_m` (n,) allows, or
    than the first one is away by now.
    """
    last = points.shape[0] - 1
    dx, dy = points[last, 0] - x_m, points[last, 1] - y_m
    off_m = math.sqrt((points[0, 0] - x_m) ** 2 + (points[0, 1] - y_m) ** 2)
    for k in range(points.shape[0]):
        x, y = points[k, 0] - x_m, points[k, 1] - y_m
        share = min(max((dx * x + dy * y) / max(dx * dx + dy * dy, 1e-12), 0.0), 1.0)  # of the way there, where it is nearest to this point
        if math.sqrt((x - share * dx) ** 2 + (y - share * dy) ** 2) > max(cut_m[k], off_m):
            return False
    return True


def warm() -> None:
    """Use the kernels once, so that no later use waits for their compilation."""
    at = np.zeros((1, 2))
    nearest_ahead(at, 0.0, 0.0)
    can_cut(at, np.zeros(1), 0.0, 0.0)
