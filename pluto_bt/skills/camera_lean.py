"""Where a path beside a wall should lean so that the camera keeps its distance: in pockets and between corners that follow each other closely.

A path at a distance from the wall keeps the robot's distance. The camera hangs beside and behind it and swings with each turn, so between two
bends it may be left far from everything. Here the path is shifted sideways, by `lean` at each of its stations, such that the camera comes as
near to its distance as a smooth path allows: nonlinear least squares by Gauss and Newton.

    lean_i   shift of station i to its left, towards the wall
    e_k      how much too far the camera is, less `SPARE_M` on either side: at each station with the robot pointing along the piece of path
             before it, along the one after it, and between the two, so that no swing at a bend is left out
    cost = Σ w e² + STAY Σ lean² + SMOOTH Σ (second difference of lean)², where w = 1 + (e / PEAK_M)² of the round before, `NEAR` times
    that where the camera is too near

Ref: Nocedal, Wright, Numerical Optimization, section 10.3.
"""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.skills.outline import Array

Indices = NDArray[np.intp]

SPACING_M = 0.15  # between stations …
BEHIND_M, AHEAD_M = 0.0, 3.0
SPARE_M = 0.1  # so far off the camera may be without any lean
STAY, SMOOTH, PEAK_M = 0.06, 1.0, 0.4
NEAR = 6.0  # times as bad is a camera too near as one too far
ROUNDS = 4  # one without a lean, one with the guess, the rest are steps
LEANING_M = 0.6  # over so much way the guess comes and goes


def leaned(path: Array, foot: int, points: Array, camera_m: tuple[float, float, float], limits_m: tuple[float, float]) -> Array:
    """The path (n, 3 or more) x, y, heading, …, leaning by least and most `limits_m` from `foot` on; headings are those of the new path.

    Args:
        foot: the point of the path where the robot is.
        points: (m, 2) what stands.
        camera_m: x, y of the camera in the robot frame, and the distance that it keeps.
    """
    way_m = _way_m(path)
    stations_m = np.arange(way_m[foot], min(way_m[-1], way_m[foot] + AHEAD_M), SPACING_M)
    if len(stations_m) < 3:
        return path
    x, y, headings = (np.interp(stations_m, way_m, path[:, k]) for k in range(3))
    base, left = np.column_stack((x, y)), np.column_stack((-np.sin(headings), np.cos(headings)))
    reach_m = camera_m[2] + math.hypot(*camera_m[:2]) + limits_m[1] + LEANING_M  # what is farther away is nowhere the nearest
    is_near = ((base[:, :1] - points[:, 0]) ** 2 + (base[:, 1:] - points[:, 1]) ** 2).min(axis=0) < reach_m**2
    lean = _best_lean(base, left, points[is_near], camera_m, limits_m) if is_near.any() else np.zeros(0)
    return path if not lean.any() else _shifted(path, np.interp(way_m, stations_m, lean))


def _best_lean(base: Array, left: Array, points: Array, camera_m: tuple[float, float, float], limits_m: tuple[float, float]) -> Array:
    """(n,) the lean that leaves the camera least far off, of none, a first guess, and what Gauss and Newton make of the guess.

    The guess is needed since between two walls that are equally far neither is nearer, and no small step to a side mends anything.
    """
    lean, best, least = np.zeros(len(base)), np.zeros(len(base)), np.inf
    stiff = _stiffness(len(base))
    for k in range(ROUNDS):
        off_m, slope = _camera(base + lean[:, None] * left, left, points, camera_m)
        off_m -= np.clip(off_m, -SPARE_M, SPARE_M)
        weight = np.where(off_m < 0.0, NEAR, 1.0) * (1.0 + (off_m / PEAK_M) ** 2)
        cost = float((weight * off_m**2).sum())
        if cost < least:
            least, best = cost, lean
        if least == 0.0:
            break
        if k == 0:
            lean = _guess(off_m, len(base))
        else:
            weighed = slope.T * weight
            lean = lean - np.linalg.solve(weighed @ slope + stiff, weighed @ off_m + stiff @ lean)
        lean = np.clip(lean, *limits_m)
    return best


def _guess(off_m: Array, count: int) -> Array:
    """As much nearer as the camera is too far away, coming and going over `LEANING_M`."""
    over_m = np.zeros(count)
    np.maximum.at(over_m, _postures(count)[0], off_m)
    apart = np.abs(np.arange(count)[:, None] - np.arange(count)) * (SPACING_M / LEANING_M)
    return np.asarray((over_m * np.maximum(1.0 - apart, 0.0)).max(axis=1))


def _shifted(path: Array, lean_m: Array) -> Array:
    """The path, shifted to its left, with points and headings anew at even distances."""
    places = path[:, :2] + lean_m[:, None] * np.column_stack((-np.sin(path[:, 2]), np.cos(path[:, 2])))
    way_m = _way_m(places)
    even_m = np.linspace(0.0, way_m[-1], len(path))
    out = path[np.searchsorted(way_m, even_m)]
    out[:, 0], out[:, 1] = np.interp(even_m, way_m, places[:, 0]), np.interp(even_m, way_m, places[:, 1])
    steps = np.gradient(out[:, :2], axis=0)
    out[:, 2] = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    return out


def _way_m(places: Array) -> Array:
    """(n,) how far it is to each place along the path."""
    return np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(places[:, :2], axis=0).T))))


def _camera(places: Array, left: Array, points: Array, camera_m: tuple[float, float, float]) -> tuple[Array, Array]:
    """(k,) how much too far the camera is from the nearest point, and (k, n) its slope over the leans."""
    x_m, y_m, away_m = camera_m
    at, back, front = _postures(len(places))
    rows = np.arange(len(at))
    steps = places[front] - places[back]
    lengths_m = np.maximum(np.hypot(steps[:, 0], steps[:, 1]), 0.25 * SPACING_M)
    c, s = (steps / lengths_m[:, None]).T
    arm = np.column_stack((c * x_m - s * y_m, s * x_m + c * y_m))
    camera = places[at] + arm
    gaps_x, gaps_y = camera[:, :1] - points[:, 0], camera[:, 1:] - points[:, 1]
    squares = gaps_x**2 + gaps_y**2
    nearest = squares.argmin(axis=1)
    away = np.maximum(np.sqrt(squares[rows, nearest]), 1e-3)
    out = np.column_stack((gaps_x[rows, nearest], gaps_y[rows, nearest])) / away[:, None]
    per_m = (out[:, 1] * arm[:, 0] - out[:, 0] * arm[:, 1]) / lengths_m
    slope = np.zeros((len(at), len(places)))
    slope[rows, at] = (out * left[at]).sum(axis=1)
    slope[rows, front] += per_m * (c * left[front, 1] - s * left[front, 0])
    slope[rows, back] -= per_m * (c * left[back, 1] - s * left[back, 0])
    return away - away_m, slope


@functools.lru_cache(maxsize=128)
def _postures(count: int) -> tuple[Indices, Indices, Indices]:
    """Stations at which the robot is thought to stand, and from which to which other it points then."""
    k = np.arange(count - 1)
    inner = k[1:]
    return np.concatenate((k, k + 1, inner)), np.concatenate((k, k, inner - 1)), np.concatenate((k + 1, k + 1, inner + 1))


@functools.lru_cache(maxsize=128)
def _stiffness(count: int) -> Array:
    """(n, n) of the costs of leaning at all, and of bending."""
    second = np.diff(np.eye(count), n=2, axis=0)
    return np.asarray(STAY * np.eye(count) + SMOOTH * second.T @ second)
