"""Does a car stand that is told to drive? It goes on trying, for somebody may take away what stands there, but it is told.

Robots with a laser or sonar have `WheelWatch`, which lets go of the wheels; a car's base counts coarse pulses, and its notes let it try.
"""

from __future__ import annotations

from typing import Final

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.skills import reasons
from pluto_bt.skills.verdict import ALL_WELL, Verdict

AFTER_S: Final = 1.0  # of standing it is told; as the alarm of stuck wheels
LEAST_M: Final = 0.15  # of commanded way, more than two pulses of 6.41 cm; less says nothing
LEAST_SHARE: Final = 0.1  # of the commanded way; who counts less stands


class Hindrance:
    """Compares the way that was commanded with the way that was counted."""

    def __init__(self) -> None:
        self._begin(0.0, 0.0)
        self._last_s = 0.0
        self._verdict = ALL_WELL

    def step(self, told_mps: float, counted_m: float, now_s: float) -> Verdict:
        """`told_mps`: what the base was told till now; `counted_m`: its odometer. `hindered` while the wheels stand."""
        dt_s, self._last_s = now_s - self._last_s, now_s
        if told_mps == 0.0:
            self._begin(counted_m, now_s)
            self._verdict = ALL_WELL
            return ALL_WELL
        self._expected_m += abs(told_mps) * dt_s
        driven_m, time_s = abs(counted_m - self._counted_m), now_s - self._since_s
        if self._expected_m < LEAST_M:
            return self._verdict
        if driven_m >= LEAST_SHARE * self._expected_m:
            self._verdict = ALL_WELL
            self._begin(counted_m, now_s)
        elif time_s >= AFTER_S:
            text = f"told to drive {self._expected_m:.2f} m within {time_s:.1f} s, and the wheels have counted {driven_m:.2f} m"
            self._verdict = Verdict(LinkStatus.NORMAL, reasons.HINDERED, text)
            self._begin(counted_m, now_s)
        return self._verdict

    def _begin(self, counted_m: float, now_s: float) -> None:
        self._counted_m, self._since_s, self._expected_m = counted_m, now_s, 0.0
