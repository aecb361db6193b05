"""Is the robot trapped? Three signs: wheels that turn a body which does not, wheels that do not turn, and a slope that is too steep.

Ref: D. P. Anderson, IMU Odometry (the jBot article), section IX; the constants are the article's (DESIGN.md, section 9, row stasis).
"""

from __future__ import annotations

import math


def tilt_rad(phi_rad: float, psi_rad: float) -> float:
    """The angle between the robot's z axis and the vertical, whatever its direction, from pitch (phi) and roll (psi)."""
    return math.acos(min(1.0, max(-1.0, math.cos(psi_rad) * math.cos(phi_rad))))


class Stasis:
    """Counts the steps in which the wheels report a turn and the orientation sensor does not.

    One more for each such step, one less for each good one; above `limit` the alarm is raised and the count begins anew. The alarm
    stays until `read` takes it.
    """

    __slots__ = ("alarm", "are_turning_radps", "count", "limit", "not_turning_radps")

    def __init__(self, not_turning_radps: float = 0.1, are_turning_radps: float = 0.2, limit: int = 60) -> None:
        self.not_turning_radps = not_turning_radps
        self.are_turning_radps = are_turning_radps
        self.limit = limit
        self.count = 0
        self.alarm = False

    def step(self, dt_s: float, wheel_turn_rad: float, body_turn_rad: float) -> None:
        """One step of about 50 ms. The turns are the sums of all changes since the last step; the body's may be wrapped or not."""
        body_rad = abs(math.remainder(body_turn_rad, math.tau))
        if body_rad < self.not_turning_radps * dt_s and abs(wheel_turn_rad) > self.are_turning_radps * dt_s:
            self.count += 1
        elif self.count:
            self.count -= 1
        if self.count > self.limit:
            self.alarm, self.count = True, 0

    def read(self) -> bool:
        """Whether there was an alarm since the last call; takes it back."""
        was, self.alarm = self.alarm, False
        return was


class StuckWheels:
    """Wheels that are told to turn, for `after_s` in all, and do not. The alarm stays until `read` takes it.

    Short rests between the tries count neither way, for whoever protects the motors lets them rest and try again; wheels that move, or
    `FORGET_S` without a command, begin the count anew.
    """

    FORGET_S = 3.0

    __slots__ = ("_last_s", "_told_at_s", "_told_s", "after_s", "alarm", "still_mps", "still_radps")

    def __init__(self, after_s: float = 1.0, still_mps: float = 0.01, still_radps: float = 0.02) -> None:
        self.after_s, self.still_mps, self.still_radps = after_s, still_mps, still_radps
        self.alarm = False
        self._told_s = 0.0
        self._last_s = self._told_at_s = -math.inf

    def step(self, now_s: float, commanded: tuple[float, float], measured: tuple[float, float]) -> None:
        """One look at the command in force and the encoders' velocities: m/s and rad/s each. Commands below 2 `still` say nothing."""
        dt_s, self._last_s = min(now_s - self._last_s, self.after_s / 4.0), now_s
        is_told = abs(commanded[0]) > 2.0 * self.still_mps or abs(commanded[1]) > 2.0 * self.still_radps
        if abs(measured[0]) >= self.still_mps or abs(measured[1]) >= self.still_radps or now_s - self._told_at_s > self.FORGET_S:
            self._told_s = 0.0
            self._told_at_s = now_s
        elif is_told:
            self._told_s += dt_s
            self._told_at_s = now_s
        self.alarm = self.alarm or self._told_s >= self.after_s - 1e-9

    def read(self) -> bool:
        """Whether there was an alarm since the last call; takes it back, and begins to look anew."""
        was, self.alarm, self._told_s = self.alarm, False, 0.0
        return was
