"""Circling an object at a radius around its middle, which becomes better known with every side that is seen."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.skills.limits import Twist
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
