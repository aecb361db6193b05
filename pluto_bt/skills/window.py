"""Cells of a grid: one, and a rectangle of them."""

from __future__ import annotations

import math
from typing import NamedTuple


class Cell(NamedTuple):
    """Indices of a cell, and (as floats) a place in cells."""

    i: int
    j: int


class Window(NamedTuple):
    """The cells [i0, i1) x [j0, j1); empty if i0 >= i1."""

    i0: int
    i1: int
    j0: int
    j1: int

    @classmethod
    def around(cls, i: float, j: float, reach: float) -> Window:
        """All cells up to `reach` cells away from a place."""
        return cls(math.floor(i - reach), math.ceil(i + reach), math.floor(j - reach), math.ceil(j + reach))

    def joined(self, other: Window | None) -> Window:
        """The smallest one that holds both."""
        if other is None:
            return self
        return Window(min(self.i0, other.i0), max(self.i1, other.i1), min(self.j0, other.j0), max(self.j1, other.j1))

    def moved(self, di: int, dj: int) -> Window:
        """The same cells in a grid whose first cell lies so many cells farther on."""
        return Window(self.i0 - di, self.i1 - di, self.j0 - dj, self.j1 - dj)

    def seen_from(self, i: float, j: float, ratio: float) -> Window:
        """The cells of a coarser grid that these touch: its first corner lies at (i, j) here, and its cells are so many times as large."""
        low_i, high_i, low_j, high_j = (self.i0 - i) / ratio, (self.i1 - i) / ratio, (self.j0 - j) / ratio, (self.j1 - j) / ratio
        return Window(math.floor(low_i), math.ceil(high_i), math.floor(low_j), math.ceil(high_j))

    def grown(self, by: int, size: int) -> Window:
        """With so many cells more on each side, as far as a square grid of `size` has them."""
        return Window(max(0, self.i0 - by), min(size, self.i1 + by), max(0, self.j0 - by), min(size, self.j1 + by))
