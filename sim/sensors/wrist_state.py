"""The wrist's joint sensors."""

from __future__ import annotations

from drivers.records import WristRecord
from pluto_bt.maps import platform
from sim.simtime import period_ns
from sim.wrist import WristDevice


class WristSensor:
    """Angles and rates of both joints; absolute encoders, taken as exact."""

    def __init__(self, figures: platform.Wrist, wrist: WristDevice) -> None:
        self.period_ns = period_ns(figures.rate_hz)
        self._wrist = wrist

    def sample(self, now_s: float) -> WristRecord:
        """Both joints now."""
        pan, tilt, moving = self._wrist.pan, self._wrist.tilt, 0.0 if self._wrist.stuck else 1.0
        return WristRecord(now_s, now_s, pan.angle_rad, tilt.angle_rad, moving * pan.rate_radps, moving * tilt.rate_radps)
