"""One place of a field, asked from Python."""

from __future__ import annotations

import numpy as np

from pluto_bt.maps.kernel import kernel
from pluto_bt.skills.near_field import field_at


@kernel
def asked(field: np.ndarray, x_m: float, y_m: float) -> float:
    """`field_at`, which is only there to be built into other kernels."""
    return field_at(field, x_m, y_m)
