"""Covariance of (x, y, theta) as six floats (xx, xy, xt, yy, yt, tt), carried along with a moving pose.

Symbols: d = (dx, dy) is the displacement from the old to the new point, in the frame of the covariance (map or odom), and F the
derivative of the new pose by the old one: F = [[1, 0, -dy], [0, 1, dx], [0, 0, 1]].
Ref: Smith, Self, Cheeseman, Estimating uncertain spatial relationships in robotics, 1990 (compounding).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

Covariance = tuple[float, float, float, float, float, float]
Nine = tuple[float, float, float, float, float, float, float, float, float]

ZERO: Covariance = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def moved(P: Covariance, dx_m: float, dy_m: float) -> Covariance:
    """F P Fᵀ: the covariance of a point that is displaced by d and turns with the old one (a step, or a lever arm)."""
    xx, xy, xt, yy, yt, tt = P
    xt_new, yt_new = xt - dy_m * tt, yt + dx_m * tt
    return (
        xx - dy_m * (xt + xt_new),
        xy + dx_m * xt_new - dy_m * yt,
        xt_new,
        yy + dx_m * (yt + yt_new),
        yt_new,
        tt,
    )


def stepped(P: Covariance, dx_m: float, dy_m: float, heading_rad: float, distance_var_m2: float, turn_var_rad2: float) -> Covariance:
    """The covariance after one step: F P Fᵀ, plus noise along the heading, plus noise of the turn.

    The turn's error acts, on average, from the middle of the step: it moves the end point by half the displacement.
    """
    xx, xy, xt, yy, yt, tt = moved(P, dx_m, dy_m)
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    hx, hy = -0.5 * dy_m, 0.5 * dx_m
    return (
        xx + c * c * distance_var_m2 + hx * hx * turn_var_rad2,
        xy + c * s * distance_var_m2 + hx * hy * turn_var_rad2,
        xt + hx * turn_var_rad2,
        yy + s * s * distance_var_m2 + hy * hy * turn_var_rad2,
        yt + hy * turn_var_rad2,
        tt + turn_var_rad2,
    )


def blended(a: Covariance, b: Covariance, share: float) -> Covariance:
    """Element by element between two covariances; stays positive semi-definite."""
    rest = 1.0 - share
    return (
        rest * a[0] + share * b[0],
        rest * a[1] + share * b[1],
        rest * a[2] + share * b[2],
        rest * a[3] + share * b[3],
        rest * a[4] + share * b[4],
        rest * a[5] + share * b[5],
    )


def as_nine(P: Covariance) -> Nine:
    """Row by row, as the messages carry it."""
    xx, xy, xt, yy, yt, tt = P
    return (xx, xy, xt, xy, yy, yt, xt, yt, tt)


def from_nine(values: tuple[float, ...]) -> Covariance:
    """The upper triangle of nine numbers, row by row. Raises ValueError for another count."""
    if len(values) != 9:
        raise ValueError(f"a covariance of (x, y, theta) has 9 numbers, not {len(values)}")
    return (values[0], values[1], values[2], values[4], values[5], values[8])


@dataclass(frozen=True, slots=True)
class StepNoise:
    """How wrong one step of dead reckoning may be. Variances grow with the way and the turn, so they do not depend on the rate.

    Attributes:
        distance_m_per_sqrt_m: standard deviation of the distance after one metre.
        wheel_turn_rad_per_sqrt_rad: of a heading from the wheels after one radian of turn.
        wheel_turn_rad_per_sqrt_m: of a heading from the wheels after one metre straight ahead.
        gyro_rad_per_sqrt_s: of a heading from the gyro after one second.
    """

    distance_m_per_sqrt_m: float = 0.03
    wheel_turn_rad_per_sqrt_rad: float = 0.1
    wheel_turn_rad_per_sqrt_m: float = 0.03
    gyro_rad_per_sqrt_s: float = 0.001

    def distance_var_m2(self, distance_m: float) -> float:
        """Variance of the length of a step."""
        return self.distance_m_per_sqrt_m**2 * abs(distance_m)

    def wheel_turn_var_rad2(self, distance_m: float, turn_rad: float) -> float:
        """Variance of the turn of a step that the wheels measured."""
        return self.wheel_turn_rad_per_sqrt_rad**2 * abs(turn_rad) + self.wheel_turn_rad_per_sqrt_m**2 * abs(distance_m)

    def gyro_turn_var_rad2(self, dt_s: float) -> float:
        """Variance of the turn of a step that the gyro measured."""
        return self.gyro_rad_per_sqrt_s**2 * dt_s
