"""The directions of a scan's beams, worked out once: a laser always looks the same way."""

from __future__ import annotations

import numpy as np

from pluto_bt.skills.outline import Array


class Fan:
    """Remembers the last scan's beams."""

    def __init__(self) -> None:
        self._figures = (0.0, 0.0, -1)
        self._beams: tuple[Array, Array, Array] = (np.zeros(0), np.zeros(0), np.zeros(0))

    def beams(self, angle_min_rad: float, angle_step_rad: float, count: int) -> tuple[Array, Array, Array]:
        """(n,) angles in the laser frame, rad, their cosines and their sines; not to be changed."""
        if self._figures != (angle_min_rad, angle_step_rad, count):
            self._figures = (angle_min_rad, angle_step_rad, count)
            angles: Array = angle_min_rad + angle_step_rad * np.arange(count, dtype=np.float64)
            self._beams = angles, np.cos(angles), np.sin(angles)
        return self._beams
