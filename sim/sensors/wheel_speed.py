"""The car's wheel speed: unsigned, in whole steps."""

from __future__ import annotations

from drivers.records import SpeedRecord
from pluto_bt.maps import platform
from sim.body import Body
from sim.noise import Noise
from sim.simtime import period_ns

STANDSTILL_MPS = 0.005  # below this no pulse comes, and the sensor says 0 without noise


class WheelSpeedSensor:
    """How fast the wheels turn, whichever way, also when the car is held."""

    def __init__(self, figures: platform.WheelSpeed, body: Body, noise: Noise, ideal: bool) -> None:
        self.period_ns = period_ns(figures.rate_hz)
        self._figures, self._body, self._noise, self._ideal = figures, body, noise, ideal

    def sample(self, now_s: float) -> SpeedRecord:
        """The speed now."""
        if self._ideal:
            return SpeedRecord(now_s, now_s, abs(self._body.speed_mps))
        speed = abs(self._body.wheel_speed_mps)
        if speed < STANDSTILL_MPS:
            return SpeedRecord(now_s, now_s, 0.0)
        speed = abs(speed + self._figures.noise_mps * self._noise.normal())
        step = self._figures.resolution_mps
        return SpeedRecord(now_s, now_s, round(speed / step) * step if step > 0.0 else speed)
