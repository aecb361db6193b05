"""The sonar ring: nearest surface in each cone, noise and drop-outs."""

from __future__ import annotations

import math

import numpy as np

from drivers.records import SonarRecord
from pluto_bt.maps import platform
from sim.body import Body
from sim.noise import Noise
from sim.simtime import period_ns
from sim.surroundings import Surroundings

DUMMY_RANGE_M = 8.0  # Pluto manual: "The sonar is just 8 meters"


class SonarSensor:
    """All transducers in one reading, in the order of the platform file. No echo is the maximum; nothing is nearer than the minimum."""

    delay_s = 0.0

    def __init__(self, figures: platform.Sonar, around: Surroundings, body: Body, noise: Noise, ideal: bool) -> None:
        self.period_ns = period_ns(figures.rate_hz)
        self._figures, self._around, self._body, self._noise, self._ideal = figures, around, body, noise, ideal
        self._x_m = np.array([t.x_m for t in figures.transducers])
        self._y_m = np.array([t.y_m for t in figures.transducers])
        self._theta_rad = np.radians([t.theta_deg for t in figures.transducers])
        self._cone_rad = math.radians(figures.cone_deg)
        self._ranges_m = np.zeros(len(figures.transducers))

    def sample(self, now_s: float) -> SonarRecord:
        """One round of the ring."""
        n = self._ranges_m.size
        if self._ideal:
            return SonarRecord(now_s, now_s, (DUMMY_RANGE_M,) * n)
        figures, body, noise = self._figures, self._body, self._noise
        c, s = math.cos(body.theta_rad), math.sin(body.theta_rad)
        x, y = body.x_m + c * self._x_m - s * self._y_m, body.y_m + s * self._x_m + c * self._y_m
        self._around.cones(x, y, self._theta_rad + body.theta_rad, figures.z_m, self._cone_rad, figures.max_range_m, self._ranges_m)
        low, high, spread, lost = figures.min_range_m, figures.max_range_m, figures.noise_m, figures.dropout_rate
        fate, chance = noise.uniforms(n).tolist(), noise.normals(n).tolist()
        heard = [
            min(max(range_m + spread * chance[i], low), high) if range_m < high and fate[i] >= lost else high
            for i, range_m in enumerate(self._ranges_m.tolist())
        ]
        return SonarRecord(now_s, now_s, tuple(heard))
