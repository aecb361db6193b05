"""What devices deliver: one frozen record a reading, the same from a real device, a log or the simulator.

`stamp_s` is when the reading was taken, `arrival_s` when it reached the computer. Angles counter-clockwise, z up, device frame.
A device has `read() -> list[Record]`: what arrived since the last call, oldest first; it never blocks.
"""

from __future__ import annotations

import msgspec
import numpy as np
from numpy.typing import NDArray


class Record(msgspec.Struct, frozen=True, gc=False):
    """Root of all records."""

    stamp_s: float
    arrival_s: float


class ScanRecord(Record, frozen=True, gc=False):
    """A laser scan: `ranges_m` (n,) read-only; −1 everywhere after a fatal error."""

    angle_min_rad: float
    angle_step_rad: float
    ranges_m: NDArray[np.float64]


class OdometryRecord(Record, frozen=True, gc=False):
    """Wheel odometry of a base: distance and heading since power-on, and the velocities now."""

    distance_m: float
    heading_rad: float
    speed_mps: float
    turn_rate_radps: float


class SonarRecord(Record, frozen=True, gc=False):
    """All transducers, in the order of the platform file."""

    ranges_m: tuple[float, ...]


class BumperRecord(Record, frozen=True, gc=False):
    """True = pressed."""

    front: bool
    back: bool


class BatteryRecord(Record, frozen=True, gc=False):
    """Main battery."""

    voltage_v: float


class InertialRecord(Record, frozen=True, gc=False):
    """Gyro rates (x, y, z), accelerations (x, y, z), gravity-referenced phi and psi; theta only from sensors that know it (else NaN)."""

    turn_rates_radps: tuple[float, float, float]
    accelerations_mps2: tuple[float, float, float]
    theta_rad: float
    phi_rad: float
    psi_rad: float


class CompassRecord(Record, frozen=True, gc=False):
    """Magnetic heading in the map frame."""

    heading_rad: float


class GpsRecord(Record, frozen=True, gc=False):
    """A fix in the map frame; quality 0 = none."""

    x_m: float
    y_m: float
    satellites: int
    quality: int


class MarkerRecord(Record, frozen=True, gc=False):
    """A camera marker reading: where the camera says the car is, in the map frame."""

    marker: int
    x_m: float
    y_m: float
    theta_rad: float
    quality: float


class SpeedRecord(Record, frozen=True, gc=False):
    """Wheel speed, unsigned."""

    speed_mps: float


class WristRecord(Record, frozen=True, gc=False):
    """Pan-tilt unit: angles and their rates."""

    pan_rad: float
    tilt_rad: float
    pan_rate_radps: float
    tilt_rate_radps: float
