"""Do the encoders follow the commands? Wheels that are told to turn and do not, or encoders that lie, look the same: neither may drive on."""

from __future__ import annotations

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.skills import reasons
from pluto_bt.skills.limits import STILL, Limits, Twist, ramp
from pluto_bt.skills.verdict import ALL_WELL, Verdict

LEAST_M, LEAST_RAD = 0.012, 0.02  # less expected way or turn says nothing
LEAST_SHARE = 0.15  # of the expected way: less counts as standing still


class WheelWatch:
    """Compares what the commands in force should have done with what the encoders say."""

    def __init__(self, limits: Limits, still_s: float, retry_s: float) -> None:
        self._limits, self._still_s, self._retry_s = limits, still_s, retry_s
        self._model: Twist = STILL
        self._last_s: float | None = None
        self._anchor: tuple[float, float, float] | None = None  # since when, and where the encoders stood
        self._way_m = self._turn_rad = 0.0
        self._held_until_s = -1.0
        self._text = ""

    def step(self, raw: ActuatorState, in_force: Twist, now_s: float) -> Verdict:
        """`in_force`: the twist that the base was told last."""
        dt_s = 0.0 if self._last_s is None else min(now_s - self._last_s, 0.2)
        self._last_s = now_s
        self._model = ramp(self._model, in_force, self._limits, dt_s)
        if now_s < self._held_until_s:
            self._anchor = None
            return Verdict(LinkStatus.NORMAL, reasons.ODOMETRY_FROZEN, self._text)
        if self._anchor is None or in_force == STILL:
            self._begin(raw, now_s)
            return ALL_WELL
        self._way_m += self._model[0] * dt_s
        self._turn_rad += self._model[1] * dt_s
        return self._compare(raw, now_s, self._anchor)

    def _compare(self, raw: ActuatorState, now_s: float, anchor: tuple[float, float, float]) -> Verdict:
        since_s, distance_m, heading_rad = anchor
        way_m, turn_rad = abs(raw.position[0] - distance_m), abs(raw.position[1] - heading_rad)
        drives, turns = abs(self._way_m) > LEAST_M, abs(self._turn_rad) > LEAST_RAD
        stands = (drives and way_m < LEAST_SHARE * abs(self._way_m)) or (turns and turn_rad < LEAST_SHARE * abs(self._turn_rad))
        if not stands:
            if drives or turns:
                self._begin(raw, now_s)
            return ALL_WELL
        if now_s - since_s < self._still_s:
            return ALL_WELL
        self._held_until_s = now_s + self._retry_s
        told = f"the wheels were told to run {abs(self._way_m):.2f} m and {abs(self._turn_rad):.2f} rad"
        self._text = f"{told}; the encoders say {way_m:.2f} m and {turn_rad:.2f} rad"
        return Verdict(LinkStatus.NORMAL, reasons.ODOMETRY_FROZEN, self._text)

    def _begin(self, raw: ActuatorState, now_s: float) -> None:
        self._anchor = (now_s, raw.position[0], raw.position[1])
        self._way_m = self._turn_rad = 0.0
