"""Circling an object at a radius around its middle, which becomes better known with every side that is seen."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.skills.limits import Twist
from pluto_bt.skills.local_map import LocalMap
from pluto_bt.skills.objects import Thing, smallest_circle
from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.sight import ScanView

GATE_M = 0.5  # a point so near to what was seen of the object before belongs to it
BACKED_M = 0.15  # neighbouring beams that differ by less see the same surface
GRAIN_M = 0.05  # points are kept once a square of this size
MOST_POINTS = 4000
INWARD_RAD_PER_M, MOST_INWARD_RAD = 1.5, math.radians(60.0)  # how the course bends towards the circle
TURN_PER_S = 2.0
SLOW_RAD = math.radians(60.0)  # so far off its course the robot turns on the spot
LEVEL_RAD = math.radians(1.0)


class SeenObject:
    """What has been seen of one object. Points are in dead reckoning."""

    def __init__(self, thing: Thing, largest_m: float) -> None:
        self.thing = thing
        self._largest_m = largest_m
        self._points: dict[tuple[int, int], tuple[float, float]] = {}

    def see(self, view: ScanView) -> None:
        """Take the points of a level scan that belong to the object; its middle and size follow from all of them."""
        if view.laser is None or abs(view.tilt_rad) > LEVEL_RAD or len(self._points) >= MOST_POINTS:
            return
        x, y, yaw = view.laser
        ranges = view.scan.ranges_m
        bearings = yaw + view.scan.angle_min_rad + view.scan.angle_step_rad * np.arange(len(ranges))
        points = np.column_stack((x + ranges * np.cos(bearings), y + ranges * np.sin(bearings)))[_is_backed(ranges)]
        away = np.hypot(points[:, 0] - self.thing.x_m, points[:, 1] - self.thing.y_m)
        for px, py in points[away < min(self.thing.radius_m + GATE_M, 0.5 * self._largest_m + GATE_M)].tolist():
            self._points.setdefault((math.floor(px / GRAIN_M), math.floor(py / GRAIN_M)), (px, py))
        if len(self._points) >= 3:
            self.thing = smallest_circle(self.points)

    @property
    def points(self) -> Array:
        """All points seen, (n, 2) metres."""
        return np.array(list(self._points.values())).reshape(-1, 2)


def _is_backed(ranges_m: Array) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Which beams one of their neighbours agrees with: a single one may be dazzled."""
    is_same = np.abs(np.diff(ranges_m)) < BACKED_M
    backed: np.ndarray[tuple[int, ...], np.dtype[np.bool_]] = np.append(is_same, False) | np.append(False, is_same)
    return backed & (ranges_m > 0.0)


def circle(robot: Planar, thing: Thing, radius_m: float, speed_mps: float, side: float) -> Twist:
    """The twist that brings the robot onto the circle and along it; `side` +1 = counter-clockwise, the object on the left; -1 = clockwise."""
    dx, dy = robot[0] - thing.x_m, robot[1] - thing.y_m
    distance_m = max(math.hypot(dx, dy), 0.1)
    inward_rad = max(-MOST_INWARD_RAD, min(MOST_INWARD_RAD, INWARD_RAD_PER_M * (distance_m - radius_m)))
    error_rad = wrap_angle(math.atan2(dy, dx) + side * (math.pi / 2.0 + inward_rad) - robot[2])
    forward_mps = speed_mps * max(0.0, 1.0 - abs(error_rad) / SLOW_RAD)
    return forward_mps, side * forward_mps / distance_m + TURN_PER_S * error_rad


def facing_rad(robot: Planar, thing: Thing, ahead_m: float, pan_rad: float) -> float:
    """The heading with which a laser `ahead_m` before the robot's middle, turned aside by `pan_rad`, looks at the object; the nearer of both sides.

    In the triangle of robot, laser and object the angle at the laser is π - pan, so the object lies pan - asin(ahead / distance · sin pan) aside.
    """
    dx, dy = thing.x_m - robot[0], thing.y_m - robot[1]
    bearing_rad = math.atan2(dy, dx)
    aside_rad = pan_rad - math.asin(min(1.0, ahead_m / max(math.hypot(dx, dy), ahead_m) * math.sin(pan_rad)))
    return bearing_rad - math.copysign(aside_rad, wrap_angle(bearing_rad - robot[2]))


def tightest(map: LocalMap, thing: Thing, radius_m: float) -> tuple[float, float, float]:
    """The place x m, y m (dead reckoning) on a circle round a thing with the least room, and how much that is."""
    angles = np.arange(0.0, math.tau, map.cell_m / radius_m)
    places = np.column_stack((thing.x_m + radius_m * np.cos(angles), thing.y_m + radius_m * np.sin(angles)))
    rooms_m = map.clearances_m(places)
    at = int(np.argmin(rooms_m))
    return float(places[at, 0]), float(places[at, 1]), float(rooms_m[at])


class Looks:
    """When the robot stops on its round to look at the object: so many times a turn, evenly."""

    def __init__(self, per_turn: int) -> None:
        self._apart = math.inf if per_turn == 0 else 1.0 / per_turn
        self._next = 0.0 if per_turn else math.inf
        self._since_s: float | None = None  # since when it turns to it …
        self._there_s: float | None = None  # … and since when it looks

    @property
    def is_on(self) -> bool:
        """True during a look."""
        return self._since_s is not None

    def pause(self) -> None:
        """Nobody looked for a while: a look that was on begins anew."""
        self._since_s = self._there_s = None

    def is_due(self, turns: float) -> bool:
        """True if a look is on, or due after so many turns."""
        return self.is_on or turns >= self._next

    def goes_on(self, now_s: float, is_there: bool, look_s: float, most_s: float) -> bool:
        """False when the laser has faced the object for `look_s`, or has not got there within `most_s`; then the next look is waited for."""
        self._since_s = self._since_s if self._since_s is not None else now_s
        self._there_s = None if not is_there else self._there_s if self._there_s is not None else now_s
        if (self._there_s is None or now_s - self._there_s < look_s) and now_s - self._since_s < most_s:
            return True
        self._since_s = self._there_s = None
        self._next += self._apart
        return False


class Round:
    """How far around the object the robot has come, both ways counted."""

    def __init__(self) -> None:
        self._last_rad: float | None = None
        self._low_rad = self._high_rad = self._now_rad = 0.0

    def go(self, robot: Planar, thing: Thing) -> float:
        """Turns around the object that have been seen, counted without gaps and without doubles."""
        bearing_rad = math.atan2(robot[1] - thing.y_m, robot[0] - thing.x_m)
        if self._last_rad is not None:
            self._now_rad += wrap_angle(bearing_rad - self._last_rad)
        self._last_rad = bearing_rad
        self._low_rad, self._high_rad = min(self._low_rad, self._now_rad), max(self._high_rad, self._now_rad)
        return (self._high_rad - self._low_rad) / math.tau
