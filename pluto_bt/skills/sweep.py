"""Rolling the outline forward along an arc: when would it come too near to a point, and how fast may it go therefore?"""

from __future__ import annotations

import math

from pluto_bt.maps.kernel import kernel
from pluto_bt.skills.limits import Limits, Twist
from pluto_bt.skills.outline import Array

CREEP_IN_M = 0.02  # a point already within its margin may come nearer by this much in one decision …
FLOOR_M = 0.03  # … but never nearer than this
EXACT_M = 0.002
DEEP_INSIDE_M = -0.1  # points deeper inside the outline are the robot itself
BRAKING_SHARE = 0.8  # of the deceleration is counted on; the rest is in reserve for slopes and worn brakes
STANDSTILL_MPS = 0.02  # slower than this is not worth the motors' while
STANDSTILL_RADPS = 0.04


@kernel
def first_contact(points: Array, planes: Array, speed_mps: float, turn_rate_radps: float, horizon_s: float) -> tuple[float, int]:
    """Seconds until the outline, moving with a constant twist, comes within a point's margin; and which point it is.

    Conservative advancement (B. Mirtich, Impulse-based Dynamic Simulation of Rigid Body Systems, 1996): a point at distance d
    cannot be met before d / (its speed as seen from the robot), so that far is leapt.

    Args:
        points: (n, 5) x m, y m, margin m, velocity x and y m/s, in the frame of the robot at the start.
        planes: (k, 3) of `Outline`.
    Returns: (horizon_s, -1) if nothing is met before.
    """
    first_s, which = horizon_s, -1
    for i in range(points.shape[0]):
        x, y = points[i, 0], points[i, 1]
        lever_m = math.sqrt(x * x + y * y) + abs(speed_mps) * first_s
        own_mps = math.sqrt(points[i, 3] ** 2 + points[i, 4] ** 2)
        bound_mps = abs(speed_mps) + own_mps + abs(turn_rate_radps) * (lever_m + own_mps * first_s)
        if bound_mps <= 0.0:
            continue
        t_s, margin_m = 0.0, points[i, 2]
        while t_s < first_s:
            turn = turn_rate_radps * t_s
            c, s = math.cos(turn), math.sin(turn)
            if abs(turn) > 1e-6:
                x_t, y_t = x - speed_mps * s / turn_rate_radps, y - speed_mps * (1.0 - c) / turn_rate_radps
            else:
                x_t, y_t = x - speed_mps * t_s, y
            x_t, y_t = x_t + points[i, 3] * t_s, y_t + points[i, 4] * t_s
            px, py = c * x_t + s * y_t, c * y_t - s * x_t
            distance_m = -1e9
            for k in range(planes.shape[0]):
                distance_m = max(distance_m, planes[k, 0] * px + planes[k, 1] * py - planes[k, 2])
            if t_s == 0.0:
                if distance_m < DEEP_INSIDE_M:
                    break
                if distance_m < margin_m + EXACT_M:
                    margin_m = min(distance_m - EXACT_M, max(FLOOR_M, distance_m - CREEP_IN_M))
            gap_m = distance_m - margin_m
            if gap_m < 0.5 * EXACT_M:
                first_s, which = t_s, i
                break
            t_s += gap_m / bound_mps
    return first_s, which


def braking_time_s(twist: Twist, limits: Limits) -> float:
    """Seconds of the present motion that braking to standstill uses up: v² / 2a of the way, in units of v."""
    return max(
        abs(twist[0]) / (2.0 * BRAKING_SHARE * limits.deceleration_mps2), abs(twist[1]) / (2.0 * BRAKING_SHARE * limits.turn_acceleration_radps2)
    )


def horizon_s(twist: Twist, limits: Limits, latency_s: float) -> float:
    """How far ahead an obstacle matters to a robot that moves with `twist`."""
    return latency_s + braking_time_s(twist, limits)


def allowed_share(free_s: float, twist: Twist, limits: Limits, latency_s: float) -> float:
    """The share of `twist` with which the robot can still stop before a contact that is `free_s` of that motion away.

    Driving at the share q uses q * latency before the brakes bite and q² * braking time until it stands; the sum must not exceed `free_s`.
    Shares that mean a standstill are rounded down to 0.
    """
    braking_s = braking_time_s(twist, limits)
    if free_s >= latency_s + braking_s:
        return 1.0
    root = math.sqrt(latency_s * latency_s + 4.0 * braking_s * max(0.0, free_s))
    share = 2.0 * free_s / (latency_s + root) if root > 0.0 else 0.0
    is_still = abs(twist[0]) * share < STANDSTILL_MPS and abs(twist[1]) * share < STANDSTILL_RADPS
    return 0.0 if is_still else min(1.0, max(0.0, share))
