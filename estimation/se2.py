"""Poses in the plane as plain tuples (x m, y m, theta rad): composing, inverting, arcs. Theta is not wrapped unless said.

`pose_a_c = compose(pose_a_b, pose_b_c)`: neighbouring frame names must match.
"""

from __future__ import annotations

import math

Pose2 = tuple[float, float, float]

IDENTITY: Pose2 = (0.0, 0.0, 0.0)
_SMALL_RAD = 1e-6  # below it, sin(a)/a differs from 1 by less than one part in 10^12


def compose(pose_a_b: Pose2, pose_b_c: Pose2) -> Pose2:
    """Frame c seen from frame a."""
    xa, ya, a = pose_a_b
    xb, yb, b = pose_b_c
    c, s = math.cos(a), math.sin(a)
    return (xa + c * xb - s * yb, ya + s * xb + c * yb, a + b)


def inverse(pose_a_b: Pose2) -> Pose2:
    """Frame a seen from frame b."""
    x, y, a = pose_a_b
    c, s = math.cos(a), math.sin(a)
    return (-c * x - s * y, s * x - c * y, -a)


def between(pose_a_b: Pose2, pose_a_c: Pose2) -> Pose2:
    """Frame c seen from frame b."""
    return compose(inverse(pose_a_b), pose_a_c)


def arc(distance_m: float, turn_rad: float) -> Pose2:
    """Where a wheeled robot stands after driving `distance_m` while turning evenly by `turn_rad`, seen from where it stood."""
    if abs(turn_rad) < _SMALL_RAD:
        half = 0.5 * turn_rad
        return (distance_m, distance_m * half, turn_rad)
    radius_m = distance_m / turn_rad
    return (radius_m * math.sin(turn_rad), radius_m * (1.0 - math.cos(turn_rad)), turn_rad)


def twist_of(step: Pose2) -> Pose2:
    """The constant twist (forward m, sideways m, turn rad) whose unit-time motion is `step`: the logarithm of SE(2). |turn| < 2 pi."""
    x, y, turn_rad = step
    if abs(turn_rad) < _SMALL_RAD:
        half = 0.5 * turn_rad
        return (x + half * y, y - half * x, turn_rad)
    half = 0.5 * turn_rad
    a = half / math.tan(half)
    return (a * x + half * y, a * y - half * x, turn_rad)


def motion_of(twist: Pose2) -> Pose2:
    """The motion of unit time under a constant twist: the exponential of SE(2), inverse of `twist_of`."""
    forward_m, sideways_m, turn_rad = twist
    if abs(turn_rad) < _SMALL_RAD:
        half = 0.5 * turn_rad
        return (forward_m - half * sideways_m, sideways_m + half * forward_m, turn_rad)
    a, b = math.sin(turn_rad) / turn_rad, (1.0 - math.cos(turn_rad)) / turn_rad
    return (a * forward_m - b * sideways_m, b * forward_m + a * sideways_m, turn_rad)


def blend(pose_a_b: Pose2, pose_a_c: Pose2, share: float) -> Pose2:
    """The pose at `share` (0 … 1) of the way from b to c, moving with a constant twist: exact for arcs and straight lines."""
    forward_m, sideways_m, turn_rad = twist_of(between(pose_a_b, pose_a_c))
    return compose(pose_a_b, motion_of((share * forward_m, share * sideways_m, share * turn_rad)))
