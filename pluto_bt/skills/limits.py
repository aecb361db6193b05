"""How fast the robot may go and how quickly that may change: the dynamic constraints of the drive."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pluto_bt.maps.platform import Body, Platform

Twist = tuple[float, float]  # forward speed m/s, turn rate rad/s (counter-clockwise)
STILL: Twist = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits in force. `min_turn_radius_m` > 0: an Ackermann car, which turns only while it rolls."""

    speed_mps: float
    turn_rate_radps: float
    acceleration_mps2: float
    deceleration_mps2: float
    turn_acceleration_radps2: float
    min_turn_radius_m: float = 0.0


def limits_of(
    platform: Platform, *, speed_mps: float = 0.0, turn_rate_dps: float = 0.0, acceleration_mps2: float = 0.0, deceleration_mps2: float = 0.0
) -> Limits:
    """The platform's limits, each lowered to the given one where that is > 0."""
    body, most = platform.body, platform.limits
    return Limits(
        min(speed_mps or math.inf, most.max_speed_mps),
        math.radians(min(turn_rate_dps or math.inf, most.max_turn_rate_dps)),
        min(acceleration_mps2 or math.inf, most.acceleration_mps2),
        min(deceleration_mps2 or math.inf, most.deceleration_mps2),
        math.radians(most.turn_acceleration_dps2),
        _tightest_radius_m(body) if body.kinematics == "ackermann" else 0.0,
    )


def _tightest_radius_m(body: Body) -> float:
    """Turning radius at full lock: curvature grows linearly with the steering percentage."""
    return body.min_turn_radius_m * body.min_turn_radius_percent / 100.0


def within(twist: Twist, limits: Limits) -> Twist:
    """The nearest twist that the robot can drive; a car keeps its curvature when the speed is cut, and does not turn on the spot."""
    speed_mps, turn_rate_radps = twist
    slow_mps = clamp(speed_mps, limits.speed_mps)
    if limits.min_turn_radius_m <= 0.0:
        return slow_mps, clamp(turn_rate_radps, limits.turn_rate_radps)
    if speed_mps == 0.0:
        return STILL
    curvature_per_m = clamp(turn_rate_radps / speed_mps, 1.0 / limits.min_turn_radius_m)
    return slow_mps, slow_mps * curvature_per_m


def ramp(now: Twist, wanted: Twist, limits: Limits, dt_s: float) -> Twist:
    """The twist after `dt_s` on the way from `now` to `wanted`, within the accelerations. A car keeps the curvature of `wanted`."""
    speed_mps = _towards(now[0], wanted[0], limits.acceleration_mps2 * dt_s, limits.deceleration_mps2 * dt_s)
    if limits.min_turn_radius_m > 0.0:
        if wanted[0] != 0.0:
            return speed_mps, speed_mps * wanted[1] / wanted[0]
        return speed_mps, speed_mps * (now[1] / now[0] if now[0] else 0.0)
    turn_step_radps = limits.turn_acceleration_radps2 * dt_s
    return speed_mps, _towards(now[1], wanted[1], turn_step_radps, turn_step_radps)


def _towards(now: float, wanted: float, faster: float, slower: float) -> float:
    """One step from `now` to `wanted`: at most `slower` towards zero, and at most `faster` away from it."""
    if now * wanted < 0.0:
        wanted = 0.0  # first stop, then go the other way
    step = slower if abs(wanted) < abs(now) else faster
    return wanted if abs(wanted - now) <= step else now + math.copysign(step, wanted - now)


def clamp(value: float, most: float) -> float:
    """`value` within ±`most`."""
    return -most if value < -most else min(value, most)
