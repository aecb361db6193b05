"""Filtering of an inertial sensor: low-pass, and the heading integrated from the filtered rates.

Angles are theta about z, then phi about y, then psi about x (DESIGN.md, section 3).
"""

from __future__ import annotations

import math

Triple = tuple[float, float, float]


class LowPass:
    """First-order low-pass of three channels. Its delay, for signals slower than 1/tau, is `tau_s`."""

    __slots__ = ("_last", "tau_s")

    def __init__(self, tau_s: float) -> None:
        self.tau_s = tau_s
        self._last: Triple | None = None

    def step(self, values: Triple, dt_s: float) -> Triple:
        """The filtered values after `dt_s` more seconds; the first values pass as they are."""
        last = self._last
        if last is not None and self.tau_s > 0.0:
            a = dt_s / (self.tau_s + dt_s)
            values = (last[0] + a * (values[0] - last[0]), last[1] + a * (values[1] - last[1]), last[2] + a * (values[2] - last[2]))
        self._last = values
        return values


def theta_rate(rates_radps: Triple, phi_rad: float, psi_rad: float) -> float:
    """How fast theta changes when the body turns at `rates_radps` about its own x, y, z.

    Ref: kinematic equation of the z-y-x Euler angles. Near phi = ±90° theta is not defined; the cosine is held above 0.1 there.
    """
    _, y, z = rates_radps
    if phi_rad == 0.0 and psi_rad == 0.0:
        return z
    return (y * math.sin(psi_rad) + z * math.cos(psi_rad)) / max(0.1, math.cos(phi_rad))


class InertialHeading:
    """Filtered rates and accelerations, and theta since the start with the bias removed. Stamps are set back by the filter's delay."""

    __slots__ = ("_accelerations", "_last_s", "_rates", "delay_s", "theta_rad")

    def __init__(self, tau_s: float) -> None:
        self._rates, self._accelerations = LowPass(tau_s), LowPass(tau_s)
        self._last_s: float | None = None
        self.delay_s = tau_s
        self.theta_rad = 0.0

    def step(self, stamp_s: float, rates_radps: Triple, accelerations_mps2: Triple, phi_rad: float, psi_rad: float) -> tuple[Triple, Triple]:
        """One sample, rates without bias. Returns filtered rates and accelerations; `theta_rad` has moved on.

        A sample that is not newer than the last one is filtered but turns nothing.
        """
        dt_s = 0.0 if self._last_s is None else max(0.0, stamp_s - self._last_s)
        self._last_s = stamp_s if self._last_s is None else max(self._last_s, stamp_s)
        rates = self._rates.step(rates_radps, dt_s)
        self.theta_rad += theta_rate(rates, phi_rad, psi_rad) * dt_s
        return rates, self._accelerations.step(accelerations_mps2, dt_s)
