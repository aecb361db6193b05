"""What wheels and heading sensor said of the last seconds, summed up, so that it can be compared with what a laser saw between two scans."""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

from estimation.history import enclosing
from estimation.se2 import IDENTITY, Pose2, arc, between, blend, compose


class Sums(NamedTuple):
    """Everything since the start, at one stamp.

    Attributes:
        pose: reckoned as localisation does; a way that was found wrong is put right at once, what is owed of a turn is left out.
        wheels_m, wheels_rad: way and turn as the wheels have them. turn_rad: as reckoned. measured_s: so long it was a sensor's.
    """

    stamp_s: float
    pose: Pose2 = IDENTITY
    wheels_m: float = 0.0
    wheels_rad: float = 0.0
    turn_rad: float = 0.0
    measured_s: float = 0.0


class Motion(NamedTuple):
    """What happened until a stamp, within `time_s`; `pose`: the end seen from the beginning."""

    until_s: float
    pose: Pose2
    time_s: float
    wheels_m: float
    wheels_rad: float
    turn_rad: float
    measured_s: float

    @property
    def is_measured(self) -> bool:
        """True if the turn is that of a sensor, not of the wheels."""
        return self.measured_s > 0.5 * self.time_s


class Reckoning:
    """The sums at each step of the last seconds."""

    def __init__(self, moments: int = 256) -> None:
        self._moments: deque[Sums] = deque([Sums(0.0)], maxlen=moments)

    @property
    def now_s(self) -> float:
        """The newest stamp."""
        return self._moments[-1].stamp_s

    def add(self, stamp_s: float, dt_s: float, way_m: float, turn_rad: float, wheels: tuple[float, float], is_measured: bool) -> Sums:
        """The sums after one more step: way and turn as reckoned; `wheels`: way and turn as the wheels have them."""
        last = self._moments[-1]
        pose = last.pose if way_m == turn_rad == 0.0 else compose(last.pose, arc(way_m, turn_rad))
        measured_s = last.measured_s + (dt_s if is_measured else 0.0)
        now = Sums(stamp_s, pose, last.wheels_m + wheels[0], last.wheels_rad + wheels[1], last.turn_rad + turn_rad, measured_s)
        self._moments.append(now)
        return now

    def put_right(self, at: Sums, heading_rad: float, way_m: float, share: float) -> float:
        """At a moment the robot was so much farther along a heading, and since then by such a share more of the wheels' way.

        What was reckoned before stays, so motions that began before know of it. Returns how much farther it is by now, in metres.
        """
        c, s, farther_m = math.cos(heading_rad), math.sin(heading_rad), way_m
        for i in range(len(self._moments) - 1, -1, -1):
            moment = self._moments[i]
            if moment.stamp_s < at.stamp_s:
                break
            more_m = way_m + share * (moment.wheels_m - at.wheels_m)
            farther_m = more_m if i == len(self._moments) - 1 else farther_m
            x, y, theta = moment.pose
            self._moments[i] = moment._replace(pose=(x + c * more_m, y + s * more_m, theta))
        return farther_m

    def at(self, stamp_s: float) -> Sums | None:
        """The sums at a stamp; None if it is not remembered."""
        found = enclosing(self._moments, stamp_s)
        if found is None:
            return None
        before, after, share = found
        if before is after:
            return after
        sums = (x + share * (y - x) for x, y in zip(before[2:], after[2:], strict=True))
        return Sums(stamp_s, blend(before.pose, after.pose, share), *sums)


def motion_between(a: Sums, b: Sums) -> Motion:
    """What happened from one moment to another."""
    sums = (y - x for x, y in zip(a[2:], b[2:], strict=True))
    return Motion(b.stamp_s, between(a.pose, b.pose), b.stamp_s - a.stamp_s, *sums)


def together(motions: list[Motion]) -> Motion:
    """Several as one, their poses left out."""
    return Motion(motions[-1].until_s, IDENTITY, *(sum(values) for values in zip(*(motion[2:] for motion in motions), strict=True)))
