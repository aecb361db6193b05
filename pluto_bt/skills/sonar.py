"""What the sonar ring hears, as points in the robot frame."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.maps.kernel import kernel
from pluto_bt.maps.platform import Sonar
from pluto_bt.skills.outline import Array, Outline

Mask = NDArray[np.bool_]
ECHO_SPREAD = 0.25  # the echo came from somewhere in the cone: it is put on the axis and at this share of the opening to each side

POINTS_AN_ECHO = 3
DEAF_M = 0.02  # readings are not more exact than this


class SonarRing:
    """The geometry of a ring, worked out once.

    A cone says how far the echo is, not where in the cone it arose. Three points stand for it; neighbouring cones overlap
    and cover what lies beyond them, and an obstacle that is only just in a cone's edge, such as a door post, is not put before the robot.
    """

    def __init__(self, sonar: Sonar, outline: Outline) -> None:
        self.max_range_m = sonar.max_range_m
        self.min_range_m = sonar.min_range_m
        self.count = len(sonar.transducers)
        spread_rad = math.radians(sonar.cone_deg) * ECHO_SPREAD
        places = np.array([(t.x_m, t.y_m) for t in sonar.transducers]).repeat(POINTS_AN_ECHO, axis=0)
        angles = [math.radians(t.theta_deg) + side * spread_rad for t in sonar.transducers for side in (-1.0, 0.0, 1.0)]
        ways = np.column_stack([np.cos(angles), np.sin(angles)])
        leaves_m = [outline.way_out_m(*place, *way) for place, way in zip(places.tolist(), ways.tolist(), strict=True)]
        self._beams = np.column_stack([places, ways, leaves_m])
        self.axes = np.array([(t.x_m, t.y_m, math.radians(t.theta_deg)) for t in sonar.transducers])
        self.half_cone_rad = math.radians(sonar.cone_deg) / 2.0
        self.hears_behind = any(abs(math.remainder(math.radians(t.theta_deg), math.tau)) > math.radians(135.0) for t in sonar.transducers)
        self.hears_ahead = any(abs(math.remainder(math.radians(t.theta_deg), math.tau)) < math.radians(45.0) for t in sonar.transducers)

    def points(self, ranges_m: Sequence[float], within_m: float, margin_m: float) -> Array | None:
        """(n, 5) x, y, margin and no velocity of the echoes nearer than `within_m`; None if the readings make no sense (NaN, wrong number)."""
        ranges = self.readings(ranges_m)
        return None if ranges is None else self.place(ranges, ranges < min(within_m, self.max_range_m), margin_m)

    def readings(self, ranges_m: Sequence[float]) -> Array | None:
        """(k,) what the transducers read; None if it makes no sense (NaN, infinite, wrong number)."""
        makes_sense = len(ranges_m) == self.count and math.isfinite(sum(ranges_m))  # a sixth of the time of asking an array
        return np.array(ranges_m) if makes_sense else None

    def place(self, ranges_m: Array, wanted: Mask, margin_m: float) -> Array:
        """The points of the transducers in the mask `wanted`.

        A transducer is deaf below its least range and reports that range for everything nearer: such an echo is put on the outline.
        """
        return echo_points(ranges_m, wanted, self._beams, self.min_range_m + DEAF_M, margin_m)


def sonar_code(x_m: float, y_m: float, outline: Outline) -> LinkStatus:
    """3, 4 or 5: whether an echo at (x, y) lies in front of, behind, or beside the outline."""
    ahead_m, aside_m = max(x_m - outline.front_m, -outline.back_m - x_m), abs(y_m) - outline.side_m
    if aside_m > ahead_m:
        return LinkStatus.SONAR_SIDES
    return LinkStatus.SONAR_FRONT if x_m > 0.0 else LinkStatus.SONAR_BACK


def where_word(x_m: float, y_m: float) -> str:
    """ "3 degrees left", "120 degrees right": the bearing of a point for a sentence."""
    bearing_deg = math.degrees(math.atan2(y_m, x_m))
    return f"{abs(bearing_deg):.0f} degrees {'left' if bearing_deg >= 0.0 else 'right'}"


@kernel
def echo_points(ranges_m: Array, wanted: Mask, beams: Array, deaf_below_m: float, margin_m: float) -> Array:
    """(n, 5) x, y, margin and no velocity: the points of the wanted transducers' echoes, as many for each as there are beams.

    Args:
        beams: (k * POINTS_AN_ECHO, 5) x m, y m, cos, sin, and the way out of the outline in metres.
        deaf_below_m: an echo up to here may come from anything nearer: it is put on the outline.
    """
    per_echo = beams.shape[0] // ranges_m.shape[0]
    points = np.zeros((np.count_nonzero(wanted) * per_echo, 5))
    n = 0
    for b in range(beams.shape[0]):
        k = b // per_echo
        if wanted[k]:
            way_m = max(ranges_m[k] if ranges_m[k] > deaf_below_m else 0.0, beams[b, 4])
            points[n, 0] = beams[b, 0] + beams[b, 2] * way_m
            points[n, 1] = beams[b, 1] + beams[b, 3] * way_m
            points[n, 2] = margin_m
            n += 1
    return points


@kernel
def unexplained(axes: Array, ranges_m: Array, half_cone_rad: float, points: Array, slack_m: float) -> Mask:
    """Which echoes no known point explains: nothing known lies in the cone as near as the echo (a glass door, a low kerb).

    Args:
        axes: (k, 3) transducers, x m, y m, theta rad.
        points: (n, 5) known points in the robot frame.
        slack_m: how much farther than the echo a point may be and still explain it.
    """
    open_echo = np.ones(axes.shape[0], dtype=np.bool_)
    opening = np.tan(half_cone_rad)
    for k in range(axes.shape[0]):
        c, s = np.cos(axes[k, 2]), np.sin(axes[k, 2])
        for i in range(points.shape[0]):
            dx, dy = points[i, 0] - axes[k, 0], points[i, 1] - axes[k, 1]
            ahead, aside = c * dx + s * dy, c * dy - s * dx
            if dx * dx + dy * dy < (ranges_m[k] + slack_m) ** 2 and abs(aside) <= ahead * opening + slack_m:
                open_echo[k] = False
                break
    return open_echo
