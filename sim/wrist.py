"""The pan-tilt unit under the laser: two axes with trapezoid speed profiles."""

from __future__ import annotations

import math

from pluto_bt.maps.platform import Wrist
from sim.device import Device
from sim.simtime import TICK_NS, TICK_S, SimTime


class Axis:
    """One joint: goes to its target with bounded speed and acceleration, and stops there without overshoot."""

    __slots__ = ("_acceleration_radps2", "_limit_rad", "_max_rate_radps", "angle_rad", "rate_radps", "target_rad")

    def __init__(self, limit_rad: float) -> None:
        self._limit_rad = limit_rad
        self._max_rate_radps = self._acceleration_radps2 = 0.0
        self.angle_rad = self.rate_radps = self.target_rad = 0.0

    def move(self, target_rad: float, rate_radps: float, acceleration_radps2: float) -> None:
        """Head for a target within the joint's limits."""
        self.target_rad = min(max(target_rad, -self._limit_rad), self._limit_rad)
        self._max_rate_radps, self._acceleration_radps2 = rate_radps, acceleration_radps2

    @property
    def moving(self) -> bool:
        """False at rest on the target."""
        return self.rate_radps != 0.0 or self.angle_rad != self.target_rad

    def tick(self) -> None:
        """Move on by one tick: as fast as still allows to brake before the target."""
        gap = self.target_rad - self.angle_rad
        step = self._acceleration_radps2 * TICK_S
        if abs(gap) <= step * TICK_S and abs(self.rate_radps) <= 1.5 * step:
            self.angle_rad, self.rate_radps = self.target_rad, 0.0
            return
        braking = math.sqrt(0.25 * step * step + 2.0 * self._acceleration_radps2 * abs(gap)) - 0.5 * step
        wanted = math.copysign(min(self._max_rate_radps, braking, abs(gap) / TICK_S), gap)
        self.rate_radps = min(max(wanted, self.rate_radps - step), self.rate_radps + step)
        self.angle_rad = min(max(self.angle_rad + self.rate_radps * TICK_S, -self._limit_rad), self._limit_rad)


class WristDevice(Device):
    """Pan (about z, positive to the left) and tilt (positive looks down); delivers its state."""

    def __init__(self, name: str, time: SimTime, figures: Wrist) -> None:
        super().__init__(name, time)
        self.pan = Axis(math.radians(figures.pan_limit_deg))
        self.tilt = Axis(math.radians(figures.tilt_limit_deg))
        self._max_rate_radps = math.radians(figures.max_rate_dps)
        self._max_acceleration_radps2 = math.radians(figures.max_acceleration_dps2)
        self._moved_to_ns = 0
        self._is_under_way = False
        self.stuck = False

    def move(self, pan_rad: float, tilt_rad: float, rate_radps: float, acceleration_radps2: float) -> None:
        """Go there. Rate and acceleration must both be > 0, else the position stays (manual); above the unit's figures they are cut."""
        if not (rate_radps > 0.0 and acceleration_radps2 > 0.0 and math.isfinite(pan_rad) and math.isfinite(tilt_rad)):
            return
        self.bring_to(self._time.now_ns)
        rate, acceleration = min(rate_radps, self._max_rate_radps), min(acceleration_radps2, self._max_acceleration_radps2)
        self.pan.move(pan_rad, rate, acceleration)
        self.tilt.move(tilt_rad, rate, acceleration)
        self._is_under_way = True

    def bring_to(self, now_ns: int) -> None:
        """Let the axes move until now; costs nothing while they rest."""
        if not self.stuck and self._is_under_way:
            for _ in range((now_ns - self._moved_to_ns) // TICK_NS):
                self.pan.tick()
                self.tilt.tick()
            self._is_under_way = self.pan.moving or self.tilt.moving
        self._moved_to_ns = now_ns
