"""The GPS receiver: white noise on a slowly wandering error, satellites that come and go, and shadows without a fix."""

from __future__ import annotations

import math

from drivers.records import GpsRecord
from pluto_bt.maps import platform
from sim.body import Body
from sim.ground import Ground
from sim.noise import Noise
from sim.simtime import NS, period_ns

WANDER_S = 60.0  # correlation time of the wandering error
SATELLITES = (4, 11)
FEW = 5  # Pluto manual: quality 2 and more than 5 satellites for sub-metre accuracy
UNAIDED = 6.0  # errors of quality 1 are larger by this factor
CHANGE_RATE = 0.1  # share of readings at which a satellite comes or goes


class GpsSensor:
    """Position in the map frame; quality 2 aided, 1 with few satellites, 0 in a shadow (then the last position is repeated, as receivers do)."""

    def __init__(self, figures: platform.Gps, body: Body, ground: Ground, noise: Noise, ideal: bool) -> None:
        self.period_ns = period_ns(figures.rate_hz)
        self._figures, self._body, self._ground, self._noise, self._ideal = figures, body, ground, noise, ideal
        self._wander = [figures.wander_m * noise.normal(), figures.wander_m * noise.normal()]
        self._keep = math.exp(-self.period_ns / NS / WANDER_S)
        self._satellites = 8
        self._fix = (body.x_m, body.y_m)

    def sample(self, now_s: float) -> GpsRecord:
        """One reading."""
        body, noise = self._body, self._noise
        if self._ideal:
            return GpsRecord(now_s, now_s, body.x_m, body.y_m, SATELLITES[1], 2)
        fresh = math.sqrt(1.0 - self._keep**2) * self._figures.wander_m
        self._wander = [self._keep * wander + fresh * noise.normal() for wander in self._wander]
        chance = noise.uniform()
        if chance < CHANGE_RATE:
            self._satellites += 1 if chance < 0.55 * CHANGE_RATE else -1  # a little more often up: the mean stays above FEW
            self._satellites = min(max(self._satellites, SATELLITES[0]), SATELLITES[1])
        if self._ground.shadows("gps", body.x_m, body.y_m):
            return GpsRecord(now_s, now_s, *self._fix, int(4 * noise.uniform()), 0)
        quality = 2 if self._satellites > FEW else 1
        scale = 1.0 if quality == 2 else UNAIDED
        spread = self._figures.noise_m
        self._fix = (
            body.x_m + scale * (self._wander[0] + spread * noise.normal()),
            body.y_m + scale * (self._wander[1] + spread * noise.normal()),
        )
        return GpsRecord(now_s, now_s, *self._fix, self._satellites, quality)
