"""A world drawn into a grid: what a planner must keep away from, as the a-priori map tells it.

Walls, shapes, holes and what a scanned map shows are drawn; so are forbidden areas and lines, and all that lies outside the mapped areas
where the world has any. Actors, and things that come only later, are for the sensors.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.world import OccupancyGrid, Points, World

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw

FREE, UNKNOWN, OCCUPIED = -1, 0, 1
FINEST_M: Final = 0.05
MOST_CELLS: Final = 2048  # along one side
AROUND_M: Final = 5.0  # a world that is drawn goes on so far beyond its last shape

Cells = NDArray[np.int8]


@dataclass(frozen=True, slots=True)
class Frame:
    """Where a grid lies: `origin` (x m, y m, theta rad) of the corner of cell (0, 0) in the map; row along its y, column along its x."""

    origin: tuple[float, float, float]
    cell_m: float
    rows: int
    columns: int

    def to_cells(self, points: Points) -> Points:
        """Points (n, 2) of the map, as (row, column) with fractions."""
        x, y, theta = self.origin
        dx, dy = points[:, 0] - x, points[:, 1] - y
        c, s = math.cos(theta), math.sin(theta)
        return np.column_stack((c * dy - s * dx, c * dx + s * dy)) / self.cell_m

    def to_map(self, cells: Points) -> Points:
        """Points (n, 2) given as (row, column) with fractions, in the map."""
        x, y, theta = self.origin
        across, along = cells[:, 0] * self.cell_m, cells[:, 1] * self.cell_m
        c, s = math.cos(theta), math.sin(theta)
        return np.column_stack((x + c * along - s * across, y + s * along + c * across))

    def has(self, x_m: float, y_m: float) -> bool:
        """True if the point lies on the grid."""
        row, column = map(float, self.to_cells(np.array([[x_m, y_m]]))[0])
        return 0.0 <= row < self.rows and 0.0 <= column < self.columns


def frame_of(world: World, points: Iterable[tuple[float, float]]) -> Frame:
    """The grid that holds a world, and `points` where nothing says how far the world goes; as fine as it may be."""
    grid = world.grid
    if grid is not None:
        rows, columns = grid.occupied.shape
        step = max(1, math.ceil(max(rows, columns) / MOST_CELLS))
        return Frame(grid.origin, grid.resolution_m * step, math.ceil(rows / step), math.ceil(columns / step))
    x0, y0, x1, y1 = world.bounds_m()
    around = np.array([(x0, y0), (x1, y1), *points])
    low, size = around.min(axis=0) - AROUND_M, np.ptp(around, axis=0) + 2.0 * AROUND_M
    cell_m = max(FINEST_M, float(size.max()) / MOST_CELLS)
    columns, rows = (math.ceil(side_m / cell_m) for side_m in size.tolist())
    return Frame((float(low[0]), float(low[1]), 0.0), cell_m, rows, columns)


def drawn(world: World, frame: Frame) -> Cells:
    """FREE, UNKNOWN or OCCUPIED for each cell."""
    from PIL import Image, ImageDraw

    image = Image.new("L", (frame.columns, frame.rows), 0)
    pen = ImageDraw.Draw(image)
    mapped = [area.points for area in world.areas if area.kind == "map"]
    if mapped:
        pen.rectangle((0, 0, frame.columns, frame.rows), fill=1)
        for points in mapped:
            pen.polygon(_pixels(frame, points), fill=0)
    for area in world.areas:
        if area.kind == "forbidden":
            pen.polygon(_pixels(frame, area.points), fill=1, outline=1)
    for line in world.lines:
        if line.kind == "forbidden":
            pen.line(_pixels(frame, line.points), fill=1)
    _draw_shapes(pen, world, frame)
    blocked = np.asarray(image, dtype=np.uint8) != 0
    cells = np.full((frame.rows, frame.columns), FREE, dtype=np.int8)
    if world.grid is not None:
        _enter_grid(cells, world.grid)
    cells[blocked] = OCCUPIED
    return cells


def _draw_shapes(pen: ImageDraw, world: World, frame: Frame) -> None:
    for shape in world.shapes:
        pixels = _pixels(frame, shape.points)
        if shape.absent:
            continue
        if shape.kind == "wall":
            pen.line(pixels, fill=1)
        elif shape.kind == "circle":
            (x, y), r = pixels[0], shape.radius_m / frame.cell_m
            pen.ellipse((x - r, y - r, x + r, y + r), fill=1)
            pen.point((x, y), fill=1)
        else:
            pen.polygon(pixels, fill=1, outline=1)


def _pixels(frame: Frame, points: Points) -> list[tuple[float, float]]:
    """Points as an image has them: whole numbers are the middles of pixels."""
    return [(column - 0.5, row - 0.5) for row, column in frame.to_cells(points).tolist()]


def _enter_grid(cells: Cells, grid: OccupancyGrid) -> None:
    """Take over a scanned map, several of its cells for one if it is large: one occupied makes all occupied, one unknown all unknown."""
    rows, columns = grid.occupied.shape
    step = max(1, math.ceil(max(rows, columns) / MOST_CELLS))
    for di in range(step):
        for dj in range(step):
            occupied, unknown = grid.occupied[di::step, dj::step], grid.unknown[di::step, dj::step]
            part = cells[: occupied.shape[0], : occupied.shape[1]]
            part[(unknown != 0) & (part == FREE)] = UNKNOWN
            part[occupied != 0] = OCCUPIED
