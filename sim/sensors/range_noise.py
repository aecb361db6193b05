"""What a range sensor makes of exact ranges: noise, drop-outs, dazzle, whole steps, limits. One kernel for laser and sonar."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.kernel import kernel
from sim.noise import Noise

Array = NDArray[np.float64]

DAZZLED_SHARE = 0.8  # a dazzled beam returns at most this share of the true range
NOISE, STEP, LEAST, MOST, LOST, DAZZLED = range(6)  # the figures: metres, metres, metres, metres, share, share


@kernel
def spoil(true_m: Array, chance: Array, fate: Array, figures: Array, out_m: Array) -> None:
    """Fill `out_m` (n,).

    `chance` (n,) is normal; `fate` (n,) uniform in [0, 1): its lowest share is lost, its highest dazzled, and the place within that share says
    how short the range becomes. What is lost or out of range is the maximum.
    """
    most = figures[MOST]
    for i in range(true_m.shape[0]):
        range_m = true_m[i]
        if range_m >= most or fate[i] < figures[LOST]:
            out_m[i] = most
            continue
        if fate[i] >= 1.0 - figures[DAZZLED]:
            range_m *= DAZZLED_SHARE * (1.0 - fate[i]) / figures[DAZZLED]
        range_m += figures[NOISE] * chance[i]
        if figures[STEP] > 0.0:
            range_m = np.rint(range_m / figures[STEP]) * figures[STEP]
        out_m[i] = min(max(range_m, figures[LEAST]), most)


class RangeNoise:
    """The figures of one sensor and its streams of chance."""

    def __init__(self, noise: Noise, noise_m: float, step_m: float, least_m: float, most_m: float, lost: float, dazzled: float) -> None:
        self._noise = noise
        self._figures = np.array([noise_m, step_m, least_m, most_m, lost, dazzled])
        self._spoil = spoil.compiled()

    def spoiled(self, true_m: Array) -> Array:
        """(n,) a new array: what the sensor says."""
        n = true_m.size
        out_m = np.zeros(n)
        self._spoil(true_m, self._noise.normals(n), self._noise.uniforms(n), self._figures, out_m)
        return out_m
