"""The SICK laser on the wrist: exact ranges from the scene, then noise, drop-outs, dazzle and whole centimetres."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from drivers.records import ScanRecord
from pluto_bt.maps import platform
from sim.body import Body
from sim.noise import Noise
from sim.sensors.range_noise import RangeNoise
from sim.simtime import period_ns
from sim.surroundings import Surroundings
from sim.wrist import WristDevice


class LaserSensor:
    """Beam 0 looks to the right, the last one to the left. The stamp is mid-scan: the time at which pose and ranges were true."""

    def __init__(self, figures: platform.Laser, around: Surroundings, body: Body, wrist: WristDevice | None, noise: Noise, ideal: bool) -> None:
        self.period_ns = period_ns(figures.rate_hz)
        self._delay_s = figures.arrival_delay_s
        self._figures, self._around, self._body, self._wrist, self._ideal = figures, around, body, wrist, ideal
        self._noise = RangeNoise(noise, figures.noise_m, figures.resolution_m, 0.0, figures.max_range_m, figures.dropout_rate, figures.dazzle_rate)
        field_rad = math.radians(figures.field_deg)
        self._angle_min_rad = -0.5 * field_rad
        self._angle_step_rad = field_rad / (figures.beams - 1)
        self._angles_rad: NDArray[np.float64] = self._angle_min_rad + self._angle_step_rad * np.arange(figures.beams, dtype=np.float64)
        self._angles_rad.setflags(write=False)  # the scene knows a fan of beams again by its array

    def sample(self, now_s: float) -> ScanRecord:
        """One scan from where the laser is now; it arrives when the serial line has carried it."""
        ranges = self.true_ranges_m()
        if not self._ideal:
            ranges = self._noise.spoiled(ranges)
        ranges.setflags(write=False)
        return ScanRecord(now_s, now_s + self._delay_s, self._angle_min_rad, self._angle_step_rad, ranges)

    def true_ranges_m(self) -> NDArray[np.float64]:
        """(n,) exact ranges; the maximum where nothing is hit. The wrist pans about the laser's own vertical, then tilts the plane."""
        figures, body = self._figures, self._body
        pan, tilt = (self._wrist.pan.angle_rad, self._wrist.tilt.angle_rad) if self._wrist else (0.0, 0.0)
        c, s = math.cos(body.theta_rad), math.sin(body.theta_rad)
        pose_map_laser = (body.x_m + c * figures.x_m - s * figures.y_m, body.y_m + s * figures.x_m + c * figures.y_m, body.theta_rad + pan)
        ranges = np.zeros(figures.beams)
        self._around.scan(pose_map_laser, figures.z_m, tilt, self._angles_rad, figures.max_range_m, ranges)
        return ranges
