"""Where to steer on the way to a goal: the manual's vector sum proposes a heading, the freest heading near it is taken.

The sum: the goal pulls with the weight `force`, each direction in which something is nearer than the reach pushes away, the nearer the
harder. Only the part of the push across the goal's direction bends the way; the part against it would only cancel the goal
(the classic trap of the rule), and slowing down is left to the free way ahead. Then all headings are weighed: near to the sum's, near to
the last one, free for far enough, with room at the sides. The side once taken around an obstacle is kept until the goal is in the clear.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills.outline import Array, Outline

HEADINGS = 72
STEP_RAD = math.tau / HEADINGS
ENOUGH_M = 2.0  # a heading that is free so far counts as free
CLEAR_M = 0.04  # steering keeps so much farther away than the braking margin, which is thus touched only in need
ROOM_M = 0.35  # a heading with so much room on both sides could not have more
LOOK_M = 1.5  # how far ahead room at the sides counts
# the weights of a heading, in radians of detour that each is worth
BLOCKED_RAD, NARROW_RAD, CHANGE_RAD_PER_RAD, OTHER_SIDE_RAD = 3.0, 0.7, 0.2, 1.6
MEETING_MPS, MEETING_S = 0.5, 2.0  # how fast the robot goes to meet a walker, and how far ahead the walker's way is guessed
SIDE_TAKEN_RAD = math.radians(15.0)

_HEADINGS = -math.pi + STEP_RAD * np.arange(HEADINGS)


@dataclass(slots=True)
class Steering:
    """A decision: `heading_rad` relative to the robot's, how far the way is free on it, and how much room there is beside it; and `wish_rad`, the
    heading that a robot would take that could turn as it liked."""

    heading_rad: float
    free_m: float
    room_m: float
    goal_is_free: bool
    wish_rad: float


class Steer:
    """Chooses headings one after another; remembers the last one and the side taken, both in a frame that does not turn with the robot."""

    def __init__(self, outline: Outline) -> None:
        self._outline = outline
        self._headings: Array = np.append(_HEADINGS, 0.0)  # the last one is the goal's
        self.forget()

    def forget(self) -> None:
        """A new goal."""
        self._last_rad: float | None = None
        self._side = 0.0

    def choose(self, points: Array, goal_rad: float, goal_m: float, force: float, turnable_rad: tuple[float, float], heading_rad: float) -> Steering:
        """The heading to take.

        Args:
            points: (n, 5) obstacles in the robot frame: x, y, margin, velocity.
            goal_rad, goal_m: bearing and distance of the goal, robot frame.
            force: weight of the goal; > 1 weaker avoidance.
            turnable_rad: how far the robot can turn on the spot to the right and to the left, both positive.
            heading_rad: of the robot, in the frame in which decisions are remembered.
        """
        o = self._outline
        points = met(points, MEETING_MPS, MEETING_S)
        headings = self._headings
        headings[-1] = goal_rad
        ways = corridors(points, headings, o.front_m, o.back_m, o.side_m, LOOK_M, ENOUGH_M + 1.0)
        enough_m = min(ENOUGH_M, max(goal_m, 0.1))
        sum_rad = goal_rad + bend(points, goal_rad, o.side_m, force)
        change = self._last_rad is not None
        last_rad = wrap_angle(self._last_rad - heading_rad) if self._last_rad is not None else 0.0
        best = weigh(headings, ways, sum_rad, goal_rad, last_rad, change, self._side, enough_m, turnable_rad[0], turnable_rad[1])
        wish = weigh(headings, ways, sum_rad, goal_rad, last_rad, change, self._side, enough_m, math.pi, math.pi)
        chosen_rad, free_m, room_m = float(headings[best]), float(ways[0, best]), float(ways[1, best])
        goal_is_free = bool(ways[0, -1] >= enough_m)
        self._remember(chosen_rad, goal_rad, heading_rad, goal_is_free)
        return Steering(chosen_rad, free_m, room_m, goal_is_free, float(headings[wish]))

    def _remember(self, chosen_rad: float, goal_rad: float, heading_rad: float, goal_is_free: bool) -> None:
        self._last_rad = chosen_rad + heading_rad
        detour_rad = wrap_angle(chosen_rad - goal_rad)
        if goal_is_free:
            self._side = 0.0
        elif abs(detour_rad) > SIDE_TAKEN_RAD:  # also when the side taken proves the longer one: then the other counts as taken
            self._side = math.copysign(1.0, detour_rad)


@kernel
def met(points: Array, speed_mps: float, most_s: float) -> Array:
    """The points where they will be about when the robot gets there: what crosses is passed behind, what comes is avoided early."""
    out = points.copy()
    for i in range(points.shape[0]):
        if points[i, 3] != 0.0 or points[i, 4] != 0.0:
            distance_m = np.sqrt(points[i, 0] ** 2 + points[i, 1] ** 2) + 0.01
            closing_mps = -(points[i, 0] * points[i, 3] + points[i, 1] * points[i, 4]) / distance_m
            ahead_s = min(most_s, distance_m / (speed_mps + max(0.0, closing_mps)))
            out[i, 0] += points[i, 3] * ahead_s
            out[i, 1] += points[i, 4] * ahead_s
    return out


@kernel
def corridors(points: Array, headings: Array, front_m: float, back_m: float, side_m: float, look_m: float, far_m: float) -> Array:
    """For each heading, how far the outline can go straight on it, and how much room it has beside it: (2, m) metres.

    The free way is measured from the front edge after turning to the heading; a point counts if it lies within the outline's
    half width plus the point's margin. The room is what is left between outline and points on the first `look_m`, at most 1 m.
    """
    ways, cos, sin = np.zeros((2, headings.shape[0])), np.zeros(headings.shape[0]), np.zeros(headings.shape[0])
    for k in range(headings.shape[0]):
        cos[k], sin[k], ways[0, k], ways[1, k] = np.cos(headings[k]), np.sin(headings[k]), far_m, 1.0
    for i in range(points.shape[0]):
        stand_in_the_way(points[i, 0], points[i, 1], points[i, 2], cos, sin, front_m, back_m, side_m, look_m, far_m, ways[0], ways[1])
    return ways


@inline_kernel
def stand_in_the_way(
    x_m: float, y_m: float, margin_m: float, cos: Array, sin: Array, front_m: float, back_m: float, side_m: float, look_m: float, far_m: float,
    free_m: Array, room_m: Array,
) -> None:  # fmt: skip
    """Let one point shorten the ways of all headings (m,), given by their directions. Without a branch in the loop, so that it is vectorised."""
    for k in range(cos.shape[0]):
        ahead_m, gap_m = cos[k] * x_m + sin[k] * y_m, abs(cos[k] * y_m - sin[k] * x_m) - side_m
        is_beside = (ahead_m >= -back_m) & (ahead_m <= far_m + front_m)
        is_in_the_way, is_near = gap_m < margin_m + CLEAR_M, ahead_m < look_m
        to_it_m = ahead_m - front_m - margin_m
        to_it_m = to_it_m if to_it_m > 0.0 else 0.0
        free_m[k] = to_it_m if is_beside & is_in_the_way & (ahead_m > 0.0) & (to_it_m < free_m[k]) else free_m[k]
        room_m[k] = gap_m if is_beside & (not is_in_the_way) & is_near & (gap_m < room_m[k]) else room_m[k]


@kernel
def bend(points: Array, goal_rad: float, side_m: float, force: float) -> float:
    """How much the vector sum turns away from the goal: radians, counter-clockwise positive, less than 90 degrees.

    Each of 72 directions pushes once, with the nearest point in it, so that many beams on one post do not count for more than a few.
    """
    nearest = np.full(HEADINGS, 1e9)
    for i in range(points.shape[0]):
        x, y = points[i, 0], points[i, 1]
        sector = int((np.arctan2(y, x) + np.pi) / (2.0 * np.pi) * HEADINGS) % HEADINGS
        nearest[sector] = min(nearest[sector], np.sqrt(x * x + y * y))
    across = 0.0
    for k in range(HEADINGS):
        gap_m = max(0.1, nearest[k] - side_m)
        if gap_m < 3.0:
            bearing = (k + 0.5) * STEP_RAD - np.pi - goal_rad
            if np.cos(bearing) > -0.2:  # what lies behind does not push
                across -= np.sin(bearing) * (1.0 / gap_m - 1.0 / 3.0) * STEP_RAD
    return float(np.arctan(0.35 * across / max(0.05, force)))


@kernel
def weigh(
    headings: Array, ways: Array, sum_rad: float, goal_rad: float, last_rad: float, has_last: bool, side: float, enough_m: float,
    right_rad: float, left_rad: float,
) -> int:  # fmt: skip
    """Index of the heading with the least cost, all costs in radians of detour."""
    best, least = 0, 1e9
    for k in range(headings.shape[0]):
        heading = headings[k]
        if heading < -right_rad or heading > left_rad:
            continue
        detour = heading - goal_rad
        detour -= 2.0 * np.pi * np.round(detour / (2.0 * np.pi))
        off = heading - sum_rad
        off -= 2.0 * np.pi * np.round(off / (2.0 * np.pi))
        cost = abs(off) + BLOCKED_RAD * max(0.0, 1.0 - ways[0, k] / enough_m) + NARROW_RAD * max(0.0, 1.0 - ways[1, k] / ROOM_M)
        if has_last:
            change = heading - last_rad
            cost += CHANGE_RAD_PER_RAD * abs(change - 2.0 * np.pi * np.round(change / (2.0 * np.pi)))
        if side != 0.0 and detour * side < 0.0:
            cost += OTHER_SIDE_RAD
        if cost < least:
            best, least = k, cost
    return best
