"""Wheel encoders: whole counts of both sides, with scale errors of this run and noise that grows with the way."""

from __future__ import annotations

import math

from drivers.records import OdometryRecord
from pluto_bt.maps import platform
from sim.body import Body
from sim.noise import Noise
from sim.simtime import NS, period_ns


class OdometrySensor:
    """Distance and heading since power-on as the base works them out from its counts with its calibrated (effective) track.

    `ideal`: what the body really did, without error (the manual's dummy base), also when it slips or is held by an obstacle.
    """

    def __init__(self, figures: platform.Odometry, track_m: float, body: Body, noise: Noise, ideal: bool) -> None:
        self.period_ns = period_ns(figures.rate_hz)
        self._figures, self._track_m, self._body, self._noise, self._ideal = figures, track_m, body, noise, ideal
        self._distance_scale = 1.0 + figures.distance_scale_noise * noise.normal()
        self._turn_scale = 1.0 + figures.turn_scale_noise * noise.normal()
        self._start = body.pose
        self._wheel_m = self._wheel_rad = 0.0
        self._left_counts = self._right_counts = 0.0  # with fractions: the rest of a count is not lost
        self._reckons_with = (figures.counts_per_m, track_m)  # the base's calibration; its wheels are as they are
        self._origin = (0, 0, 0.0, 0.0)  # counts left and right, m, rad when it was last calibrated
        self._before = (0.0, 0.0)
        self._before_s = -self.period_ns / NS

    def sample(self, now_s: float) -> OdometryRecord:
        """The counts now; velocities are differences of counts, as a real base reports them."""
        if self._ideal:
            body = self._body
            return OdometryRecord(now_s, now_s, body.driven_m, body.theta_rad - self._start[2], body.speed_mps, body.turn_rate_radps)
        self._count()
        distance, heading = self._reckoned()
        dt_s = max(now_s - self._before_s, 1e-6)
        speed, turn_rate = (distance - self._before[0]) / dt_s, (heading - self._before[1]) / dt_s
        self._before, self._before_s = (distance, heading), now_s
        return OdometryRecord(now_s, now_s, distance, heading, speed, turn_rate)

    def calibrate(self, counts_per_m: float, track_m: float) -> None:
        """Reckon with other figures from here on."""
        distance, heading = self._reckoned()
        self._origin = (math.floor(self._left_counts), math.floor(self._right_counts), distance, heading)
        self._reckons_with = (counts_per_m, track_m)

    def _reckoned(self) -> tuple[float, float]:
        """Distance m and heading rad as the base works them out from whole counts."""
        per_m, track_m = self._reckons_with
        left, right, distance, heading = self._origin
        left_m, right_m = (math.floor(self._left_counts) - left) / per_m, (math.floor(self._right_counts) - right) / per_m
        return distance + 0.5 * (left_m + right_m), heading + (right_m - left_m) / track_m

    def _count(self) -> None:
        """Add what the wheels ran since the last sample."""
        figures, noise = self._figures, self._noise
        run_m, run_rad = self._body.wheel_distance_m - self._wheel_m, self._body.wheel_heading_rad - self._wheel_rad
        if run_m == 0.0 and run_rad == 0.0:
            return
        self._wheel_m, self._wheel_rad = self._body.wheel_distance_m, self._body.wheel_heading_rad
        run_m = run_m * self._distance_scale + figures.distance_noise * math.sqrt(abs(run_m)) * noise.normal()
        run_rad = run_rad * self._turn_scale + figures.turn_noise * math.sqrt(abs(run_rad)) * noise.normal()
        half_m = 0.5 * run_rad * self._track_m
        self._left_counts += (run_m - half_m) * figures.counts_per_m
        self._right_counts += (run_m + half_m) * figures.counts_per_m
