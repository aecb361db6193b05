"""Gyros and accelerometers: bias, noise and drift of the rates; angles referenced to gravity; theta only from sensors that know it."""

from __future__ import annotations

import math

from drivers.records import InertialRecord
from pluto_bt.maps import platform
from sim.body import Body
from sim.ground import Ground
from sim.noise import Noise
from sim.simtime import NS, period_ns

GRAVITY_MPS2 = 9.80665
ROCKING_S = 0.15  # a robot does not tilt at once when its point crosses the edge of a slope: half a wheel base at 0.5 m/s is 0.5 s


class InertialSensor:
    """A strapped-down sensor at the robot's centre, z up. At rest on level ground it reads +g on z."""

    delay_s = 0.0

    def __init__(self, figures: platform.Inertial, body: Body, ground: Ground, noise: Noise, ideal: bool) -> None:
        self.period_ns = period_ns(figures.rate_hz)
        self._absolute, self._body, self._ground, self._noise = figures.absolute, body, ground, noise
        keep = 0.0 if ideal else 1.0
        self._rate_noise = keep * math.radians(figures.noise_dps)
        self._drift = keep * math.radians(figures.drift_dps_per_sqrt_s)
        self._angle_noise = keep * math.radians(figures.angle_noise_deg)
        self._acceleration_noise = keep * figures.acceleration_noise_mps2
        self._bias = tuple(keep * math.radians(figures.bias_dps) * noise.normal() for _ in range(3))
        self._phi, self._psi = ground.tilt_rad(*body.pose)
        self._speed_mps = body.speed_mps
        self._before_s = -self.period_ns / NS

    def sample(self, now_s: float) -> InertialRecord:
        """Rates, accelerations and angles now."""
        body, normal = self._body, self._noise.normal
        dt_s = max(now_s - self._before_s, 1e-6)
        self._before_s = now_s
        phi_rate, psi_rate = self._rock(dt_s)
        walk = self._drift * math.sqrt(dt_s)
        self._bias = tuple(bias + walk * normal() for bias in self._bias)
        turn = body.turn_rate_radps
        level = math.cos(self._phi) * math.cos(self._psi)
        true_rates = (psi_rate - turn * math.sin(self._phi), phi_rate + turn * math.sin(self._psi), turn * level)
        forward = (body.speed_mps - self._speed_mps) / dt_s
        self._speed_mps = body.speed_mps
        g = GRAVITY_MPS2
        true_accelerations = (forward - g * math.sin(self._phi), body.speed_mps * turn + g * math.cos(self._phi) * math.sin(self._psi), g * level)
        x, y, z = (rate + bias + self._rate_noise * normal() for rate, bias in zip(true_rates, self._bias, strict=True))
        ax, ay, az = (a + self._acceleration_noise * normal() for a in true_accelerations)
        theta = math.remainder(body.theta_rad + self._angle_noise * normal(), math.tau) if self._absolute else math.nan
        phi, psi = self._phi + self._angle_noise * normal(), self._psi + self._angle_noise * normal()
        return InertialRecord(now_s, now_s, (x, y, z), (ax, ay, az), theta, phi, psi)

    def _rock(self, dt_s: float) -> tuple[float, float]:
        """Follow the slope of the ground; gives the rates (phi, psi) of doing so."""
        phi, psi = self._ground.tilt_rad(*self._body.pose)
        if phi == self._phi and psi == self._psi:
            return 0.0, 0.0
        share = 1.0 - math.exp(-dt_s / ROCKING_S)
        step_phi, step_psi = share * (phi - self._phi), share * (psi - self._psi)
        self._phi += step_phi
        self._psi += step_psi
        return step_phi / dt_s, step_psi / dt_s
