"""How the mapped area holds a robot without eyes: its centre may not leave it; outside, it may only come back.

By the notes of the car the area counts as for a point, and an arc may cut its edge. With `filter.area_margin_m` the edge itself is kept.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.skills import reasons
from pluto_bt.skills.limits import STILL, Twist
from pluto_bt.skills.map_area import MapArea
from pluto_bt.skills.outline import Planar
from pluto_bt.skills.verdict import Verdict

OUTSIDE_M = 0.05  # a position may be wrong by so much before it counts as outside
SLOWEST_MPS = 0.01  # less is not worth the motors' while
FINE_M = 0.01  # so finely the edge is found
BACK_M, STEP_M = 3.0, 0.1  # an arc that does not meet the area within this way, looked at in such steps, does not lead back


def held_by_area(area: MapArea, twist: Twist, pose: Planar, stop_m: float, verdict: Verdict) -> tuple[Twist, Verdict]:
    """What passes of a twist, and why; `verdict` is that of the twist as it comes.

    The edge itself is not kept: a car on its round may come near to it on an arc that turns away in time. `stop_m` is the way to standstill.
    """
    ahead = math.copysign(1.0, twist[0])
    if twist[0] == 0.0 or area.has_point(pose[0], pose[1]) or area.has_point(*on_arc(pose, twist, OUTSIDE_M * ahead)):
        return twist, verdict
    way_back_m = np.arange(STEP_M, BACK_M + stop_m, STEP_M) * ahead
    if any(area.has_point(*on_arc(pose, twist, way_m)) for way_m in way_back_m.tolist()):
        return twist, verdict
    text = f"({pose[0]:.2f}, {pose[1]:.2f}) m is outside the mapped area, and this motion does not lead back"
    return STILL, Verdict(LinkStatus.NORMAL, reasons.OUTSIDE_MAP, text)


def held_at_edge(area: MapArea, twist: Twist, pose: Planar, braking: Braking, verdict: Verdict) -> tuple[Twist, Verdict]:
    """What passes of a twist so that the centre comes to rest inside `area`, on the arc that it drives; from outside only what leads back."""
    stop_m = braking.way_m(twist[0])
    if twist[0] == 0.0 or not area.has_point(pose[0], pose[1]):
        return held_by_area(area, twist, pose, stop_m, verdict)
    free_m = _free_m(area, twist, pose, stop_m)
    if free_m >= stop_m:
        return twist, verdict
    share = braking.speed_mps(free_m) / abs(twist[0])
    out = STILL if abs(twist[0]) * share < SLOWEST_MPS else (twist[0] * share, twist[1] * share)
    text = f"{twist[0]:.2f} m/s were asked for, {out[0]:.2f} pass: the edge of the mapped area is {free_m:.2f} m ahead"
    return out, Verdict(LinkStatus.NORMAL, reasons.OUTSIDE_MAP, text)


def _free_m(area: MapArea, twist: Twist, pose: Planar, most_m: float) -> float:
    """How far the arc of a twist leads inside the area, up to `most_m`; the edge is found to FINE_M."""
    ahead, free_m = math.copysign(1.0, twist[0]), 0.0
    for step_m in (STEP_M, FINE_M):
        while free_m < most_m and area.has_point(*on_arc(pose, twist, min(free_m + step_m, most_m) * ahead)):
            free_m += step_m
    return min(free_m, most_m)


class Braking(NamedTuple):
    """How a robot comes to rest: it goes on for `hold_s`, then slows with `deceleration_mps2`."""

    hold_s: float
    deceleration_mps2: float

    def way_m(self, speed_mps: float) -> float:
        """From the decision to standstill."""
        return abs(speed_mps) * self.hold_s + speed_mps * speed_mps / (2.0 * self.deceleration_mps2)

    def speed_mps(self, way_m: float) -> float:
        """From which it comes to rest within `way_m`."""
        slowing_mps = self.deceleration_mps2 * self.hold_s
        return math.sqrt(slowing_mps * slowing_mps + 2.0 * self.deceleration_mps2 * way_m) - slowing_mps


def on_arc(pose: Planar, twist: Twist, way_m: float) -> tuple[float, float]:
    """Where the robot is after `way_m` (negative: backwards) on the arc of a twist."""
    half_rad = 0.5 * twist[1] / twist[0] * way_m
    chord_m = way_m * (math.sin(half_rad) / half_rad if abs(half_rad) > 1e-9 else 1.0)
    return pose[0] + chord_m * math.cos(pose[2] + half_rad), pose[1] + chord_m * math.sin(pose[2] + half_rad)
