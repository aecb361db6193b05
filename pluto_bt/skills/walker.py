"""Somebody who was seen or heard to walk, and where he may be by now. Frame: dead reckoning."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pluto_bt.blackboard.messages import LaserScan
from pluto_bt.skills.outline import Array, Planar

IN_VIEW_S = 0.6  # after so long without being seen he is out of view …
BLINK_S = 4.0  # … or after so long in which no level scan looked for him
LOST_S = 1.5  # who went behind something so short a time ago may come out again at once: ground that is seen to be free does not stop him
GLANCE_S = 0.5  # a look away for so short a time does not count for one who stands
SAME_M = 0.4  # who is seen where somebody can have come to since, give or take this, is the same one
BODY_M = 0.3
REFUTED_S = 0.3  # who is not seen in the next scans, where he must be, was a phantom
UNSTEADY_MPS = 0.2  # nobody walks quite evenly
KEEPS = 0.1  # the middle of where who walks in view may be goes on with so much of his velocity; who turns on his heel at 1 m/s is awaited still
MOST_MPS, HURRY = 2.0, 1.25
HEARD_MPS = 1.2  # how fast somebody may be who was only heard


@dataclass(slots=True)
class Walker:
    """Where somebody was at `stamp_s`, how well that is known, how fast he walked when he was last seen walking, and when and how often that was.

    `looked_for_s`: how long level scans have looked for him in vain since.
    """

    x_m: float
    y_m: float
    vx_mps: float
    vy_mps: float
    unsure_m: float
    stamp_s: float
    walked_s: float
    times: int = 1
    looked_for_s: float = 0.0

    @property
    def growth_mps(self) -> float:
        """How fast he may get away from where he was."""
        speed_mps = math.hypot(self.vx_mps, self.vy_mps)
        return min(MOST_MPS, HURRY * speed_mps + UNSTEADY_MPS) if speed_mps > 0.0 else HEARD_MPS

    def spread_m(self, now_s: float) -> float:
        """How far he may be now from where he was."""
        return self.unsure_m + self.growth_mps * (now_s - self.stamp_s)

    def is_in_view(self, now_s: float) -> bool:
        """Whether he was seen just now; a laser that looks down for a moment does not lose him."""
        age_s = now_s - self.walked_s
        return age_s <= IN_VIEW_S or (self.looked_for_s <= IN_VIEW_S and age_s <= BLINK_S and self._was_seen)

    @property
    def _was_seen(self) -> bool:
        """Whether a laser saw him walk; who was only heard has no velocity."""
        return (self.vx_mps, self.vy_mps) != (0.0, 0.0)

    def row(self, now_s: float) -> tuple[float, ...]:
        """What `stop_path` reckons with: the disc in which his middle must be now (x m, y m, 4: m), how it drifts, how it grows, 1 = in view.

        Who walks in view goes on, stops, bends aside, or turns on his heel. Who was lost just now may be anywhere.
        """
        is_in_view, age_s = self.is_in_view(now_s), now_s - self.stamp_s
        if is_in_view and self._was_seen:
            drift_x, drift_y = KEEPS * self.vx_mps, KEEPS * self.vy_mps
            growth_mps = (1.0 - KEEPS) * math.hypot(self.vx_mps, self.vy_mps) + UNSTEADY_MPS
            return self.x_m + drift_x * age_s, self.y_m + drift_y * age_s, drift_x, drift_y, self.unsure_m + growth_mps * age_s, growth_mps, 1.0
        is_near = is_in_view or (self._was_seen and now_s - self.walked_s <= LOST_S)
        return self.x_m, self.y_m, 0.0, 0.0, self.spread_m(now_s), self.growth_mps, float(is_near)

    def may_be(self, seen: Walker) -> bool:
        """Whether who is seen may be he."""
        away_m = math.hypot(seen.x_m - self.x_m, seen.y_m - self.y_m)
        return away_m < self.spread_m(max(seen.stamp_s, self.stamp_s)) + seen.unsure_m + SAME_M

    def gap_m(self, seen: Walker) -> float:
        """From where he was expected to who is seen."""
        dt_s = seen.stamp_s - self.stamp_s
        return math.hypot(seen.x_m - self.x_m - self.vx_mps * dt_s, seen.y_m - self.y_m - self.vy_mps * dt_s)

    def stays(self, stamp_s: float) -> None:
        """The whole ground on which he may be is in view, and nobody walks there: he stands somewhere on it."""
        if stamp_s - self.stamp_s > GLANCE_S:
            self.unsure_m = self.spread_m(stamp_s)
        self.stamp_s = stamp_s

    def is_watched(self, scan: LaserScan, laser: Planar) -> bool:
        """Whether a scan shows all the ground on which he may be, and nothing hides it."""
        window = _window(scan, laser, self.x_m, self.y_m, self.spread_m(scan.stamp_s) + BODY_M)
        if window is None:
            return False
        away_m = math.hypot(self.x_m - laser[0], self.y_m - laser[1])
        return bool(scan.ranges_m[window].min() > away_m - self.spread_m(scan.stamp_s) - BODY_M)

    def is_refuted(self, scan: LaserScan, laser: Planar, believed: Array, seen: Sequence[Walker]) -> bool:
        """Whether every beam that passes where he can be goes on behind it, or ends at somebody who is `seen`.

        Nobody vanishes in plain view: he is that one, or never was.
        """
        if scan.stamp_s - self.stamp_s < REFUTED_S:
            return False
        spread_m = self.spread_m(scan.stamp_s)
        window = _window(scan, laser, self.x_m, self.y_m, spread_m + BODY_M)
        if window is None:
            return False
        beams = scan.ranges_m[window]
        explained = (beams > math.hypot(self.x_m - laser[0], self.y_m - laser[1]) + spread_m + BODY_M) | (believed[window] == 0.0)
        bearings = laser[2] + scan.angle_min_rad + scan.angle_step_rad * np.arange(window.start, window.stop)
        end_x, end_y = laser[0] + beams * np.cos(bearings), laser[1] + beams * np.sin(bearings)
        for one in seen:
            explained |= np.hypot(end_x - one.x_m, end_y - one.y_m) < 2.0 * BODY_M
        return bool(explained.all())


def _window(scan: LaserScan, laser: Planar, x_m: float, y_m: float, radius_m: float) -> slice | None:
    """The beams that meet a disc; None if the laser stands in it or it reaches out of the field of view."""
    away_m = math.hypot(x_m - laser[0], y_m - laser[1])
    if away_m <= radius_m:
        return None
    half_rad = math.asin(radius_m / away_m)
    middle_rad = math.remainder(math.atan2(y_m - laser[1], x_m - laser[0]) - laser[2], math.tau) - scan.angle_min_rad
    first, last = math.floor((middle_rad - half_rad) / scan.angle_step_rad), math.ceil((middle_rad + half_rad) / scan.angle_step_rad)
    return None if first < 0 or last >= len(scan.ranges_m) else slice(first, last + 1)
