"""The car's frame and steering: x right, y forward, heading 0 = +y and clockwise positive, degrees; steering in percent, + = right.

World x and y are the same, theta = 90° − heading (DESIGN.md, section 9). Everything beyond the car's own skills uses theta.
"""

from __future__ import annotations

import math

from pluto_bt.maps.platform import Body

SOURCE_RADIUS_M = 0.83  # of the car in the notes, at 90 %; for platforms that do not say


def heading_deg(theta_rad: float) -> float:
    """The car's heading within [-180, 180] from the world's theta."""
    return wrap180(90.0 - math.degrees(theta_rad))


def wrap180(angle_deg: float) -> float:
    """The same angle within [-180, 180]."""
    return math.remainder(angle_deg, 360.0)


def bearing_deg(from_x_m: float, from_y_m: float, to_x_m: float, to_y_m: float) -> float:
    """The heading that points from one point to another."""
    return math.degrees(math.atan2(to_x_m - from_x_m, to_y_m - from_y_m))


def turn_rate(speed_mps: float, steering_percent: float, body: Body) -> float:
    """The turn rate (rad/s, counter-clockwise) of a steering. Curvature is linear in percent."""
    radius_m = body.min_turn_radius_m or SOURCE_RADIUS_M
    return -speed_mps * steering_percent / (body.min_turn_radius_percent * radius_m)
