"""The cells of a local map: where they lie, what is known of them, and questions about that.

The grid lies in the frame of dead reckoning and goes along with the robot.
"""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.skills.grid_kernels import all_free, along_line, under_points
from pluto_bt.skills.grid_shift import shift
from pluto_bt.skills.map_kernels import Bytes, Floats
from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.walked_ground import Indices, cells_beside
from pluto_bt.skills.window import Cell

CELLS = 640  # of one side
NEVER_S = -1.0


class LocalGrid:
    """Square cells of `cell_m`; the first one is (`i0`, `j0`), in cells from the origin of dead reckoning.

    Attributes:
        evidence: > 0 = something stands there, < 0 = seen free. covered: 1 = explored. low_s: when something low was seen, `NEVER_S` = never.
        clearance: cells to the nearest thing, at most `far_cells`.
    """

    def __init__(self, cell_m: float, far_cells: float) -> None:
        self.cell_m, self.far_cells = cell_m, far_cells
        self.i0 = self.j0 = 0
        self.blank()

    def blank(self) -> None:
        """Nothing is known."""
        self.evidence: Bytes = np.zeros((CELLS, CELLS), dtype=np.int8)
        self.covered: Bytes = np.zeros((CELLS, CELLS), dtype=np.int8)
        self.low_s: Floats = np.full((CELLS, CELLS), NEVER_S, dtype=np.float32)
        self._first_s: Floats = np.full((CELLS, CELLS), NEVER_S, dtype=np.float32)
        self.clearance: Floats = np.full((CELLS, CELLS), self.far_cells, dtype=np.float32)
        self._touched: Bytes = np.zeros((CELLS, CELLS), dtype=np.int8)
        self._stands: Bytes = np.zeros((CELLS, CELLS), dtype=np.int8)  # 1 = what `clearance` was reckoned with

    def lay(self, middle: Planar) -> None:
        """Put the middle of a grid in which nothing is known here."""
        self.i0, self.j0 = math.floor(middle[0] / self.cell_m) - CELLS // 2, math.floor(middle[1] / self.cell_m) - CELLS // 2

    def place(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Where a point lies, in cells."""
        return x_m / self.cell_m - self.i0, y_m / self.cell_m - self.j0

    def cell(self, x_m: float, y_m: float) -> Cell:
        """The cell of a point, the nearest one of the edge for a point outside."""
        i, j = self.place(x_m, y_m)
        return Cell(min(max(math.floor(i), 0), CELLS - 1), min(max(math.floor(j), 0), CELLS - 1))

    def middle_m(self, i: float, j: float) -> tuple[float, float]:
        """The middle of a cell."""
        return (i + self.i0 + 0.5) * self.cell_m, (j + self.j0 + 0.5) * self.cell_m

    def has_inside(self, x_m: float, y_m: float) -> bool:
        """True if the grid reaches there."""
        i, j = self.place(x_m, y_m)
        return 0.0 <= i < CELLS and 0.0 <= j < CELLS

    def clearance_m(self, x_m: float, y_m: float) -> float:
        """Distance from a point to the nearest thing that stands, at most `wide_half_width_m`."""
        return float(self.clearance[self.cell(x_m, y_m)]) * self.cell_m

    def is_seen_free(self, points: Array) -> bool:
        """Whether the cells of all points (n, 2) were seen free; of points outside the nearest cell of the edge."""
        return all_free(self.evidence, points, self.cell_m, self.i0, self.j0)

    def clearances_m(self, points: Array) -> Array:
        """`clearance_m` of points (n, 2)."""
        return under_points(self.clearance, points, self.cell_m, self.i0, self.j0) * self.cell_m

    def clearances_between_m(self, a: tuple[float, float], b: tuple[float, float]) -> Array:
        """`clearance_m` at each cell of the straight line from a to b."""
        count = max(2, math.ceil(math.hypot(b[0] - a[0], b[1] - a[1]) / self.cell_m) + 1)
        return along_line(self.clearance, *self.place(*a), *self.place(*b), count) * self.cell_m

    def standing(self) -> Array:
        """The middles (n, 2) in metres of all cells where something stands, as of the last `refresh`."""
        i, j = np.divmod(np.flatnonzero(self.clearance < 0.5), CELLS)  # ten times as fast as `nonzero` of a grid
        return np.column_stack((i + self.i0 + 0.5, j + self.j0 + 0.5)) * self.cell_m

    def disc(self, x_m: float, y_m: float, radius_m: float) -> tuple[Indices, Indices]:
        """The cells around a point."""
        reach = math.ceil(radius_m / self.cell_m)
        i, j = self.cell(x_m, y_m)
        a, b = np.mgrid[max(0, i - reach) : min(CELLS, i + reach + 1), max(0, j - reach) : min(CELLS, j + reach + 1)]
        near = np.hypot(a - i, b - j) <= reach
        return a[near], b[near]

    def beside(self, places: Array, reach_m: float) -> tuple[Indices, Indices]:
        """The cells under places (n, 2) and up to so far beside them."""
        return cells_beside(places / self.cell_m - (self.i0, self.j0), math.ceil(reach_m / self.cell_m), CELLS)

    def go_along(self, robot: Planar) -> tuple[int, int]:
        """Move the grid along when the robot comes within a quarter of its edge; what falls off is forgotten. By how many cells it was moved."""
        i, j = self.place(robot[0], robot[1])
        quarter = CELLS // 4
        shift_i = 0 if quarter <= i < CELLS - quarter else math.floor(i) - CELLS // 2
        shift_j = 0 if quarter <= j < CELLS - quarter else math.floor(j) - CELLS // 2
        if shift_i or shift_j:
            for grid, blank in ((self.evidence, 0), (self.covered, 0), (self._touched, 0), (self.low_s, NEVER_S), (self._first_s, NEVER_S),
                                (self._stands, 0), (self.clearance, self.far_cells)):  # fmt: skip
                shift(grid, shift_i, shift_j, blank)
            self.i0, self.j0 = self.i0 + shift_i, self.j0 + shift_j
        return shift_i, shift_j
