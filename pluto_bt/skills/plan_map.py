"""The map as the planner sees it: how far each place is from what stands, with what the sensors have found laid over it."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from pluto_bt.maps.raster import OCCUPIED, Frame, drawn, frame_of
from pluto_bt.maps.world import World
from pluto_bt.skills.grid_kernels import draw_tight, under_places
from pluto_bt.skills.map_kernels import Floats, clearances
from pluto_bt.skills.outline import Array
from pluto_bt.skills.window import Cell

KNOWN_M = 0.3  # what is seen so near to what the map shows is the same thing
LOOK_M = 2.0  # clearances beyond this are all the same
_NEVER_S = 1.0


class PlanMap:
    """A grid of `cells` (FREE, UNKNOWN, OCCUPIED) and `clearance` (cells, up to `far_cells`), both with what was seen."""

    def __init__(self, world: World, points: Iterable[tuple[float, float]] = ()) -> None:
        self.frame: Frame = frame_of(world, points)
        self.cells = drawn(world, self.frame)
        self.far_cells = LOOK_M / self.frame.cell_m
        self._drawn = self.cells.copy()
        self._low_s: Floats = np.zeros(self.cells.shape, dtype=np.float32)
        self.clearance: Floats = np.full(self.cells.shape, self.far_cells, dtype=np.float32)
        self._refresh(0, self.frame.rows, 0, self.frame.columns)
        self._map_clearance = self.clearance.copy()
        self._seen: tuple[slice, slice] | None = None  # the window in which something is laid over the map
        self._last = np.zeros(0, dtype=np.intp)

    def lay_over(self, points: Array) -> None:
        """What the sensors see: points (n, 2) in metres of the map. Those that the map explains are passed over; those before are taken back."""
        cells = np.floor(self.frame.to_cells(points)).astype(np.intp)
        inside = (cells >= 0).all(axis=1) & (cells[:, 0] < self.frame.rows) & (cells[:, 1] < self.frame.columns)
        cells = cells[inside]
        is_new = self._map_clearance[cells[:, 0], cells[:, 1]] * self.frame.cell_m > KNOWN_M
        cells = cells[is_new]
        marks = np.unique(cells[:, 0] * self.frame.columns + cells[:, 1])
        if np.array_equal(marks, self._last):
            return
        self._last = marks
        self._take_back()
        if not len(cells):
            return
        self.cells[cells[:, 0], cells[:, 1]] = OCCUPIED
        keep = math.ceil(self.far_cells)
        i0, j0 = (max(0, int(low) - 2 * keep) for low in cells.min(axis=0))
        i1, j1 = (min(most, int(high) + 1 + 2 * keep) for high, most in zip(cells.max(axis=0), self.cells.shape, strict=True))
        self._seen = (slice(i0, i1), slice(j0, j1))
        self._refresh(i0, i1, j0, j1)

    def unexplained(self) -> Array:
        """Points (n, 2) of the map that are laid over it now."""
        columns = self.frame.columns
        return self.frame.to_map(np.column_stack((self._last // columns + 0.5, self._last % columns + 0.5)))

    def _take_back(self) -> None:
        if self._seen is not None:
            self.cells[self._seen] = self._drawn[self._seen]
            self.clearance[self._seen] = self._map_clearance[self._seen]
            self._seen = None

    def _refresh(self, i0: int, i1: int, j0: int, j1: int) -> None:
        clearances(self.cells, self._low_s, _NEVER_S, i0, i1, j0, j1, self.clearance, math.ceil(self.far_cells), self.far_cells)

    def cell(self, x_m: float, y_m: float) -> Cell:
        """The cell of a point of the map, which must lie on it."""
        row, column = np.floor(self.frame.to_cells(np.array([[x_m, y_m]]))).astype(np.intp)[0].tolist()
        return Cell(row, column)

    def clearances_m(self, points: Array) -> Array:
        """Distance to what stands, at points (n, 2) of the map; 0 beyond its edge."""
        return under_places(self.clearance, np.ascontiguousarray(points), self.frame.origin, self.frame.cell_m)


def warm() -> None:
    """Compile what asks a map, so that no plan waits for it; all else the local map has compiled already."""
    grid, at, origin = np.zeros((1, 1), dtype=np.float32), np.zeros((1, 2)), (0.0, 0.0, 0.0)
    draw_tight(at, under_places(grid, at, origin, 1.0), 1, 0.5, grid, origin, 1.0)
