"""How the mapped area holds a robot without eyes: its centre may not leave it; outside, it may only come back."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.skills import reasons
from pluto_bt.skills.limits import STILL, Twist
from pluto_bt.skills.map_area import MapArea
from pluto_bt.skills.outline import Planar
from pluto_bt.skills.verdict import Verdict

OUTSIDE_M = 0.05  # a position may be wrong by so much before it counts as outside
BACK_M, STEP_M = 3.0, 0.1  # an arc that does not meet the area within this way, looked at in such steps, does not lead back


def held_by_area(area: MapArea, twist: Twist, pose: Planar, stop_m: float, verdict: Verdict) -> tuple[Twist, Verdict]:
    """What passes of a twist, and why; `verdict` is that of the twist as it comes.

    The edge itself is not kept: a car on its round may come near to it on an arc that turns away in time. `stop_m` is the way to standstill.
    """
    if twist[0] == 0.0:
        return twist, verdict
    ahead = math.copysign(1.0, twist[0])
    if area.has_point(pose[0], pose[1]) or area.has_point(*on_arc(pose, twist, OUTSIDE_M * ahead)):
        return twist, verdict
    way_back_m = np.arange(STEP_M, BACK_M + stop_m, STEP_M) * ahead
    if any(area.has_point(*on_arc(pose, twist, way_m)) for way_m in way_back_m.tolist()):
        return twist, verdict
    text = f"({pose[0]:.2f}, {pose[1]:.2f}) m is outside the mapped area, and this motion does not lead back"
    return STILL, Verdict(LinkStatus.NORMAL, reasons.OUTSIDE_MAP, text)


def on_arc(pose: Planar, twist: Twist, way_m: float) -> tuple[float, float]:
    """Where the robot is after `way_m` (negative: backwards) on the arc of a twist."""
    half_rad = 0.5 * twist[1] / twist[0] * way_m
    chord_m = way_m * (math.sin(half_rad) / half_rad if abs(half_rad) > 1e-9 else 1.0)
    return pose[0] + chord_m * math.cos(pose[2] + half_rad), pose[1] + chord_m * math.sin(pose[2] + half_rad)
