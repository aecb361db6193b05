"""The camera that reads markers on the ceiling: where it says the car is, how sure it claims to be, and how wrong it can be."""

from __future__ import annotations

import math

from drivers.records import MarkerRecord
from pluto_bt.maps import platform
from pluto_bt.maps.world import Marker
from sim.body import Body
from sim.ground import Ground
from sim.noise import Noise
from sim.simtime import period_ns

NO_MARKER = -1  # as the client's file says it
USUAL_QUALITY = (0.55, 0.12)  # mean, standard deviation: "in practice 0.2 – 0.8"
POOR_RATE, POOR_BELOW = 0.04, 0.25  # readings below the gate's limit: "below 0.4 often nonsense"
HIGH_RATE, HIGH_ABOVE = 0.01, 1.0  # a published sample has 1.479
OUTLIER_M = 4.0
POOR_M = 1.0


class MarkerSensor:
    """The nearest marker in range, if the car is not in a shadow; the stamp is when the picture was taken."""

    def __init__(self, figures: platform.MarkerCamera, markers: tuple[Marker, ...], body: Body, ground: Ground, noise: Noise, ideal: bool) -> None:
        self.period_ns = period_ns(figures.rate_hz)
        self._delay_s = figures.delay_s
        self._figures, self._markers, self._body, self._ground, self._noise, self._ideal = figures, markers, body, ground, noise, ideal

    def sample(self, now_s: float) -> MarkerRecord:
        """One picture; without a marker in sight number −1 and quality 0."""
        arrival_s, body = now_s + self._delay_s, self._body
        marker = self._nearest()
        if marker is None:
            return MarkerRecord(now_s, arrival_s, NO_MARKER, 0.0, 0.0, 0.0, 0.0)
        if self._ideal:
            return MarkerRecord(now_s, arrival_s, marker.id, body.x_m, body.y_m, math.remainder(body.theta_rad, math.tau), USUAL_QUALITY[0])
        quality, spread_m = self._quality()
        x, y, theta = body.x_m + spread_m * self._noise.normal(), body.y_m + spread_m * self._noise.normal(), body.theta_rad
        theta += math.radians(self._figures.angle_noise_deg) * self._noise.normal()
        if self._noise.uniform() < self._figures.outlier_rate:
            x, y, theta = self._outlier(x, y, theta)
        return MarkerRecord(now_s, arrival_s, marker.id, x, y, math.remainder(theta, math.tau), quality)

    def _nearest(self) -> Marker | None:
        """The marker overhead, or none in range or in a shadow."""
        x, y = self._body.x_m, self._body.y_m
        if not self._markers or self._ground.shadows("marker", x, y):
            return None
        nearest = min(self._markers, key=lambda marker: math.hypot(marker.x_m - x, marker.y_m - y))
        return nearest if math.hypot(nearest.x_m - x, nearest.y_m - y) <= self._figures.range_m else None

    def _quality(self) -> tuple[float, float]:
        """(claimed quality, standard deviation of the position in metres)."""
        chance, share = self._noise.uniform(), self._noise.uniform()
        if chance < POOR_RATE:
            return POOR_BELOW * share, POOR_M
        if chance > 1.0 - HIGH_RATE:
            return HIGH_ABOVE + 0.5 * share, self._figures.noise_m
        mean, spread = USUAL_QUALITY
        return min(max(mean + spread * self._noise.normal(), POOR_BELOW), HIGH_ABOVE), self._figures.noise_m

    def _outlier(self, x: float, y: float, theta: float) -> tuple[float, float, float]:
        """Nonsense with a good quality: a position metres away, or the marker read upside down."""
        if self._noise.uniform() < 0.5:
            return x, y, theta + math.pi
        away, direction = OUTLIER_M * (0.25 + 0.75 * self._noise.uniform()), math.tau * self._noise.uniform()
        return x + away * math.cos(direction), y + away * math.sin(direction), theta
