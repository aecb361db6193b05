"""Ray following (Pluto manual, 6.3): along an open path in the middle of the street, watching both sides for openings.

One ray is one way of `Ways`. It is followed by goto points that lie ahead on it; it ends at its end, where the goal comes in straight
reach, at an opening, or where it is blocked. What to do then, its caller decides.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.skills.local_map import LocalMap
from pluto_bt.skills.outline import Planar
from pluto_bt.skills.rays import Openings
from pluto_bt.skills.rectangle import Rectangle
from pluto_bt.skills.ways import Way

REPLAN_S = 3.0  # a way is looked for anew so often, for more has been seen
HASTE_S = 0.5  # and not more often than this where the old one is blocked
STUCK_S, STUCK_M = 8.0, 0.4  # who has not come so far in so long is stuck, unless he turns nearer to the way than he has been in this place …
PLACES = 3  # … and coming back to one of the last places is not coming far
END_M = 0.6  # so near to its end a way is done
TURN_RAD = math.radians(70.0)  # a way that leads so far aside is turned to on the spot
TURNED_RAD = math.radians(25.0)
TURNING_S, TURNING_RAD = 4.0, math.radians(4.0)  # who has turned less in so long cannot turn here: goto has to find a way out
NO_TURN_S = 12.0  # and does so for so long
NEXT_M = 2.5  # how far ahead a narrow place is told of
AHEAD_S = 0.8  # where the robot will be after so long must lie inside the rectangle

GO, TURN, DONE, OPENING, BLOCKED, LOST = "go", "turn", "done", "opening", "blocked", "lost"


class Advice(NamedTuple):
    """GO to a point, TURN to a heading (both in dead reckoning), or the ray has ended: DONE, OPENING on `side`, BLOCKED by something
    that no map shows, LOST (there is no way to its end any more)."""

    kind: str
    point: tuple[float, float] = (0.0, 0.0)
    heading_rad: float = 0.0
    side: str = ""
    text: str = ""


class RayFollowing:
    """One ray from its beginning to its end."""

    def __init__(self, map: LocalMap, least_m: float, room_m: float, openings: Openings) -> None:
        """`least_m`: clearance of the narrowest way; `room_m`: clearance of a place where the robot can turn on the spot."""
        p = map.parameters
        self._map, self._least_m, self._room_m, self._openings = map, least_m, room_m, openings
        self._ahead_m = min(3.0 * p.path_half_width_m, 6.0)

    def begin(self, way: Way, find: Callable[[], Way | None], now_s: float, robot: Planar) -> None:
        """Follow `way`; `find` gives a new one to the same end when asked."""
        self._way, self._find = way, find
        self._found_s = now_s
        self._places = deque([robot[:2]], maxlen=PLACES)
        self._mark_s, self._least_off_rad = now_s, math.inf
        self._is_turning = False
        self._turn_mark_rad, self._turn_mark_s, self._may_turn_s = robot[2], now_s, now_s

    def step(self, now_s: float, robot: Planar, speed_mps: float, rectangle: Rectangle | None) -> Advice:
        """What to do now."""
        if all(math.dist(robot[:2], place) > STUCK_M for place in self._places):
            self._places.append(robot[:2])
            self._mark_s, self._least_off_rad = now_s, math.inf
        if now_s - self._mark_s > STUCK_S:
            return Advice(BLOCKED, self._point_ahead(robot, 1.0), text="no way made for a while")
        if not self._keep_way(now_s, robot):
            return Advice(LOST, text="there is no way there any more")
        if is_done(self._way, robot, self._map.cell_m):
            return Advice(DONE, text="the end of the path")
        point = self._point_ahead(robot, self._ahead_m)
        heading_rad = math.atan2(point[1] - robot[1], point[0] - robot[0])
        if self._must_turn(robot, heading_rad, speed_mps, rectangle) and self._can_turn(now_s, robot):
            off_rad = abs(wrap_angle(heading_rad - robot[2]))
            if off_rad < self._least_off_rad - TURNING_RAD:
                self._least_off_rad, self._mark_s = off_rad, now_s
            return Advice(TURN, point, heading_rad)
        side = "" if self._knows_the_way() else self._openings.look(robot, heading_rad)
        return Advice(OPENING, point, heading_rad, side, f"an opening on the {side}") if side else Advice(GO, point, heading_rad)

    @property
    def room_ahead_m(self) -> float:
        """How wide the narrowest place of the next stretch is."""
        return 2.0 * float(self._map.clearances_m(self._way.points[: math.ceil(NEXT_M / self._map.cell_m)]).min())

    def pause(self, now_s: float) -> None:
        """Time in which the robot had to wait for another reason does not count as being stuck."""
        self._mark_s = self._turn_mark_s = now_s

    def _keep_way(self, now_s: float, robot: Planar) -> bool:
        """Cut off what lies behind; look for a new way now and then, and where the old one has been blocked. False if there is none."""
        points = self._way.points
        nearest = int(np.argmin(np.hypot(points[: 200, 0] - robot[0], points[: 200, 1] - robot[1])))
        self._way = Way(points[nearest:], self._way.leads_there)
        blocked = not self._is_free()
        if now_s - self._found_s >= (HASTE_S if blocked else REPLAN_S):
            self._found_s = now_s
            way = self._find()
            if not blocked and (way is None or self._turns_back(robot, way)) and self._map.clearance_m(*robot[:2]) < self._room_m:
                return True  # in a doorway: the old way leads on to where there is room to turn
            if way is None:
                return False
            if abs(wrap_angle(self._heading_of(way, robot) - self._heading_of(self._way, robot))) > TURN_RAD:
                self._least_off_rad = math.inf  # another turn begins
            self._way = way
        return True

    def _turns_back(self, robot: Planar, way: Way) -> bool:
        """True if the robot has to turn on the spot before it can follow a way."""
        return abs(wrap_angle(self._heading_of(way, robot) - robot[2])) > TURN_RAD

    def _heading_of(self, way: Way, robot: Planar) -> float:
        """Where a way leads to from the robot."""
        x, y = way.points[min(len(way.points) - 1, math.ceil(self._room_m / self._map.cell_m))].tolist()
        return math.atan2(y - robot[1], x - robot[0])

    def _is_free(self) -> bool:
        """Nothing stands on the next stretch."""
        count = int(2.0 * self._ahead_m / self._map.cell_m)
        stretch = self._way.points[4:count]
        return not len(stretch) or bool((self._map.clearances_m(stretch) > 0.8 * self._least_m).all())

    def _point_ahead(self, robot: Planar, most_m: float) -> tuple[float, float]:
        """The farthest point of the way within `most_m` that can be driven to straight without leaving the room that the way has."""
        points = self._way.points
        last = min(len(points) - 1, math.ceil(most_m / self._map.cell_m))
        room_m = min(float(self._map.clearances_m(points[: last + 1]).min()), self._map.parameters.path_half_width_m)
        for k in (last, (3 * last) // 4, last // 2, last // 4):
            point = (float(points[k, 0]), float(points[k, 1]))
            if float(self._map.clearances_between_m(robot[:2], point).min()) >= 0.8 * room_m:
                break
        return point

    def _must_turn(self, robot: Planar, heading_rad: float, speed_mps: float, rectangle: Rectangle | None) -> bool:
        """True while the robot has to turn on the spot: the way leads far aside, or it would drive out of the rectangle."""
        off_rad = abs(wrap_angle(heading_rad - robot[2]))
        x, y = robot[0] + AHEAD_S * speed_mps * math.cos(robot[2]), robot[1] + AHEAD_S * speed_mps * math.sin(robot[2])
        leaves = rectangle is not None and rectangle.depth_m(x, y) < min(0.0, rectangle.depth_m(robot[0], robot[1]))
        self._is_turning = off_rad > (TURNED_RAD if self._is_turning else TURN_RAD) or (leaves and off_rad > TURNED_RAD)
        return self._is_turning

    def _can_turn(self, now_s: float, robot: Planar) -> bool:
        """False for a while where turning makes no headway: something stands too near."""
        if abs(wrap_angle(robot[2] - self._turn_mark_rad)) > TURNING_RAD or now_s - self._turn_mark_s > 2.0 * TURNING_S:
            self._turn_mark_rad, self._turn_mark_s = robot[2], now_s
        elif now_s - self._turn_mark_s > TURNING_S:
            self._may_turn_s = now_s + NO_TURN_S
        self._is_turning = now_s >= self._may_turn_s
        return self._is_turning

    def _knows_the_way(self) -> bool:
        """True if all of the way has been seen: then openings do not matter."""
        return self._way.leads_there and self._map.is_seen_free(self._way.points)


def is_done(way: Way, robot: Planar, cell_m: float) -> bool:
    """True if the robot is at the end of a way, and not only passes it on the other side of a wall."""
    return math.dist(robot[:2], way.points[-1]) < END_M and len(way.points) < 2 * END_M / cell_m + 4
