"""Compact things in a laser scan that stand free of what is behind them: people, posts, vehicles of our size."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pluto_bt.skills.outline import Array, Planar

APART_M = 0.3  # neighbouring beams that differ more end on different things; two legs are one person
FEWEST_BEAMS = 2


class Piece(NamedTuple):
    """The middle of the visible side of a thing, and how wide that is, in metres."""

    x_m: float
    y_m: float
    width_m: float


def pieces_of(ranges_m: Array, angle_min_rad: float, angle_step_rad: float, laser: Planar, reach_m: float, widest_m: float) -> list[Piece]:
    """The free-standing pieces of a scan, in the frame of `laser`, in the order of the beams.

    A piece is free-standing if the beams beside it end farther away: what somebody else half hides is none, and neither is a strip of wall
    beside a person's shadow.

    Args:
        ranges_m: (n,) metres; NaN, 0 and less say nothing.
        reach_m, widest_m: what is farther or wider is left out.
    """
    good = _mended(np.where(ranges_m > 0.0, ranges_m, np.inf))
    angles = angle_min_rad + angle_step_rad * np.arange(len(good)) + laser[2]
    near = good < reach_m
    finite = np.where(near, good, 0.0)
    x, y = laser[0] + finite * np.cos(angles), laser[1] + finite * np.sin(angles)
    gaps = ~near[1:] | ~near[:-1] | (np.hypot(np.diff(x), np.diff(y)) > APART_M)
    starts = np.concatenate(([0], 1 + np.flatnonzero(gaps)))
    ends = np.append(starts[1:], len(good))
    found = []
    for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
        if end - start < FEWEST_BEAMS or not near[start] or start == 0 or end == len(good):
            continue
        width_m = math.hypot(x[end - 1] - x[start], y[end - 1] - y[start])
        if width_m <= widest_m and good[start - 1] > good[start] and good[end] > good[end - 1]:
            found.append(Piece(float(x[start:end].mean()), float(y[start:end].mean()), width_m))
    return found


def _mended(ranges_m: Array) -> Array:
    """Single beams that miss the surface which both their neighbours see, lost or dazzled, put onto it: else they would cut a body in two."""
    left, middle, right = ranges_m[:-2], ranges_m[1:-1], ranges_m[2:]
    with np.errstate(invalid="ignore"):  # infinite ranges: their difference is no number, and no beam is put there
        agree = np.abs(left - right) < APART_M
        misses = agree & (np.minimum(np.abs(middle - left), np.abs(middle - right)) > APART_M)
    mended = ranges_m.copy()
    mended[1:-1][misses] = (0.5 * (left + right))[misses]
    return mended
