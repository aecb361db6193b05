"""What LookAround and SweepWrist share, active scanning: the wrist shows the laser one place after the other; what it sees stays in the local map."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.messages import ActuatorState, LaserScan, Pair

THERE_RAD: Final = math.radians(2.0)
RATE_DPS: Final = 60.0
ACCELERATION_DPS2: Final = 120.0
PATIENCE_S: Final = 4.0  # a wrist that does not get there keeps nobody waiting longer
SLOW_DPS: Final = 8.0  # what lies low is met by the plane of the laser only between its height over the ground and the ground …
NEAR: Final = 1.4  # … so a look at the ground begins so many times as far down, and rises slowly over all of it


class Look(NamedTuple):
    """Where the laser is pointed, and how fast it goes there."""

    pan_rad: float
    tilt_rad: float
    rate_dps: float = RATE_DPS


AHEAD: Final = Look(0.0, 0.0)


def ground(tilt_rad: float, steepest_rad: float) -> list[Look]:
    """A look over the ground ahead, from near to as far as `tilt_rad` meets it; none where that is 0."""
    near = [Look(0.0, steepest_rad)] if steepest_rad > tilt_rad else []
    return [*near, Look(0.0, tilt_rad, SLOW_DPS if near else RATE_DPS)] if tilt_rad > 0.0 else []


class WristTour:
    """Points the laser from one target to the next; at each one scan has to arrive that was taken there."""

    def __init__(self, targets: Sequence[Look], now_s: float) -> None:
        self._targets = targets
        self._next, self._since_s, self._there_s = -1, now_s, math.inf
        self._has_pointed = False

    def pause(self, now_s: float, gap_s: float) -> None:
        """Nothing is seen now: that time does not count, and a scan has to be taken later."""
        self._since_s += gap_s
        if self._there_s < math.inf:
            self._there_s = now_s

    def again(self, targets: Sequence[Look]) -> None:
        """Another round."""
        self._targets, self._next = targets, -1

    def go_on(self, robot: Robot, now_s: float) -> bool:
        """Go on with the tour; True when it is over."""
        if self._next < 0 or self._is_seen(robot, now_s):
            self._next += 1
            if self._next >= len(self._targets):
                return True
            self._since_s, self._there_s = now_s, math.inf
            self._point(robot, self._targets[self._next])
        return False

    def end(self, robot: Robot) -> None:
        """The laser looks ahead again."""
        if self._has_pointed:
            self._point(robot, AHEAD)

    def _is_seen(self, robot: Robot, now_s: float) -> bool:
        state, scan = robot.newest("wrist/state"), robot.newest("sick/scan")
        target: Pair = self._targets[self._next][:2]
        at: Pair = state.position if isinstance(state, ActuatorState) else AHEAD[:2]  # without a wrist the laser always looks ahead
        is_there = max(abs(at[i] - target[i]) for i in (0, 1)) < THERE_RAD
        if is_there and self._there_s == math.inf:
            self._there_s = now_s
        return (isinstance(scan, LaserScan) and scan.stamp_s >= self._there_s) or now_s - self._since_s > PATIENCE_S

    def _point(self, robot: Robot, look: Look) -> None:
        wrist = robot.platform.devices.wrist
        if wrist is not None:
            self._has_pointed = True
            rate_dps, acceleration_dps2 = min(look.rate_dps, wrist.max_rate_dps), min(ACCELERATION_DPS2, wrist.max_acceleration_dps2)
            robot.point_wrist(look.pan_rad, look.tilt_rad, math.radians(rate_dps), math.radians(acceleration_dps2))
