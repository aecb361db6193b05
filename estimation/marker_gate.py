"""The gate for camera markers (seed 002; DESIGN.md, section 9): quality, heading against the gyro, speed from the last accepted one."""

from __future__ import annotations

import math
from dataclasses import dataclass

from estimation.se2 import Pose2
from pluto_bt.maps.geometry import wrap_angle

LOW_QUALITY, BAD_HEADING, TOO_FAST, NOT_NEWER = "low-quality", "bad-heading", "too-fast", "not-newer"


@dataclass(slots=True)
class MarkerGate:
    """Remembers the last accepted marker. An infinite or missing number never passes.

    Attributes:
        min_quality: a quality at or above passes; values above 1 exist.
        max_heading_error_rad: the camera's heading against the gyro's; equal passes.
        max_speed_mps: from the last accepted position, must be below; the first marker has no such test.
    """

    min_quality: float = 0.25
    max_heading_error_rad: float = math.radians(45.0)
    max_speed_mps: float = 1.0
    accepted_count: int = 0
    _last: tuple[float, float, float] | None = None  # stamp s, x m, y m

    def judge(self, stamp_s: float, pose_map_robot: Pose2, quality: float, heading_rad: float) -> str:
        """ "" if the marker passes (it is then the last accepted one), else why not. `heading_rad` is the gyro's at the stamp."""
        if not self.min_quality <= quality < math.inf:
            return LOW_QUALITY
        x, y, theta = pose_map_robot
        if not math.isfinite(theta) or abs(wrap_angle(theta - heading_rad)) > self.max_heading_error_rad:
            return BAD_HEADING
        refused = self._too_fast(stamp_s, x, y)
        if not refused:
            self._last = (stamp_s, x, y)
            self.accepted_count += 1
        return refused

    def forget(self) -> None:
        """The car was carried: how far the next marker is from the last accepted one says nothing."""
        self._last = None

    def _too_fast(self, stamp_s: float, x_m: float, y_m: float) -> str:
        if not (math.isfinite(x_m) and math.isfinite(y_m)):
            return TOO_FAST
        if self._last is None:
            return ""
        last_s, last_x, last_y = self._last
        if stamp_s <= last_s:
            return NOT_NEWER
        return "" if math.hypot(x_m - last_x, y_m - last_y) < self.max_speed_mps * (stamp_s - last_s) else TOO_FAST
