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
ROCKING_S = 0.15  # a robot does not tilt at once when its point crosses the edge of a slope


class InertialSensor:
    """A strapped-down sensor at the robot's centre, z up. At rest on level ground it reads +g on z."""

    def __init__(self, figures: platform.Inertial, body: Body, ground: Ground, noise: Noise, ideal: bool) -> None:
        self.period_ns = period_ns(figures.rate_hz)
        self._absolute, self._body, self._ground = figures.absolute, body, ground
        self._chance = noise.rows(12)
        self._wander = noise.rows(3)
        keep = 0.0 if ideal else 1.0
        self._rate_noise = keep * math.radians(figures.noise_dps)
        self._drift = keep * math.radians(figures.drift_dps_per_sqrt_s)
        self._angle_noise = keep * math.radians(figures.angle_noise_deg)
        self._lean_spread, self._lean_s = keep * math.radians(figures.angle_wander_deg), figures.angle_wander_s
        self._lean = [self._lean_spread * noise.normal() for _ in range(3)] if self._lean_spread else [0.0, 0.0, 0.0]
        self._acceleration_noise = keep * figures.acceleration_noise_mps2
        spread = keep * math.radians(figures.bias_dps)
        self._bias = (spread * noise.normal(), spread * noise.normal(), spread * noise.normal())
        self._phi, self._psi = ground.tilt_rad(*body.pose)
        self._speed_mps = body.speed_mps
        self._before_s: float | None = None

    def sample(self, now_s: float) -> InertialRecord:
        """Rates, accelerations and angles now."""
        body = self._body
        dt_s = self.period_ns / NS if self._before_s is None else max(now_s - self._before_s, 1e-6)
        self._before_s = now_s
        phi_rate, psi_rate = self._rock(dt_s)
        speed, turn, g = body.speed_mps, body.turn_rate_radps, GRAVITY_MPS2
        forward = (speed - self._speed_mps) / dt_s
        self._speed_mps = speed
        sin_phi, cos_phi, sin_psi, cos_psi = math.sin(self._phi), math.cos(self._phi), math.sin(self._psi), math.cos(self._psi)
        d1, d2, d3, r1, r2, r3, a1, a2, a3, t1, t2, t3 = next(self._chance)
        walk, rate, push, lean = self._drift * math.sqrt(dt_s), self._rate_noise, self._acceleration_noise, self._angle_noise
        b1, b2, b3 = self._bias
        self._bias = b1, b2, b3 = b1 + walk * d1, b2 + walk * d2, b3 + walk * d3
        rates = (psi_rate - turn * sin_phi + b1 + rate * r1, phi_rate + turn * sin_psi + b2 + rate * r2, turn * cos_phi * cos_psi + b3 + rate * r3)
        accelerations = (forward - g * sin_phi + push * a1, speed * turn + g * cos_phi * sin_psi + push * a2, g * cos_phi * cos_psi + push * a3)
        l1, l2, l3 = self._lean_by(dt_s)
        theta = math.remainder(body.theta_rad + l1 + lean * t1, math.tau) if self._absolute else math.nan
        return InertialRecord(now_s, now_s, rates, accelerations, theta, self._phi + l2 + lean * t2, self._psi + l3 + lean * t3)

    def _lean_by(self, dt_s: float) -> list[float]:
        """The slow error of the angles: a first-order Gauss-Markov process for each."""
        if self._lean_spread:
            keep = math.exp(-dt_s / self._lean_s)
            push = self._lean_spread * math.sqrt(1.0 - keep * keep)
            self._lean = [keep * old + push * chance for old, chance in zip(self._lean, next(self._wander), strict=True)]
        return self._lean

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
