"""The car's steering: turns a wished path curvature into steering percent, and makes the servo's error of each new command."""

from __future__ import annotations

from pluto_bt.maps.platform import Body, Steering
from sim.noise import Noise

STANDSTILL_MPS = 1e-6
SAME_PERCENT = 0.5  # a command within this of the last one that drew an error is not a new one


class SteeringServo:
    """Steering in percent, positive to the left (everything inside turns counter-clockwise); ±100 is the end stop.

    Curvature is linear in percent: `min_turn_radius_m` is reached at `min_turn_radius_percent` (DESIGN.md: 0.83 m at 90 %).
    """

    def __init__(self, body: Body, steering: Steering | None, noise: Noise, ideal: bool) -> None:
        self.curvature_per_percent = 1.0 / (body.min_turn_radius_m * body.min_turn_radius_percent)
        self.rate_percent_per_s = steering.rate_percent_per_s if steering else Steering().rate_percent_per_s
        self._spread = 0.0 if ideal or steering is None else steering.noise_percent / 100.0
        self._noise = noise
        self._drawn_for_percent = 0.0
        self.percent = 0.0
        self.error = 0.0

    def command(self, speed_mps: float, turn_rate_radps: float) -> None:
        """Steer for a wished velocity; at standstill the steering is held."""
        if abs(speed_mps) <= STANDSTILL_MPS:
            return
        percent = turn_rate_radps / speed_mps / self.curvature_per_percent
        self.percent = min(max(percent, -100.0), 100.0)
        if abs(self.percent - self._drawn_for_percent) > SAME_PERCENT:
            self._drawn_for_percent = self.percent
            self.error = self._spread * self._noise.normal()
