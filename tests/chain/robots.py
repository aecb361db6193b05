"""Two platforms for the tests of the chain, written out here so that these tests stand on their own."""

from __future__ import annotations

import math

from pluto_bt.maps.platform import Body, Bumpers, Devices, Laser, Limits, Platform, Sonar, Transducer, Wrist

_ATRV2_RING = [
    (-0.5, 0.42, 90), (-0.58, 0.175, 180), (-0.58, -0.175, 180), (-0.5, -0.42, -90), (0.58, 0.065, 0), (0.58, 0.11, 15), (0.58, 0.165, 30),
    (0.5, 0.42, 90), (0.58, -0.065, 0), (0.58, -0.11, -15), (0.58, -0.165, -30), (0.5, -0.42, -90),
]  # fmt: skip
_P3DX_ANGLES = [90, 50, 30, 10, -10, -30, -50, -90, -90, -130, -150, -170, 170, 150, 130, 90]
_P3DX_RING = [(0.19 * math.cos(math.radians(a)), 0.17 * math.sin(math.radians(a)), a) for a in _P3DX_ANGLES]


def _ring(rows: list[tuple[float, float, float]]) -> Sonar:
    return Sonar(transducers=tuple(Transducer(x_m=x, y_m=y, theta_deg=a) for x, y, a in rows))


def _box(front: float, side: float) -> tuple[tuple[float, float], ...]:
    return ((front, side), (-front, side), (-front, -side), (front, -side))


ATRV2 = Platform(
    name="atrv2",
    body=Body(kinematics="skid", outline_m=_box(0.585, 0.425), track_m=0.62),
    limits=Limits(max_speed_mps=0.9, max_turn_rate_dps=45.8, acceleration_mps2=0.4, deceleration_mps2=1.0, turn_acceleration_dps2=60.0),
    devices=Devices(laser=Laser(x_m=0.48), sonar=_ring(_ATRV2_RING), bumpers=Bumpers(), wrist=Wrist()),
)  # fmt: skip
PIONEER = Platform(
    name="pioneer",
    body=Body(
        kinematics="differential",
        track_m=0.33,
        outline_m=((0.225, 0.1), (0.12, 0.2), (-0.12, 0.2), (-0.225, 0.1), (-0.225, -0.1), (-0.12, -0.2), (0.12, -0.2), (0.225, -0.1)),
    ),
    limits=Limits(max_speed_mps=1.2, max_turn_rate_dps=100.0, acceleration_mps2=0.3, deceleration_mps2=0.6, turn_acceleration_dps2=100.0),
    devices=Devices(laser=Laser(x_m=0.1), bumpers=Bumpers(), sonar=_ring(_P3DX_RING)),
)  # fmt: skip
CAR = Platform(
    name="car",
    body=Body(kinematics="ackermann", outline_m=_box(0.22, 0.15), track_m=0.25, wheel_base_m=0.33, min_turn_radius_m=0.83),
    limits=Limits(max_speed_mps=0.9, max_turn_rate_dps=90.0, acceleration_mps2=0.8, deceleration_mps2=1.0, turn_acceleration_dps2=200.0),
)
