"""Which polygons a moving point is in, cheaply: the answer holds until the point has moved as far as the nearest edge is away."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


class Regions:
    """A fixed list of polygons (map frame, metres); `at` gives the indices of those that hold a point."""

    def __init__(self, polygons: Sequence[Points]) -> None:
        self._n = len(polygons)
        starts = [np.asarray(polygon, dtype=np.float64) for polygon in polygons]
        self._start = np.vstack(starts) if starts else np.zeros((0, 2))
        ends = np.vstack([np.roll(points, -1, axis=0) for points in starts]) if starts else np.zeros((0, 2))
        self._end_y = ends[:, 1]
        self._edge = ends - self._start
        self._owner = np.repeat(np.arange(self._n), [len(points) for points in starts])
        self._length2 = np.maximum((self._edge**2).sum(axis=1), 1e-300)
        self._inside: tuple[int, ...] = ()
        self._x, self._y, self._margin_m = 0.0, 0.0, -1.0 if starts else math.inf

    def at(self, x_m: float, y_m: float) -> tuple[int, ...]:
        """Indices of the polygons around the point, ascending; the same object as long as nothing was looked up anew."""
        if self._n and math.hypot(x_m - self._x, y_m - self._y) >= self._margin_m:
            self._look(x_m, y_m)
        return self._inside

    def _look(self, x_m: float, y_m: float) -> None:
        """Even-odd rule and distances to all edges."""
        to_point = np.array([x_m, y_m]) - self._start
        share = np.clip((to_point * self._edge).sum(axis=1) / self._length2, 0.0, 1.0)
        gap = to_point - share[:, None] * self._edge
        above, end_above = self._start[:, 1] > y_m, self._end_y > y_m  # absolute: both edges of a corner must judge it alike
        crosses = above != end_above
        left_of = np.where(crosses, to_point[:, 0] * self._edge[:, 1] < to_point[:, 1] * self._edge[:, 0], False)
        hits = crosses & (left_of == (self._edge[:, 1] > 0.0))
        counts = np.bincount(self._owner[hits], minlength=self._n)
        self._inside = tuple(np.flatnonzero(counts % 2).tolist())
        self._x, self._y, self._margin_m = x_m, y_m, float(np.sqrt((gap**2).sum(axis=1).min()))
