"""The magnetic compass: noise, iron in the ground, and places where the needle lies."""

from __future__ import annotations

import math

from drivers.records import CompassRecord
from pluto_bt.maps import platform
from sim.body import Body
from sim.ground import Ground
from sim.noise import Noise
from sim.simtime import period_ns

SHADOW_TURN_DEG = (30.0, 90.0)  # 3DM-GX1 sheet: "yaw drags by tens of degrees near steel"


class CompassSensor:
    """Heading in the map frame. Each compass shadow turns the needle by an angle of its own, drawn once a run, 30° to 90° either way."""

    def __init__(self, figures: platform.Compass, n_shadows: int, body: Body, ground: Ground, noise: Noise, ideal: bool) -> None:
        self.period_ns = period_ns(figures.rate_hz)
        self._body, self._ground, self._noise, self._ideal = body, ground, noise, ideal
        self._spread_rad = math.radians(figures.noise_deg)
        self._turns_rad = [self._draw_turn() for _ in range(n_shadows)]

    def _draw_turn(self) -> float:
        low, high = SHADOW_TURN_DEG
        turn = low + (high - low) * self._noise.uniform()
        return math.radians(turn if self._noise.uniform() < 0.5 else -turn)

    def sample(self, now_s: float) -> CompassRecord:
        """The heading now."""
        body = self._body
        heading = body.theta_rad
        if not self._ideal:
            heading += self._spread_rad * self._noise.normal() + self._ground.magnetic_rad(body.x_m, body.y_m)
            heading += sum(self._turns_rad[i] for i in self._ground.shadows("compass", body.x_m, body.y_m))
        return CompassRecord(now_s, now_s, math.remainder(heading, math.tau))
