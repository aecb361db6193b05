"""Filtering of an inertial sensor: low-pass, and the heading integrated from the filtered rates.

Angles are theta about z, then phi about y, then psi about x (DESIGN.md, section 3).
"""

from __future__ import annotations

import math

Triple = tuple[float, float, float]


def low_pass(last: Triple, values: Triple, share: float) -> Triple:
    """First-order low-pass of three channels: `last` moved towards `values` by `share`, which is dt / (tau + dt)."""
    x, y, z = last
    return x + share * (values[0] - x), y + share * (values[1] - y), z + share * (values[2] - z)


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
        self._rates = self._accelerations = (0.0, 0.0, 0.0)
        self._last_s: float | None = None
        self.delay_s = tau_s  # of a first-order low-pass, for signals slower than 1 / tau
        self.theta_rad = 0.0

    def step(self, stamp_s: float, rates_radps: Triple, accelerations_mps2: Triple, phi_rad: float, psi_rad: float) -> tuple[Triple, Triple]:
        """One sample, rates without bias. Returns filtered rates and accelerations, the first ones as they are; `theta_rad` has moved on.

        A sample that is not newer than the last one is filtered but turns nothing.
        """
        last_s = self._last_s
        dt_s = 0.0 if last_s is None else max(0.0, stamp_s - last_s)
        if last_s is not None and self.delay_s > 0.0:
            share = dt_s / (self.delay_s + dt_s)
            rates_radps, accelerations_mps2 = low_pass(self._rates, rates_radps, share), low_pass(self._accelerations, accelerations_mps2, share)
        self._last_s = stamp_s if last_s is None or stamp_s > last_s else last_s
        self._rates, self._accelerations = rates_radps, accelerations_mps2
        self.theta_rad += theta_rate(rates_radps, phi_rad, psi_rad) * dt_s
        return rates_radps, accelerations_mps2
