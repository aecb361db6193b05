"""What a level scan would have shown, as far as a tilted one tells: walls stand upright, and what is near the ground is left out.

A wrist that looks at the ground ten degrees down still sees the walls to both sides at a man's knee, and that is enough to see whether wheels slip.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.kernel import kernel

Array = NDArray[np.float64]

LEAST_M = 0.15  # over the ground: what is lower may be a kerb, or the ground itself
JOINED = 0.15  # neighbours whose ranges differ by a larger share lie on different things


def levelled(ranges_m: Array, first_rad: float, step_rad: float, tilt_rad: float, height_m: float) -> Array:
    """(n,) ranges of the same bearings in the plane, m; 0 where the scan tells nothing.

    Args:
        ranges_m: (n,) of the tilted scan. first_rad, step_rad: bearing of its first beam, and between two. tilt_rad: positive looks down.
        height_m: of the laser over the ground.
    """
    out = np.zeros(len(ranges_m))
    _level(ranges_m, first_rad, step_rad, tilt_rad, height_m, out)
    out.setflags(write=False)  # as those of a laser are: one kind of arrays for the kernels
    return out


@kernel
def _level(ranges_m: Array, first_rad: float, step_rad: float, tilt_rad: float, height_m: float, out: Array) -> None:
    """Fill `out`. A beam of bearing b looks along (cos b cos t, sin b, -cos b sin t), and so along the bearing atan2(sin b, cos b cos t)."""
    n = ranges_m.shape[0]
    c, s = math.cos(tilt_rad), math.sin(tilt_rad)
    for k in range(n):
        bearing = first_rad + k * step_rad
        b = math.atan2(math.sin(bearing) * c, math.cos(bearing))
        place = min(max((b - first_rad) / step_rad, 0.0), n - 1.0)
        i = min(int(place), n - 2)
        r0, r1 = ranges_m[i], ranges_m[i + 1]
        if not (r0 > 0.0 and r1 > 0.0 and abs(r1 - r0) < JOINED * r0):
            continue
        r = r0 + (place - i) * (r1 - r0)
        if height_m - r * math.cos(b) * s > LEAST_M:
            out[k] = r * math.hypot(math.cos(b) * c, math.sin(b))


def warm() -> None:
    """Use the kernel once, so that no later use waits for its compilation."""
    ranges_m = np.zeros(2)
    ranges_m.setflags(write=False)
    levelled(ranges_m, 0.0, 1.0, 0.0, 1.0)
