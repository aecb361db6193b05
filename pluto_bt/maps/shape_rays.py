"""Beams of a fan against one upright thing: a wall from the ground to a height, a disc, the top of either.

Points are in the laser's frame on the ground, `z` is the laser's height, `out` holds the nearest level distance so far (n,).
A beam of slope s is at height z + s * t after t level metres; it meets what is not lower than that. Sides of a point are judged by
one product that neighbouring walls share, so that no beam slips through between two walls that share a corner.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.fan import DIRECTION_X, DIRECTION_Y, HEAD, LAST_RAD, SLOPE, beams_within, sight
from pluto_bt.maps.kernel import inline_kernel, kernel

Table = NDArray[np.float64]


@inline_kernel
def cast_wall(fan: Table, out: Table, x1: float, y1: float, x2: float, y2: float, z: float, height: float) -> None:
    """Shorten the beams that meet the wall from (x1, y1) to (x2, y2)."""
    low, high = sight(fan, x1, y1, x2, y2)
    cross = x1 * y2 - x2 * y1
    edge_on = cross * cross <= 1e-8 * (x1 * x1 + y1 * y1) * (x2 * x2 + y2 * y2)
    while low <= fan[HEAD, LAST_RAD]:
        first, end = beams_within(fan, out.shape[0], low, high)
        if edge_on:
            for i in range(first, end):
                t = wall_range(fan[DIRECTION_X, i], fan[DIRECTION_Y, i], x1, y1, x2, y2)
                if 0.0 <= t < out[i] and z + fan[SLOPE, i] * t <= height:
                    out[i] = t
        else:  # the same without branches, for several beams at a time
            for i in range(np.uintp(first), np.uintp(max(first, end))):
                dx, dy = fan[DIRECTION_X, i], fan[DIRECTION_Y, i]
                side1, side2 = dx * y1 - dy * x1, dx * y2 - dy * x2
                along1, along2 = dx * x1 + dy * y1, dx * x2 + dy * y2
                t = along1 + (along2 - along1) * (side1 / (side1 - side2))
                meets = (side1 * side2 <= 0.0) & (t >= 0.0) & (t < out[i]) & (z + fan[SLOPE, i] * t <= height)
                out[i] = t if meets else out[i]
        low += 2.0 * math.pi
        high += 2.0 * math.pi


@inline_kernel
def wall_range(dx: float, dy: float, x1: float, y1: float, x2: float, y2: float) -> float:
    """Distance from the origin along the unit (dx, dy) to a segment; negative if it does not meet it."""
    side1, side2 = dx * y1 - dy * x1, dx * y2 - dy * x2
    if side1 * side2 > 0.0:
        return -1.0
    along1, along2 = dx * x1 + dy * y1, dx * x2 + dy * y2
    if side1 != side2:
        return along1 + (along2 - along1) * (side1 / (side1 - side2))
    if side1 != 0.0 or max(along1, along2) < 0.0:  # not in line with it (the product was too small to be told from 0), or behind
        return -1.0
    return max(0.0, min(along1, along2))


@inline_kernel
def cast_disc(fan: Table, out: Table, x: float, y: float, radius: float, z: float, height: float) -> None:
    """Shorten the beams that meet the rim of a disc from outside."""
    tangent2 = x * x + y * y - radius * radius
    if tangent2 <= 0.0:
        return
    tangent = math.sqrt(tangent2)
    low, high = sight(fan, x * tangent + y * radius, y * tangent - x * radius, x * tangent - y * radius, y * tangent + x * radius)
    while low <= fan[HEAD, LAST_RAD]:
        first, end = beams_within(fan, out.shape[0], low, high)
        for i in range(first, end):
            t = disc_range(fan[DIRECTION_X, i], fan[DIRECTION_Y, i], x, y, radius)
            if 0.0 <= t < out[i] and z + fan[SLOPE, i] * t <= height:
                out[i] = t
        low += 2.0 * math.pi
        high += 2.0 * math.pi


@inline_kernel
def disc_range(dx: float, dy: float, x: float, y: float, radius: float) -> float:
    """Distance from the origin along the unit (dx, dy) to the near rim of a disc; negative if it does not meet it."""
    across = dx * y - dy * x
    depth2 = radius * radius - across * across
    return dx * x + dy * y - math.sqrt(depth2) if depth2 >= 0.0 else -1.0


@kernel
def land_on_disc(fan: Table, out: Table, x: float, y: float, radius: float, z: float, height: float) -> None:
    """Shorten the beams that come down on the top of a disc lower than the laser."""
    for i in range(out.shape[0]):
        if fan[SLOPE, i] < 0.0:
            t = (height - z) / fan[SLOPE, i]
            if t < out[i] and math.hypot(fan[DIRECTION_X, i] * t - x, fan[DIRECTION_Y, i] * t - y) <= radius:
                out[i] = t
