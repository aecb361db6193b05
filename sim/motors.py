"""What the base makes of drive commands before the wheels feel them: limits, latency, and the dead-man."""

from __future__ import annotations

import math
from collections import deque

from pluto_bt.maps.platform import Limits
from sim.simtime import NEVER_NS, NS, SimTime, ticks_up

DEAD_MAN_S = 0.3  # DESIGN.md, section 3: the base stops by itself without a command for this long

Command = tuple[float, float]  # speed m/s, turn rate rad/s
STOP: Command = (0.0, 0.0)


class Motors:
    """Holds the command in force and those still on their way. `drive` may be called from another thread than `advance`."""

    def __init__(self, limits: Limits, time: SimTime) -> None:
        self._max_speed_mps = limits.max_speed_mps
        self._max_turn_rate_radps = math.radians(limits.max_turn_rate_dps)
        self._latency_ns = round(limits.motor_latency_s * NS)
        self._dead_man_ns = round(DEAD_MAN_S * NS)
        self._time = time
        self._pending: deque[tuple[int, Command]] = deque()
        self._latest = STOP
        self._released_ns = NEVER_NS  # when the dead-man will let go
        self.command = STOP
        self.deaf = False

    def drive(self, speed_mps: float, turn_rate_radps: float) -> None:
        """Take a command, held within the limits; it comes into force after the latency. A NaN is a stop."""
        if self.deaf:
            return
        speed = _within(speed_mps, self._max_speed_mps)
        turn_rate = _within(turn_rate_radps, self._max_turn_rate_radps)
        now_ns = self._time.now_ns
        self._released_ns = now_ns + self._dead_man_ns
        if (speed, turn_rate) != self._latest:
            self._latest = (speed, turn_rate)
            self._pending.append((ticks_up(now_ns + self._latency_ns), self._latest))

    def next_change_ns(self) -> int:
        """The next moment at which the command in force may change."""
        pending = self._pending[0][0] if self._pending else NEVER_NS
        return min(pending, self._released_ns if self._latest != STOP or self._pending else NEVER_NS)

    def advance(self, now_ns: int) -> bool:
        """Bring what is due at `now_ns` into force; True if the command changed."""
        before = self.command
        while self._pending and self._pending[0][0] <= now_ns:
            self.command = self._pending.popleft()[1]
        if self._released_ns <= now_ns:
            self._pending.clear()
            self.command = self._latest = STOP
            self._released_ns = NEVER_NS
        return self.command != before


def _within(value: float, limit: float) -> float:
    """The value held within ±limit; 0 for NaN."""
    return min(max(value, -limit), limit) if value == value else 0.0
