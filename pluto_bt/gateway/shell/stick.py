"""The arrow keys as a joystick: what velocity each key asks for, and when no key is held any more. No clock, no keyboard.

A terminal tells that a key was hit and then repeats it, first after a pause, then quickly; it never tells that it was let go. So a key counts as
held for `FIRST_HOLD_S` (longer than the pause before the first repeat), then for `REPEAT_HOLD_S` after each repeat; the robot stops after that.

Every key starts from the velocities really in force (`drive/status`, data), not from those asked for last: who hits the arrow again after the
robot was stopped by an obstacle begins from rest, as the Pluto manual wants it (section 6.1).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

FIRST_HOLD_S = 0.75
REPEAT_HOLD_S = 0.3
FASTER_MPS = 0.15
TURN_RADPS = math.radians(15.0)
MAX_TURN_RADPS = math.radians(60.0)
OLD_S = 0.5


@dataclass(frozen=True, slots=True)
class Real:
    """The velocities in force, and when that was heard."""

    speed_mps: float
    turn_radps: float
    heard_s: float


class Stick:
    """Velocities to ask for. `hit` with each key, `velocity` whenever a command is due."""

    def __init__(self, max_speed_mps: float) -> None:
        self._max_speed_mps = max_speed_mps
        self._wanted = (0.0, 0.0)
        self._held_until_s = -math.inf

    def hit(self, key: str, now_s: float, real: Real | None) -> str:
        """A key: `up`, `down`, `left`, `right`; any other is let go. Returns "" or why it is not obeyed."""
        if key not in ("up", "down", "left", "right"):
            self.release()
            return ""
        if real is None or now_s - real.heard_s > OLD_S:
            self.release()
            return "no word of the drive: not driving" if real is None else f"drive/status is {now_s - real.heard_s:.1f} s old: not driving"
        self._held_until_s = now_s + (REPEAT_HOLD_S if self.is_held(now_s) else FIRST_HOLD_S)
        if key in ("up", "down"):
            faster = FASTER_MPS if key == "up" else -FASTER_MPS
            self._wanted = (_within(real.speed_mps + faster, self._max_speed_mps), 0.0)
        else:
            turn = TURN_RADPS if key == "left" else -TURN_RADPS
            self._wanted = (_within(real.speed_mps, self._max_speed_mps), _within(real.turn_radps + turn, MAX_TURN_RADPS))
        return ""

    def release(self) -> None:
        """No key is held."""
        self._wanted, self._held_until_s = (0.0, 0.0), -math.inf

    def is_held(self, now_s: float) -> bool:
        """True while a key counts as held."""
        return now_s < self._held_until_s

    def velocity(self, now_s: float) -> tuple[float, float]:
        """Speed m/s and turn rate rad/s to ask for now; zero once the key was let go."""
        if not self.is_held(now_s):
            self.release()
        return self._wanted


def _within(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))
