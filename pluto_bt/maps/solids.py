"""The solid things of a world as a few tables of numbers, in the form that the kernels read.

Each table is (n, columns) float64 and carries `height` (top above the ground, m) and `owner` (a row of `Solids.owners`).
A hole is a ring whose height is `HOLE_FLOOR_M`: it is there, but below everything that a robot or a level beam can touch.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.free_squares import free_squares
from pluto_bt.maps.world import OccupancyGrid, Points, Shape

Table = NDArray[np.float64]

HOLE_FLOOR_M = -1.0  # how deep a hole is: its floor is seen there
GRID_HEIGHT_M = 2.0  # how high the cells of a static map stand, as high as a shape without `height`
BLOCK = 32  # segments that share one bounding box
TILE_M = 8.0  # shapes are sorted by tiles of this size, so that the boxes stay small

# columns of `segments`
X1, Y1, X2, Y2, SEGMENT_HEIGHT, SEGMENT_OWNER = range(6)
# columns of `discs`; a negative radius marks a disc that is not there
DISC_X, DISC_Y, DISC_RADIUS, DISC_HEIGHT, DISC_OWNER = range(5)
# columns of `rings`: the closed outlines among the segments, rows FIRST to END - 1, and their boxes
FIRST, END, X_MIN, Y_MIN, X_MAX, Y_MAX, RING_HEIGHT, RING_OWNER = range(8)
# entries of `frame`: where the grid lies
GRID_X, GRID_Y, GRID_COS, GRID_SIN, GRID_RESOLUTION, GRID_HEIGHT = range(6)


@dataclass(frozen=True, slots=True)
class Solids:
    """The shapes that are present.

    Attributes:
        segments: (n, 6) edges of walls, polygons and holes, each shape's in a row.
        blocks: (ceil(n / BLOCK), 4) x_min, y_min, x_max, y_max of the segments of each block.
        rings: (k, 8) polygons and holes.
        discs: (m, 5) circles.
    """

    segments: Table
    blocks: Table
    rings: Table
    discs: Table


def solids_of(shapes: Iterable[tuple[int, Shape, Points]]) -> Solids:
    """Tables of the shapes given as (owner, shape, points where it stands now)."""
    segments: list[Table] = []
    rings: list[tuple[float, ...]] = []
    discs: list[tuple[float, ...]] = []
    row = 0
    for owner, shape, points in sorted(shapes, key=_tile):
        if shape.kind == "circle":
            discs.append((points[0, 0], points[0, 1], shape.radius_m, shape.height_m, owner))
            continue
        height_m = HOLE_FLOOR_M if shape.kind == "hole" else shape.height_m
        edges = _edges(points, shape.kind != "wall")
        segments.append(np.column_stack((edges, np.full(len(edges), height_m), np.full(len(edges), owner))))
        if shape.kind != "wall":
            rings.append((row, row + len(edges), *points.min(axis=0), *points.max(axis=0), height_m, owner))
        row += len(edges)
    rows = np.vstack(segments) if segments else np.zeros((0, 6))
    return Solids(rows, _boxes(rows), table_of(rings, 8), table_of(discs, 5))


def table_of(rows: Sequence[Sequence[float]], columns: int) -> Table:
    """(n, columns) float64, also without rows."""
    return np.array(rows, dtype=np.float64).reshape(len(rows), columns)


def grid_tables(grid: OccupancyGrid | None) -> tuple[NDArray[np.uint8], Table]:
    """The free squares of a grid and its frame; a grid without cells stands for none."""
    if grid is None:
        return np.zeros((4, 0, 0), dtype=np.uint8), np.array([0.0, 0.0, 1.0, 0.0, 1.0, GRID_HEIGHT_M])
    x_m, y_m, theta_rad = grid.origin
    return free_squares(grid.occupied), np.array([x_m, y_m, np.cos(theta_rad), np.sin(theta_rad), grid.resolution_m, GRID_HEIGHT_M])


def _tile(item: tuple[int, Shape, Points]) -> tuple[float, float, int]:
    owner, _, points = item
    return (float(points[0, 0] // TILE_M), float(points[0, 1] // TILE_M), owner)


def _edges(points: Points, closed: bool) -> Table:
    """(n, 4) x1, y1, x2, y2."""
    ends = np.roll(points, -1, axis=0) if closed else points[1:]
    return np.hstack((points[: len(ends)], ends))


def _boxes(rows: Table) -> Table:
    if not len(rows):
        return np.zeros((0, 4))
    starts = np.arange(0, len(rows), BLOCK)
    low = np.minimum(rows[:, X1 : Y1 + 1], rows[:, X2 : Y2 + 1])
    high = np.maximum(rows[:, X1 : Y1 + 1], rows[:, X2 : Y2 + 1])
    return np.hstack((np.minimum.reduceat(low, starts), np.maximum.reduceat(high, starts)))
