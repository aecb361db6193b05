"""How long a way round everything would be, roughly: a search on cells for a disc, for what has to be told before anything moves.

Not for driving: the planner on the map knows the robot's shape and keeps its distance.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import World

CELL_M: Final = 0.1
MOST_CELLS: Final = 100_000
EDGE_M: Final = 3.0  # room round everything drawn, in which the way may lead round it
Point = tuple[float, float]


class RoughWays:
    """Ways for a disc of `radius_m` through a scene, without actors. `keep_out` is a second scene that may not be entered either."""

    def __init__(self, world: World, scene: Scene, radius_m: float, keep_out: Scene | None = None) -> None:
        low_x, low_y, high_x, high_y = world.bounds_m()
        self._origin = (low_x - EDGE_M, low_y - EDGE_M)
        width_m, height_m = high_x - low_x + 2 * EDGE_M, high_y - low_y + 2 * EDGE_M
        self._cell_m = max(CELL_M, math.sqrt(width_m * height_m / MOST_CELLS))
        shape = (math.ceil(height_m / self._cell_m), math.ceil(width_m / self._cell_m))
        self._free = _free_cells(self._origin, self._cell_m, shape, [one for one in (scene, keep_out) if one is not None], radius_m)

    def length_m(self, start: Point, goal: Point) -> float | None:
        """The length of the shortest way, infinite where there is none; None if an end lies outside of what is drawn."""
        ends = [self._cell(point) for point in (start, goal)]
        rows, columns = self._free.shape
        if any(not (0 <= row < rows and 0 <= column < columns) for row, column in ends):
            return None
        return _shortest(self._free, ends[0], ends[1]) * self._cell_m

    def _cell(self, point: Point) -> tuple[int, int]:
        return int((point[1] - self._origin[1]) / self._cell_m), int((point[0] - self._origin[0]) / self._cell_m)


def _free_cells(origin: Point, cell_m: float, shape: tuple[int, int], scenes: list[Scene], radius_m: float) -> NDArray[np.bool_]:
    """Cells whose middle is further than the radius from everything. The clearance at one cell tells how far the next are free."""
    free = np.ones(shape, dtype=np.bool_)
    known = np.zeros(shape, dtype=np.bool_)
    tiny = 1e-3 * np.array([[1.0, 0.0], [-0.5, 0.8], [-0.5, -0.8]])  # a point, as an outline
    for row, column in np.ndindex(*shape):
        if known[row, column]:
            continue
        middle = np.array([origin[0] + (column + 0.5) * cell_m, origin[1] + (row + 0.5) * cell_m])
        gap_m = min(scene.clearance(tiny + middle).distance_m for scene in scenes)
        reach = int(abs(gap_m - radius_m) / cell_m / math.sqrt(2.0))
        rows, columns = slice(row, row + reach + 1), slice(max(0, column - reach), column + reach + 1)
        if gap_m > radius_m:
            known[rows, columns] = True
        else:
            known[row, column], free[row, column] = True, False
    return free


def _shortest(free: NDArray[np.bool_], start: tuple[int, int], goal: tuple[int, int]) -> float:
    """Cells from start to goal, straight or diagonal; infinite if they are not joined. The ends count as free."""
    from scipy.sparse import csr_matrix  # heavy, and only needed here
    from scipy.sparse.csgraph import dijkstra

    free = free.copy()
    free[start] = free[goal] = True
    rows, columns = free.shape
    number = np.arange(free.size).reshape(free.shape)
    froms, tos, costs = [], [], []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        a = (slice(0, rows - down), slice(max(0, -right), columns - max(0, right)))
        b = (slice(down, rows), slice(max(0, right), columns - max(0, -right)))
        joined = free[a] & free[b]
        froms.append(number[a][joined])
        tos.append(number[b][joined])
        costs.append(np.full(int(joined.sum()), math.hypot(down, right)))
    graph = csr_matrix((np.concatenate(costs), (np.concatenate(froms), np.concatenate(tos))), shape=(free.size, free.size))
    return float(dijkstra(graph, directed=False, indices=int(number[start]))[number[goal]])
