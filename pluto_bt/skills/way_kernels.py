"""The search for a way over a grid: cheapest first, in cells. Places are flat indices `i * columns + j`."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills.map_kernels import Bytes, Counts, Floats

Array = NDArray[np.float64]

HOME_X, HOME_Y, COS, SIN, BASE, HEIGHT, EDGE = range(7)  # of the rectangle, in cells; BASE <= 0 = there is none
NARROW, MIDDLE, UNKNOWN = 3.0, 1.0, 0.3  # what a step costs more: where it is narrower than a path, beside the middle of the street, unseen
TIGHT = 6.0  # where the robot stands nearer to something than the narrowest way allows
SETTLED = -np.inf  # the cost of a place that is done with, else a greedy search goes over the same ground again and again where no way leads on
ROUGH = 0.5  # cells: so much a wall of cells is rougher than the wall
SIDE = 2  # a place is worth going to if much of the block of (2 * SIDE + 1)² cells around it is not covered
WORTH = 0.4


@inline_kernel
def inside_m(i: int, j: int, rectangle: Array) -> float:
    """How many cells a cell lies inside the nearest side of the rectangle."""
    dx, dy = i + 0.5 - rectangle[HOME_X], j + 0.5 - rectangle[HOME_Y]
    x, y = rectangle[COS] * dx + rectangle[SIN] * dy, rectangle[COS] * dy - rectangle[SIN] * dx
    return float(min(min(x, rectangle[HEIGHT] - x), rectangle[BASE] - abs(y)))


@kernel
def push(keys: Floats, places: Counts, count: int, key: float, place: int) -> int:
    """Put an entry on the heap; gives the new count. A full heap drops it."""
    if count >= keys.shape[0]:
        return count
    at = count
    while at > 0:
        up = (at - 1) // 2
        if keys[up] <= key:
            break
        keys[at], places[at] = keys[up], places[up]
        at = up
    keys[at], places[at] = key, place
    return count + 1


@kernel
def pop(keys: Floats, places: Counts, count: int) -> int:
    """Take the first entry off the heap: it is moved behind the end, at `count - 1`, which is the new count."""
    count -= 1
    first_key, first_place = keys[0], places[0]
    key, place = keys[count], places[count]
    at = 0
    while True:
        down = 2 * at + 1
        if down >= count:
            break
        if down + 1 < count and keys[down + 1] < keys[down]:
            down += 1
        if keys[down] >= key:
            break
        keys[at], places[at] = keys[down], places[down]
        at = down
    keys[at], places[at] = key, place
    keys[count], places[count] = first_key, first_place
    return count


@kernel
def is_worth(i: int, j: int, covered: Bytes, evidence: Bytes, rectangle: Array) -> bool:
    """True if much around a cell that is not covered itself is not covered either, and lies inside the rectangle."""
    size = covered.shape[0]
    if covered[i, j] != 0:
        return False
    new, all_ = 0, 0
    for a in range(max(0, i - SIDE), min(size, i + SIDE + 1)):
        for b in range(max(0, j - SIDE), min(size, j + SIDE + 1)):
            if rectangle[BASE] <= 0.0 or inside_m(a, b, rectangle) >= 0.0:
                all_ += 1
                if covered[a, b] == 0 and evidence[a, b] <= 0:
                    new += 1
    return all_ > 0 and new >= WORTH * all_


@inline_kernel
def as_tight_as(clearance: float, least: float) -> float:
    """The least clearance of a way beside its start or its goal: no gap that is tighter than that place itself is passed on the way there."""
    return float(min(least, max(1.0, clearance - ROUGH)))


@inline_kernel
def is_end(
    i: int, j: int, goal: tuple[int, int], goal_reach: float, clearance: Floats, room: float, covered: Bytes, evidence: Bytes, rectangle: Array
) -> bool:
    """Whether a way that is looked for may end at a cell; the arguments are those of `search`."""
    if goal_reach >= 0.0:
        return math.hypot(goal[0] - i, goal[1] - j) <= goal_reach
    return bool(clearance[i, j] >= room and is_worth(i, j, covered, evidence, rectangle))


@inline_kernel
def may_pass(
    i: int, j: int, free: float, start: tuple[int, int], goal: tuple[int, int], goal_reach: float, rectangle: Array, least: float,
    least_at_start: float, least_at_goal: float, relaxed: float,
) -> bool:  # fmt: skip
    """Whether a way may lead over a cell with so much clearance: inside the rectangle, and with no less room than is asked for there."""
    if not (free < least or rectangle[BASE] > 0.0):
        return True
    is_begun = math.hypot(i - start[0], j - start[1]) <= relaxed
    is_ending = goal_reach >= 0.0 and math.hypot(i - goal[0], j - goal[1]) <= relaxed
    if free < min(least_at_start if is_begun else least, least_at_goal if is_ending else least):
        return False
    is_home = math.hypot(i - rectangle[HOME_X], j - rectangle[HOME_Y]) <= relaxed  # the base runs through it
    edge = -0.5 if is_begun or is_ending or is_home else rectangle[EDGE]
    return not (rectangle[BASE] > 0.0 and inside_m(i, j, rectangle) < edge)


@inline_kernel
def dearness(free: float, is_unknown: bool, least: float, half: float, wide: float) -> float:
    """What a step to a cell with so much clearance costs, a cell long."""
    factor = 1.0 + MIDDLE * max(0.0, wide - free) / (wide - least) + (UNKNOWN if is_unknown else 0.0)
    if free < half:
        factor += NARROW * (half - max(free, least)) / (half - least) + (TIGHT if free < least else 0.0)
    return float(factor)


@kernel
def search(
    evidence: Bytes, covered: Bytes, clearance: Floats, start: tuple[int, int], goal: tuple[int, int], goal_reach: float, rectangle: Array,
    least: float, half: float, wide: float, relaxed: float, room: float, greed: float, cost: Floats, came: Counts, keys: Floats, places: Counts,
) -> int:  # fmt: skip
    """The cheapest way from `start` to within `goal_reach` of `goal`, or (goal_reach < 0) to the nearest place worth covering.

    Args:
        least: clearance without which nothing passes. Within `relaxed` of a start or a goal that has less itself as little as it has will do.
        room: clearance that a place worth covering must have, so that the robot can turn there.
        half: clearance of an open path; narrower costs more. wide: clearance from which on more is not better.
        greed: so many times the rest of the way counts; above 1 far fewer cells are looked at, and the way is hardly longer: at most
            so many times as dear, although no place is looked at twice.
        cost, came, keys, places: working memory; `came` holds the way back, place by place.
    Returns: the place where the way ends, or -1.
    """
    rows, columns = evidence.shape
    for i in range(rows):
        for j in range(columns):
            cost[i * columns + j] = np.inf
    begin = start[0] * columns + start[1]
    cost[begin], came[begin] = 0.0, begin
    count = push(keys, places, 0, 0.0, begin)
    least_at_start = as_tight_as(clearance[start[0], start[1]], least)
    least_at_goal = as_tight_as(clearance[goal[0], goal[1]], least) if goal_reach >= 0.0 else least
    while count > 0:
        count = pop(keys, places, count)
        at = int(places[count])
        here, cost[at] = cost[at], SETTLED
        if here == SETTLED:
            continue
        i, j = at // columns, at % columns
        if is_end(i, j, goal, goal_reach, clearance, room, covered, evidence, rectangle):
            return at
        for di in range(-1, 2):
            for dj in range(-1, 2):
                a, b = i + di, j + dj
                if (di == 0 and dj == 0) or not (0 <= a < rows and 0 <= b < columns) or evidence[a, b] > 0:
                    continue
                to = a * columns + b
                step = 1.0 if di == 0 or dj == 0 else 1.41421356
                if cost[to] <= here + step:
                    continue  # settled, or known as near already as any step from here could bring it
                free = clearance[a, b]
                if not may_pass(a, b, free, start, goal, goal_reach, rectangle, least, least_at_start, least_at_goal, relaxed):
                    continue
                new = here + dearness(free, evidence[a, b] == 0, least, half, wide) * step
                if new < cost[to] - 1e-4:
                    cost[to], came[to] = new, at
                    ahead = greed * max(0.0, math.hypot(goal[0] - a, goal[1] - b) - goal_reach) if goal_reach >= 0.0 else 0.0
                    count = push(keys, places, count, new + ahead, to)
    return -1
