"""Randomness of the simulator: every user of chance has its own streams, made from the run's seed and the user's name.

So a sensor that is added, or that draws more, changes nothing for the others; the same seed and name give the same bits.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

BLOCK = 1024  # single numbers are drawn in blocks: one call of numpy costs as much as 200 numbers
ROWS = 64


class Noise:
    """Streams of standard normal and uniform numbers, for one user.

    Single numbers and arrays come from separate streams, so that the size of a block can never show in the results.
    """

    __slots__ = ("_array_normals", "_array_uniforms", "_block_normals", "_block_uniforms", "_normals", "_uniforms")

    def __init__(self, seed: int, name: str) -> None:
        key = zlib.crc32(name.encode())
        streams = [np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed % 2**64, spawn_key=(key, i)))) for i in range(4)]
        self._block_normals, self._block_uniforms, self._array_normals, self._array_uniforms = streams
        self._normals: Iterator[float] = iter(())
        self._uniforms: Iterator[float] = iter(())

    def normal(self) -> float:
        """One number, mean 0, standard deviation 1."""
        for value in self._normals:
            return value
        self._normals = iter(self._block_normals.standard_normal(BLOCK).tolist())
        return next(self._normals)

    def uniform(self) -> float:
        """One number in [0, 1)."""
        for value in self._uniforms:
            return value
        self._uniforms = iter(self._block_uniforms.random(BLOCK).tolist())
        return next(self._uniforms)

    def rows(self, n: int) -> Iterator[list[float]]:
        """Endless rows of `n` standard normal numbers, for sensors that need as many in every sample. Draws from the arrays' stream."""
        while True:
            yield from self._array_normals.standard_normal((ROWS, n)).tolist()

    def normals(self, n: int) -> NDArray[np.float64]:
        """(n,) numbers, mean 0, standard deviation 1."""
        return self._array_normals.standard_normal(n)

    def uniforms(self, n: int) -> NDArray[np.float64]:
        """(n,) numbers in [0, 1)."""
        return self._array_uniforms.random(n)
