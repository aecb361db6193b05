"""Has somebody moved the robot? No wheels bring it so far in so short a time, or sideways."""

from __future__ import annotations

from estimation.key_scan import KeyScan

FASTER, ASIDE_M, SUDDEN_M = 2.0, 0.2, 0.08  # than the platform's top speed, or so far aside; what matching may be off besides


class Carried:
    """Remembers what the last comparison with the key scan said, so that a difference that came at once is known from one that grew."""

    def __init__(self, speed_mps: float) -> None:
        self._speed_mps = speed_mps
        self._last_s = self._last_m = 0.0

    def says(self, scan: KeyScan, off_m: float, aside_m: float, since: KeyScan | None = None) -> bool:
        """True if nobody drives so. `off_m`, `aside_m`: what the laser saw more than was reckoned since the key scan, or since another one."""
        last_s, last_m = (self._last_s, self._last_m) if since is None else (since.at.stamp_s, 0.0)
        most_m = FASTER * self._speed_mps * (scan.at.stamp_s - last_s) + SUDDEN_M
        return abs(off_m - last_m) > most_m or abs(aside_m) > ASIDE_M

    def note(self, scan: KeyScan, off_m: float) -> None:
        """So much was the difference at this scan."""
        self._last_s, self._last_m = scan.at.stamp_s, off_m
