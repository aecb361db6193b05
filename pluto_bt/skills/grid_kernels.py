"""Kernels that read a grid: under points, along lines, and a way that is drawn tight over it. Grids are those of `map_kernels`."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills.map_kernels import Array, Bytes, Floats


@kernel
def along_line(grid: Floats, i: float, j: float, to_i: float, to_j: float, count: int) -> Array:
    """The cells under `count` points evenly on the line from (i, j) to (to_i, to_j), ends included; beyond the edge the nearest cell."""
    most = grid.shape[0] - 1
    out = np.empty(count)
    for k in range(count):
        share = k / (count - 1)
        at_i, at_j = math.floor(i + share * (to_i - i)), math.floor(j + share * (to_j - j))
        out[k] = grid[min(max(at_i, 0), most), min(max(at_j, 0), most)]
    return out


@kernel
def under_points(grid: Floats, points: Array, cell_m: float, i0: int, j0: int) -> Array:
    """The cells under points (n, 2) in metres, of a grid whose first cell is (i0, j0); beyond the edge the nearest cell."""
    most = grid.shape[0] - 1
    out = np.empty(points.shape[0])
    for k in range(points.shape[0]):
        at_i, at_j = math.floor(points[k, 0] / cell_m) - i0, math.floor(points[k, 1] / cell_m) - j0
        out[k] = grid[min(max(at_i, 0), most), min(max(at_j, 0), most)]
    return out


@kernel
def all_free(evidence: Bytes, points: Array, cell_m: float, i0: int, j0: int) -> bool:
    """Whether all cells under points (n, 2) in metres were seen free; beyond the edge the nearest cell."""
    most = evidence.shape[0] - 1
    for k in range(points.shape[0]):
        at_i, at_j = math.floor(points[k, 0] / cell_m) - i0, math.floor(points[k, 1] / cell_m) - j0
        if evidence[min(max(at_i, 0), most), min(max(at_j, 0), most)] >= 0:
            return False
    return True


@kernel
def under_places(grid: Floats, points: Array, origin: tuple[float, float, float], cell_m: float) -> Array:
    """The cells under points (n, 2) in metres, as lengths, of a grid that lies as `maps.raster.Frame` says; 0 beyond its edge."""
    out = np.zeros(points.shape[0])
    c, s = math.cos(origin[2]), math.sin(origin[2])
    for k in range(points.shape[0]):
        out[k] = length_at(grid, points[k, 0] - origin[0], points[k, 1] - origin[1], c, s, cell_m)
    return out


@inline_kernel
def length_at(grid: Floats, dx_m: float, dy_m: float, c: float, s: float, cell_m: float) -> float:
    """The cell of a grid under a place, as a length; (c, s) is the direction in which its columns count. 0 beyond its edge."""
    row, column = (c * dy_m - s * dx_m) / cell_m, (c * dx_m + s * dy_m) / cell_m
    if 0.0 <= row < grid.shape[0] and 0.0 <= column < grid.shape[1]:
        return float(grid[int(row), int(column)] * np.float32(cell_m))
    return 0.0


@kernel
def draw_tight(way: Array, room_m: Array, rounds: int, pull: float, grid: Floats, origin: tuple[float, float, float], cell_m: float) -> None:
    """Draw each point of a way (n, 2) to the middle of its neighbours, by the share `pull` in each round, but never to where it has less room
    than `room_m` (n,) says. The grid is that of `under_places`; the ends stay.
    """
    c, s, count = math.cos(origin[2]), math.sin(origin[2]), way.shape[0]
    for _ in range(rounds):
        old_x, old_y = way[0, 0], way[0, 1]  # of the point before, as it was before this round
        for k in range(1, count - 1):
            x, y = way[k, 0], way[k, 1]
            new_x = x + pull * (0.5 * (old_x + way[k + 1, 0]) - x)
            new_y = y + pull * (0.5 * (old_y + way[k + 1, 1]) - y)
            if length_at(grid, new_x - origin[0], new_y - origin[1], c, s, cell_m) >= room_m[k]:
                way[k, 0], way[k, 1] = new_x, new_y
            old_x, old_y = x, y
