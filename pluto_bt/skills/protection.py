"""Protection: how much of a motion is allowed before what laser and sonar know of, and why not all of it."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.blackboard.codes import Avoidance, LinkStatus
from pluto_bt.maps.kernel import kernel
from pluto_bt.skills import reasons
from pluto_bt.skills.limits import STILL, Limits, Twist
from pluto_bt.skills.outline import Array, Outline, Planar
from pluto_bt.skills.seen_kernels import outside_m
from pluto_bt.skills.sight import Sight
from pluto_bt.skills.sonar import sonar_code, where_word
from pluto_bt.skills.sweep import allowed_share, first_contact, horizon_s
from pluto_bt.skills.verdict import ALL_WELL, Verdict

LEAST_MPS, LEAST_RADPS = 0.01, 0.004  # slower than both is wanting to stand
AWAIT_S = 0.6  # who would walk into the robot within so long after it could have stopped is awaited standing


class Protection:
    """Brakes for one robot. It never steers."""

    def __init__(self, sight: Sight, outline: Outline, limits: Limits, latency_s: float) -> None:
        self._sight, self._outline, self.limits, self._latency_s = sight, outline, limits, latency_s

    def laser_share(self, now_s: float, dead: Planar | None, now: Twist, avoidance: Avoidance, twist: Twist) -> tuple[float, Verdict]:
        """How much of a passed-down twist the laser allows, and why not all.

        Args:
            dead: the robot in dead reckoning, None if that is not known.
            now: the twist in force.
        """
        if not avoidance & Avoidance.LASER or self._sight.laser is None:
            return 1.0, ALL_WELL
        fault = self._sight.laser_fault(now_s)
        if fault.code is LinkStatus.LASER_FATAL:
            return 0.0, fault
        if dead is None:  # without it no scan is looked at
            fault = Verdict(LinkStatus.LASER_SLOW_STOP, reasons.NO_POSE, "without dead reckoning it is not known where the obstacles are now")
        if dead is None or fault != ALL_WELL:  # who stands as he was told is not slowed, but who waits for the laser wants to hear of it
            return (1.0, fault._replace(code=LinkStatus.NORMAL)) if twist == STILL else (0.0, fault)
        if twist == STILL:
            return 1.0, ALL_WELL
        share, verdict = self.clear_share(self._sight.points(dead, True, False, now_s), twist, now)
        blind_mps = self._sight.parameters.blind_speed_mps
        if twist[0] < -blind_mps and not self._sight.sees_behind(bool(avoidance & Avoidance.SONAR)) and share > blind_mps / -twist[0]:
            share, verdict = blind_mps / -twist[0], Verdict(LinkStatus.LASER_SLOW_STOP, reasons.LASER, "no sensor sees behind: backing slowly")
        return share, verdict

    def clear_share(self, points: Array, wanted: Twist, now: Twist) -> tuple[float, Verdict]:
        """The share of the wanted twist that can be braked before any point; the twist in force counts too, since it still has to be braked."""
        if len(points) and abs(wanted[0]) < LEAST_MPS and abs(wanted[1]) < LEAST_RADPS:  # who steers sees no free way and stands by himself
            return 1.0, self._seen(points, int(np.argmin(np.hypot(points[:, 0], points[:, 1]))))
        share, verdict = 1.0, ALL_WELL
        for twist in (wanted, now) if _differs(wanted, now) else (wanted,):
            if twist == STILL:
                continue
            span_s = horizon_s(twist, self.limits, self._latency_s)
            free_s, which = first_contact(points, self._outline.planes, twist[0], twist[1], span_s)
            allowed = allowed_share(free_s, twist, self.limits, self._latency_s)
            if allowed < share:
                share, verdict = allowed, self._seen(points, which)
        if share <= 0.0 or wanted == STILL:
            return share, verdict
        is_anybody, which = who_is_inside(points, self._outline.planes)
        if which >= 0:  # he is let out before the robot moves on
            return 0.0, self._seen(points, which)
        if is_anybody:
            within_s = AWAIT_S + horizon_s(now, self.limits, self._latency_s)
            _, which = first_contact(points, self._outline.planes, 0.0, 0.0, within_s)
            if which >= 0:
                return 0.0, self._seen(points, which)
        return share, verdict

    def _seen(self, points: Array, which: int) -> Verdict:
        x_m, y_m = points[which, :2].tolist()
        text = f"{max(0.0, self._outline.distance_m(x_m, y_m)):.2f} m from the outline, {where_word(x_m, y_m)}"
        if self._sight.is_echo(which):
            return Verdict(sonar_code(x_m, y_m, self._outline), reasons.SONAR, f"echo {text}")
        return Verdict(LinkStatus.LASER_SLOW_STOP, reasons.LASER, f"obstacle {text}")


def _differs(a: Twist, b: Twist) -> bool:
    return abs(a[0] - b[0]) > 0.1 or abs(a[1] - b[1]) > 0.15 or not math.isclose(math.copysign(1.0, a[0]), math.copysign(1.0, b[0]))


@kernel
def who_is_inside(points: Array, planes: Array) -> tuple[bool, int]:
    """Whether any of the points (n, 5) walks; and the first one that has walked into the outline, -1 if there is none."""
    is_anybody, which = False, -1
    for i in range(points.shape[0]):
        if points[i, 3] != 0.0 or points[i, 4] != 0.0:
            is_anybody = True
            if which < 0 and outside_m(planes, points[i, 0], points[i, 1]) < 0.0:
                which = i
    return is_anybody, which
