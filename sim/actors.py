"""Actors: discs that walk along their waypoints at constant speed, and yield to nobody. Positions are closed forms of time."""

from __future__ import annotations

import bisect
import math
from collections.abc import Iterable

from pluto_bt.maps.world import Actor

Point = tuple[float, float]


class Walk:
    """A polyline walked at constant speed from `start_s`; a loop closes last → first, any other walk ends at its last point."""

    def __init__(self, points: list[Point], speed_mps: float, loop: bool, start_s: float) -> None:
        self._points = [*points, points[0]] if loop else points
        self._ends_m = [0.0]
        for (x, y), (x_next, y_next) in zip(self._points, self._points[1:], strict=False):
            self._ends_m.append(self._ends_m[-1] + math.hypot(x_next - x, y_next - y))
        self._speed_mps, self._loop, self._start_s = speed_mps, loop, start_s

    @property
    def length_m(self) -> float:
        """One round, or the whole way."""
        return self._ends_m[-1]

    def leg_and_position(self, now_s: float) -> tuple[int, Point]:
        """(index of the leg, (x m, y m)) at `now_s`."""
        run_m = max(0.0, now_s - self._start_s) * self._speed_mps
        run_m = math.fmod(run_m, self.length_m) if self._loop and self.length_m > 0.0 else min(run_m, self.length_m)
        i = min(max(bisect.bisect_right(self._ends_m, run_m) - 1, 0), max(len(self._points) - 2, 0))
        (x, y), (x_next, y_next) = self._points[i], self._points[min(i + 1, len(self._points) - 1)]
        leg_m = self._ends_m[min(i + 1, len(self._ends_m) - 1)] - self._ends_m[i]
        share = (run_m - self._ends_m[i]) / leg_m if leg_m > 0.0 else 0.0
        return i, (x + share * (x_next - x), y + share * (y_next - y))


class Walker:
    """One actor of the world as it is now. Put elsewhere by a script, it walks on from there to the waypoint it was heading for."""

    def __init__(self, actor: Actor) -> None:
        self.id = actor.id
        self.radius_m = actor.radius_m
        self.present = not actor.absent
        self.speed_mps = actor.speed_mps
        self._loop = actor.loop and len(actor.waypoints) > 1
        self._waypoints: list[Point] = [(x, y) for x, y in actor.waypoints.tolist()]
        self._way = Walk(self._waypoints, self.speed_mps, self._loop, 0.0)
        self._lead_in: Walk | None = None
        self._lead_in_until_s = 0.0
        self._next_waypoint = 0

    def position_at(self, now_s: float) -> Point:
        """(x m, y m), map frame."""
        if self._lead_in is not None and now_s < self._lead_in_until_s:
            return self._lead_in.leg_and_position(now_s)[1]
        return self._way.leg_and_position(now_s)[1]

    def put(self, x_m: float | None, y_m: float | None, now_s: float) -> None:
        """Be here from now on, or where the file drew the first waypoint; an actor that was absent begins its walk."""
        if x_m is None or y_m is None:
            self._lead_in, self._next_waypoint = None, 0
            self._way = Walk(self._waypoints, self.speed_mps, self._loop, now_s)
        else:
            self._walk_on_from((x_m, y_m), now_s)
        self.present = True

    def _walk_on_from(self, here: Point, now_s: float) -> None:
        """A lead-in to the waypoint it was heading for, then the way from there."""
        heading_for = 0
        if self.present:
            walked_in = self._lead_in is not None and now_s < self._lead_in_until_s
            leg = -1 if walked_in else self._way.leg_and_position(now_s)[0]
            heading_for = (self._next_waypoint + leg + 1) % len(self._waypoints)
        rest = self._waypoints[heading_for:] + (self._waypoints[:heading_for] if self._loop else [])
        self._lead_in = Walk([here, rest[0]], self.speed_mps, False, now_s)
        self._lead_in_until_s = now_s + (self._lead_in.length_m / self.speed_mps if self.speed_mps > 0.0 else math.inf)
        self._way = Walk(rest, self.speed_mps, self._loop, self._lead_in_until_s)
        self._next_waypoint = heading_for

    def take_away(self) -> None:
        """Be nowhere."""
        self.present = False


def fastest_mps(walkers: Iterable[Walker]) -> float:
    """The highest speed of those present."""
    return max((walker.speed_mps for walker in walkers if walker.present), default=0.0)
