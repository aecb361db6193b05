"""A suspicion that the next scan has to confirm: what walks past the laser moves on."""

from __future__ import annotations

import math


class Doubt:
    """Knows whether the last scan that was judged told the same already."""

    __slots__ = ("_looked_s", "_suspected_s")

    def __init__(self) -> None:
        self._looked_s = self._suspected_s = -math.inf  # stamps of the last scan that was judged, and of the last that was suspicious

    @property
    def is_waiting(self) -> bool:
        """True while a suspicion waits for the next scan."""
        return self._suspected_s > -math.inf and self._suspected_s == self._looked_s

    def is_confirmed(self, stamp_s: float) -> bool:
        """True for the second suspicious scan in a row. `stamp_s` is that of the suspicious one."""
        is_second = self.is_waiting
        self._suspected_s = stamp_s
        return is_second

    def looked(self, stamp_s: float) -> None:
        """A scan was judged, suspicious or not."""
        self._looked_s = stamp_s
