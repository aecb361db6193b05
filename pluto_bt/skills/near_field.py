"""How far everything stands from the cells of a small grid: built once, then asked thousands of times.

Ref: P. Felzenszwalb, D. Huttenlocher, Distance Transforms of Sampled Functions, 2012: first along the rows, then across them.
"""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills.outline import Array

CELL_M = 0.06


@kernel
def near_field(points: Array, rows: int, columns: int, most_m: float) -> Array:
    """(rows, columns) metres from the middle of each cell to the cell of the nearest point; rows go along x.

    Args:
        points: (n, 2 or more) x m, y m from the middle of the first cell; those outside the grid count as standing nowhere.
        most_m: what is farther away is taken to be so far.
    """
    most = most_m / CELL_M
    along = np.full((rows, columns), most)
    for p in range(points.shape[0]):
        i, j = round(points[p, 0] / CELL_M), round(points[p, 1] / CELL_M)
        if 0 <= i < rows and 0 <= j < columns:
            along[i, j] = 0.0
    for i in range(rows):
        for j in range(1, columns):
            along[i, j] = min(along[i, j], along[i, j - 1] + 1.0)
        for j in range(columns - 2, -1, -1):
            along[i, j] = min(along[i, j], along[i, j + 1] + 1.0)
        for j in range(columns):
            along[i, j] *= along[i, j]
    field = along.copy()
    for i in range(rows):
        for other in range(max(0, i - int(most)), min(rows, i + int(most) + 1)):
            square = float((i - other) * (i - other))
            for j in range(columns):
                field[i, j] = min(field[i, j], along[other, j] + square)
    for i in range(rows):
        for j in range(columns):
            field[i, j] = CELL_M * math.sqrt(field[i, j])
    return field


@inline_kernel
def field_at(field: Array, x_m: float, y_m: float) -> float:
    """The field between the middles of four cells; places outside count as at its border."""
    x, y = min(max(x_m / CELL_M, 0.0), field.shape[0] - 1.001), min(max(y_m / CELL_M, 0.0), field.shape[1] - 1.001)
    i, j = int(x), int(y)
    u, v = x - i, y - j
    lower = field[i, j] + v * (field[i, j + 1] - field[i, j])
    upper = field[i + 1, j] + v * (field[i + 1, j + 1] - field[i + 1, j])
    away_m: float = lower + u * (upper - lower)
    return away_m
