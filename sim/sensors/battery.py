"""The main battery: its voltage falls while the run lasts, faster when driving."""

from __future__ import annotations

from drivers.records import BatteryRecord
from pluto_bt.maps import platform
from sim.body import Body
from sim.simtime import NS

IDLE_SHARE = 0.25  # computers and sensors draw this share of what driving does
SECONDS_AN_HOUR = 3600.0


class BatterySensor:
    """Voltage, once a second; linear from full to empty over the hours of the platform file. An ideal battery stays full."""

    period_ns = NS

    def __init__(self, figures: platform.Battery, body: Body, ideal: bool) -> None:
        self._figures, self._body, self._ideal = figures, body, ideal
        self._used = 0.0  # share of the charge
        self._before_s = 0.0

    def sample(self, now_s: float) -> BatteryRecord:
        """The voltage now."""
        figures = self._figures
        driving = self._body.wheel_speed_mps != 0.0 or self._body.wheel_turn_rate_radps != 0.0
        if not self._ideal:
            self._used += (now_s - self._before_s) * (1.0 if driving else IDLE_SHARE) / (figures.hours * SECONDS_AN_HOUR)
        self._before_s = now_s
        return BatteryRecord(now_s, now_s, max(figures.full_v - self._used * (figures.full_v - figures.empty_v), 0.0))
