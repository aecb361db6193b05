"""The sonar ring: nearest surface in each cone, noise and drop-outs."""

from __future__ import annotations

import cmath
import math

import numpy as np

from drivers.records import SonarRecord
from pluto_bt.maps import platform
from sim.body import Body
from sim.noise import Noise
from sim.sensors.range_noise import RangeNoise
from sim.simtime import period_ns
from sim.surroundings import Surroundings

DUMMY_RANGE_M = 8.0  # Pluto manual: "The sonar is just 8 meters"


class SonarSensor:
    """All transducers in one reading, in the order of the platform file. No echo is the maximum; nothing is nearer than the minimum."""

    def __init__(self, figures: platform.Sonar, around: Surroundings, body: Body, noise: Noise, ideal: bool) -> None:
        self.period_ns = period_ns(figures.rate_hz)
        self._figures, self._around, self._body, self._ideal = figures, around, body, ideal
        self._noise = RangeNoise(noise, figures.noise_m, 0.0, figures.min_range_m, figures.max_range_m, figures.dropout_rate, 0.0)
        self._mounts_m = np.array([complex(t.x_m, t.y_m) for t in figures.transducers])
        self._theta_rad = np.radians([t.theta_deg for t in figures.transducers])
        self._cone_rad = math.radians(figures.cone_deg)
        self._ranges_m = np.zeros(len(figures.transducers))

    def sample(self, now_s: float) -> SonarRecord:
        """One round of the ring."""
        n = self._ranges_m.size
        if self._ideal:
            return SonarRecord(now_s, now_s, (DUMMY_RANGE_M,) * n)
        figures, body = self._figures, self._body
        turn = cmath.exp(1j * body.theta_rad)  # one product turns all transducers: x + iy
        at = self._mounts_m * turn + complex(body.x_m, body.y_m)
        self._around.cones(at.real, at.imag, self._theta_rad + body.theta_rad, figures.z_m, self._cone_rad, figures.max_range_m, self._ranges_m)
        return SonarRecord(now_s, now_s, tuple(self._noise.spoiled(self._ranges_m).tolist()))
