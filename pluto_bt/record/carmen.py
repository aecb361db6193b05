"""A black box as a log of CARMEN, as SLAM programs and benchmarks read it: odometry (`ODOM`) and laser scans (`FLASER`) as lines of text.

A line of CARMEN says of a scan no angles: its beams cover the half circle in front from right to left. So only such scans can be told,
and only those that were taken level.
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np

from pluto_bt.blackboard import Sample
from pluto_bt.blackboard.messages import ActuatorState, LaserPose, LaserScan, Pose
from pluto_bt.record.box import Box
from pluto_bt.record.scans import LASER, SAME_S, SCAN, is_level, placed

ODOMETRY, SPEED = "Localization/Dead-Reckoning", "ATRV2/Drive/Raw"
HALF_CIRCLE_RAD: Final = math.pi
NEAR_S: Final = 0.6  # no pose is interpolated over a longer gap
HOST: Final = "pluto"


class CarmenLog(NamedTuple):
    """`lines` in order of time; `left_out`: why a scan could not be told -> how many."""

    lines: list[str]
    left_out: dict[str, int]


def carmen_log(box: Box) -> CarmenLog:
    """All that CARMEN has a line for."""
    samples = box.samples((SCAN, LASER, ODOMETRY, SPEED))
    odometry = _Odometry(samples[ODOMETRY], samples[SPEED])
    timed = list(odometry.lines())
    left_out: dict[str, int] = {}
    for scan, laser in placed(samples[SCAN], samples[LASER]):
        line = _scan_line(scan, laser, odometry)
        if line.startswith("FLASER"):
            timed.append((scan.stamp_s, line))
        else:
            left_out[line] = left_out.get(line, 0) + 1
    return CarmenLog([line for _, line in sorted(timed)], left_out)


def _scan_line(scan: LaserScan, laser: LaserPose | None, odometry: _Odometry) -> str:
    """The line, or why there is none."""
    robot = odometry.at(scan.stamp_s)
    if laser is None or robot is None:
        return "no pose of their moment was recorded (record.thinned_period_s=0.01 keeps every one)"
    if abs(scan.angle_step_rad * (len(scan.ranges_m) - 1) - HALF_CIRCLE_RAD) > 1.5 * scan.angle_step_rad:
        return "they do not cover a half circle"
    if not is_level(laser):
        return "they were not level"
    if not (scan.ranges_m > 0.0).all():
        return "the laser had failed"
    ranges = " ".join(f"{metres:.3f}" for metres in scan.ranges_m)
    pose = _numbers((laser.pose[0], laser.pose[1], math.remainder(laser.pose[3], math.tau)))
    return f"FLASER {len(scan.ranges_m)} {ranges} {pose} {_numbers(robot)} {_stamps(scan.stamp_s)}"


class _Odometry:
    """Where dead reckoning believed to be, at any time that was recorded."""

    def __init__(self, poses: Sequence[Sample], speeds: Sequence[Sample]) -> None:
        known = [sample.value for sample in poses if isinstance(sample.value, Pose)]
        self._t_s = np.array([pose.stamp_s for pose in known])
        self._x_m = np.array([pose.pose[0] for pose in known])
        self._y_m = np.array([pose.pose[1] for pose in known])
        self._theta_rad = np.unwrap([pose.pose[3] for pose in known])
        self._speeds = [sample.value for sample in speeds if isinstance(sample.value, ActuatorState)]
        self._speeds_s = [speed.stamp_s for speed in self._speeds]

    def at(self, t_s: float) -> tuple[float, float, float] | None:
        """x m, y m, theta rad; None where nothing was recorded nearby."""
        i = int(np.searchsorted(self._t_s, t_s))
        if not 0 < i < len(self._t_s) or self._t_s[i] - self._t_s[i - 1] > NEAR_S:
            return None
        x_m, y_m, theta_rad = (float(np.interp(t_s, self._t_s, values)) for values in (self._x_m, self._y_m, self._theta_rad))
        return x_m, y_m, math.remainder(theta_rad, math.tau)

    def lines(self) -> Iterator[tuple[float, str]]:
        """(time, `ODOM x y theta tv rv accel …`) of each recorded pose."""
        for t_s, x_m, y_m, theta_rad in zip(self._t_s.tolist(), self._x_m, self._y_m, self._theta_rad, strict=True):
            pose = _numbers((x_m, y_m, math.remainder(theta_rad, math.tau)))
            yield t_s, f"ODOM {pose} {_numbers(self._speed(t_s))} 0.000000 {_stamps(t_s)}"

    def _speed(self, t_s: float) -> tuple[float, float]:
        i = bisect.bisect_right(self._speeds_s, t_s + SAME_S) - 1
        return self._speeds[i].velocity if i >= 0 else (0.0, 0.0)


def _numbers(values: Sequence[float]) -> str:
    return " ".join(f"{value:.6f}" for value in values)


def _stamps(t_s: float) -> str:
    return f"{t_s:.6f} {HOST} {t_s:.6f}"
