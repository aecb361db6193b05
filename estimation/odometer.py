"""From what a base counts since power-on to the motion of one step. A jump of the counters (a restarted controller) moves nothing."""

from __future__ import annotations

from pluto_bt.maps.geometry import wrap_angle


class Odometer:
    """Differences of a distance and a heading that run on. Counts the `jumps` that no robot of this speed can have made."""

    __slots__ = ("_last", "jumps", "max_speed_mps")

    MARGIN_M = 0.05  # quantisation and jitter of the stamps

    def __init__(self, max_speed_mps: float) -> None:
        self.max_speed_mps = max_speed_mps
        self.jumps = 0
        self._last: tuple[float, float, float] | None = None  # stamp s, distance m, heading rad

    def step(self, stamp_s: float, distance_m: float, heading_rad: float) -> tuple[float, float, float] | None:
        """(dt s, distance m, turn rad) since the last reading; None for the first one and for one that is not newer."""
        last = self._last
        if last is not None and stamp_s <= last[0]:
            return None
        self._last = (stamp_s, distance_m, heading_rad)
        if last is None:
            return None
        dt_s, way_m = stamp_s - last[0], distance_m - last[1]
        if abs(way_m) > 2.0 * self.max_speed_mps * dt_s + self.MARGIN_M:
            self.jumps += 1
            return dt_s, 0.0, 0.0
        return dt_s, way_m, wrap_angle(heading_rad - last[2])


class SignedSpeed:
    """The car's wheel speed has no sign: it is that of the last command that was not zero (seed 003 does the same with its encoders)."""

    __slots__ = ("_last_s", "_sign")

    def __init__(self) -> None:
        self._sign = 1.0
        self._last_s: float | None = None

    def step(self, now_s: float, speed_mps: float, commanded_mps: float) -> tuple[float, float]:
        """(dt s, signed distance m) since the last call."""
        if commanded_mps != 0.0:
            self._sign = 1.0 if commanded_mps > 0.0 else -1.0
        dt_s = 0.0 if self._last_s is None else max(0.0, now_s - self._last_s)
        self._last_s = now_s
        return dt_s, self._sign * speed_mps * dt_s
