"""Where a robot should turn on the spot, and where it should leave its path and come back to it, so that its camera keeps its distance.

Each of some places is tried, with each way there and back:

    cost = ∫ c over the way of the camera: on the path, on the straight legs to the place and back, and wherever the robot turns on the spot,
           also from where it points now
           + `TURN` |turns| + `LEG` (length of the legs)
    c    = e² (1 + (e / PEAK_M)⁸) of the camera's error e beyond `SPARE_M`, too far or too near

So the farthest off counts nearly alone where it is large, and the way for which it is off where it is small.
"""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills.near_field import field_at
from pluto_bt.skills.outline import Array

SPARE_M = 0.07  # so far off costs nothing
PEAK_M = 0.15  # what is farther off counts far more
TURN, LEG = 0.004, 0.02
LEFT_RAD = 0.5 * math.pi  # at the place the robot turns to the right, away from the wall, or not farther than this to the left
BINS = 36  # of headings, all around
SAMPLE_M = 0.08  # along legs
EVERY = 3  # of so many rows of the path one is tried
NEVER = 1e9


@kernel
def search(
    robot: Array, path: Array, corner: int, places: Array, field: Array, camera: Array, least_m: float, turn_m: float, most: float
) -> tuple[int, int, int, float]:
    """The best place, the rows of the path where the robot leaves it and comes back to it, and what that costs; place -1 where there is none.

    Args:
        robot: x m, y m from the middle of the field's first cell, heading rad: a way there may also begin at the robot, which is row -1.
        path: (n, 3) the same of the way before the robot.
        corner: the row of the path before which the robot leaves it, and after which it comes back; -1 = only the robot leaves.
        places: (m, 2) x m, y m.
        field: of what stands (`near_field.py`).
        camera: x m, y m in the robot frame, and the distance to keep.
        least_m, turn_m: so near the robot's middle may come to what stands on its way, and where it turns.
        most: only what costs less counts; the less, the sooner a place is done with.
    """
    n, beyond = path.shape[0], max(corner, 0)
    so_far, swing = _along(field, path, camera), np.zeros(BINS + 1)
    to_costs, to_headings, back_costs, back_headings = np.zeros(n + 1), np.zeros(n + 1), np.zeros(n), np.zeros(n)
    begin = _kink(field, robot[0], robot[1], robot[2], path[0, 2], camera)
    place, leave, join, least = -1, -1, -1, min(most, NEVER)
    for p in range(places.shape[0]):
        x, y = places[p, 0], places[p, 1]
        if field_at(field, x, y) < turn_m:
            continue
        cheapest = _ways_there(field, robot, path, corner, x, y, camera, least_m, begin, so_far, to_costs, to_headings)
        if cheapest >= least:
            continue
        _ways_back(field, path, beyond, x, y, camera, least_m, so_far, back_costs, back_headings)
        _swing(field, x, y, camera, swing)
        for i in range(-1, corner + 1, EVERY):
            for j in range(beyond, n, EVERY):
                cost = to_costs[i + 1] + back_costs[j]
                if cost < least:
                    cost += _turn(swing, to_headings[i + 1], back_headings[j])
                    if cost < least:
                        least, place, leave, join = cost, p, i, j
    return place, leave, join, least


@kernel
def path_cost(robot: Array, path: Array, field: Array, camera: Array) -> float:
    """What the path (n, 3) costs as it is, with the robot's turn to where it points."""
    cost: float = _kink(field, robot[0], robot[1], robot[2], path[0, 2], camera) + _along(field, path, camera)[-1]
    return cost


@inline_kernel
def _fault(field: Array, x_m: float, y_m: float, heading_rad: float, camera: Array) -> float:
    """c of a robot at a place."""
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    off_m = field_at(field, x_m + c * camera[0] - s * camera[1], y_m + s * camera[0] + c * camera[1]) - camera[2]
    over_m = max(0.0, abs(off_m) - SPARE_M)
    cost: float = over_m**2 * (1.0 + (over_m / PEAK_M) ** 8)
    return cost


@kernel
def _along(field: Array, path: Array, camera: Array) -> Array:
    """(n,) what the path costs up to each of its rows."""
    arm_m = math.hypot(camera[0], camera[1])
    sums = np.zeros(path.shape[0])
    for k in range(1, path.shape[0]):
        turn_rad = abs(_wrapped(path[k, 2] - path[k - 1, 2]))
        way_m = math.hypot(path[k, 0] - path[k - 1, 0], path[k, 1] - path[k - 1, 1]) + arm_m * turn_rad
        sums[k] = sums[k - 1] + way_m * _fault(field, path[k, 0], path[k, 1], path[k, 2], camera) + TURN * turn_rad
    return sums


@inline_kernel
def _leg(field: Array, x_m: float, y_m: float, to_x_m: float, to_y_m: float, camera: Array, least_m: float) -> float:
    """What a straight way costs; `NEVER` where there is no room for it."""
    length_m = math.hypot(to_x_m - x_m, to_y_m - y_m)
    heading_rad = math.atan2(to_y_m - y_m, to_x_m - x_m)
    count = 1 + int(length_m / SAMPLE_M)
    cost = 0.0
    for k in range(count):
        share = (k + 0.5) / count
        x, y = x_m + share * (to_x_m - x_m), y_m + share * (to_y_m - y_m)
        if field_at(field, x, y) < least_m:
            return NEVER
        cost += _fault(field, x, y, heading_rad, camera)
    return length_m * (cost / count + LEG)


@inline_kernel
def _ways_there(
    field: Array, robot: Array, path: Array, corner: int, x: float, y: float, camera: Array, least_m: float, begin: float, so_far: Array,
    costs: Array, headings: Array,
) -> float:  # fmt: skip
    """Fill in what the way to a place costs, from the robot (entry 0) and from rows of the path (1 more than the row), and the heading there.

    Returns: the least cost.
    """
    cheapest = NEVER
    for i in range(-1, corner + 1, EVERY):
        from_x, from_y, heading = (robot[0], robot[1], robot[2]) if i < 0 else (path[i, 0], path[i, 1], path[i, 2])
        headings[i + 1] = _heading(from_x, from_y, x, y, heading)
        costs[i + 1] = _leg(field, from_x, from_y, x, y, camera, least_m) + (begin + so_far[i] if i >= 0 else 0.0)
        costs[i + 1] += _kink(field, from_x, from_y, heading, headings[i + 1], camera)
        cheapest = min(cheapest, costs[i + 1])
    return cheapest


@inline_kernel
def _ways_back(
    field: Array, path: Array, beyond: int, x: float, y: float, camera: Array, least_m: float, so_far: Array, costs: Array, headings: Array
) -> None:
    """Fill in what the way back from a place to rows of the path costs, and the heading from there."""
    n = path.shape[0]
    for j in range(beyond, n, EVERY):
        headings[j] = _heading(x, y, path[j, 0], path[j, 1], path[j, 2])
        costs[j] = _leg(field, x, y, path[j, 0], path[j, 1], camera, least_m) + so_far[n - 1] - so_far[j]
        costs[j] += _kink(field, path[j, 0], path[j, 1], headings[j], path[j, 2], camera)


@inline_kernel
def _heading(x_m: float, y_m: float, to_x_m: float, to_y_m: float, else_rad: float) -> float:
    """The heading of a leg; that of the path where there is hardly one."""
    return math.atan2(to_y_m - y_m, to_x_m - x_m) if math.hypot(to_x_m - x_m, to_y_m - y_m) > 0.5 * SAMPLE_M else else_rad


@inline_kernel
def _kink(field: Array, x_m: float, y_m: float, from_rad: float, to_rad: float, camera: Array) -> float:
    """What the shorter turn between path and leg costs."""
    turn_rad = _wrapped(to_rad - from_rad)
    count = 1 + int(abs(turn_rad) * BINS / math.tau)
    cost = 0.0
    for k in range(count):
        cost += _fault(field, x_m, y_m, from_rad + (k + 0.5) / count * turn_rad, camera)
    return abs(turn_rad) * (math.hypot(camera[0], camera[1]) * cost / count + TURN)


@inline_kernel
def _swing(field: Array, x_m: float, y_m: float, camera: Array, sums: Array) -> None:
    """Fill `sums` (BINS + 1) with ∫ c of a turn on the spot from heading 0 on."""
    bin_rad = math.tau / BINS
    arc_m = bin_rad * math.hypot(camera[0], camera[1])
    for k in range(BINS):
        sums[k + 1] = sums[k] + arc_m * _fault(field, x_m, y_m, (k + 0.5) * bin_rad, camera)


@inline_kernel
def _turn(sums: Array, from_rad: float, to_rad: float) -> float:
    """What the turn at the place costs, of the sums of `_swing`."""
    turn_rad = (to_rad - from_rad - LEFT_RAD) % math.tau - math.tau + LEFT_RAD
    return TURN * abs(turn_rad) + abs(_swung(sums, from_rad + turn_rad) - _swung(sums, from_rad))


@inline_kernel
def _swung(sums: Array, heading_rad: float) -> float:
    """The sum up to a heading between two bins, in turns that go on."""
    bins = heading_rad * BINS / math.tau
    rounds = math.floor(bins / BINS)
    k = min(int(bins - rounds * BINS), BINS - 1)
    swung: float = rounds * sums[BINS] + sums[k] + (bins - rounds * BINS - k) * (sums[k + 1] - sums[k])
    return swung


@inline_kernel
def _wrapped(angle_rad: float) -> float:
    return (angle_rad + math.pi) % math.tau - math.pi
