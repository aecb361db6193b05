"""What avoidance sees: takes scans and echoes, says whether they can be trusted, gives the points around the robot."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.blackboard.messages import LaserScan, SonarState
from pluto_bt.maps.platform import Platform
from pluto_bt.skills import reasons
from pluto_bt.skills.avoid_parameters import AvoidParameters
from pluto_bt.skills.obstacles import Obstacles
from pluto_bt.skills.outline import Array, Outline, Planar
from pluto_bt.skills.scan_watch import NO_PLACE, are_same
from pluto_bt.skills.sonar import SonarRing, unexplained
from pluto_bt.skills.verdict import ALL_WELL, Verdict

SLACK_M = 0.2  # how much farther than an echo a laser point may be and still explain it
BEYOND_M = 1.0  # what explains an echo may lie a little beyond the reach
FROZEN_TRAVEL_M = 0.03  # a laser that sees exactly the same after so much driving is frozen
FROZEN_TURN_RAD = 0.03


class ScanView(NamedTuple):
    """A scan with the place it was taken from; `laser` is in the frame of dead reckoning, None where that is not known (any more)."""

    scan: LaserScan
    laser: Planar | None
    tilt_rad: float = 0.0


class Sight:
    """Laser and sonar of one robot, as far as it has them."""

    def __init__(self, platform: Platform, parameters: AvoidParameters, outline: Outline) -> None:
        devices = platform.devices
        self.parameters = parameters
        self.laser = devices.laser
        self.ring = SonarRing(devices.sonar, outline) if devices.sonar else None
        self._obstacles = Obstacles(parameters)
        self.forget()

    def tune(self, parameters: AvoidParameters) -> None:
        """These parameters count from now on; the reach stays."""
        self.parameters = self._obstacles.parameters = parameters

    def forget(self) -> None:
        """As after the start."""
        self._obstacles.forget()
        self._scan: LaserScan | None = None
        self._scan_fault = Verdict(LinkStatus.LASER_SLOW_STOP, reasons.LASER_STALE, "no scan yet")
        self._changed_at: Planar | None = None
        self._sonar: SonarState | None = None
        self._sonar_is_good = False

    @property
    def scan_s(self) -> float:
        """The stamp of the newest scan; before the first one, or without a laser, that of the newest echoes."""
        newest = self._scan if self._scan is not None else self._sonar
        return -math.inf if newest is None else newest.stamp_s

    def widen(self, reach_m: float) -> None:
        """Look at obstacles up to `reach_m`, or up to the parameter where that is more; what is already remembered stays."""
        self._obstacles.reach_m = max(reach_m, self.parameters.reach_m)

    def look(self, view: ScanView | None, sonar: SonarState | None, robot: Planar, with_laser: bool, now_s: float) -> None:
        """Take what is new.

        Args:
            robot: the pose in the frame of dead reckoning now.
            with_laser: the laser is asked for, so that it explains echoes; else the echoes alone count, and longer.
        """
        if view is not None and self.laser is not None and (self._scan is None or view.scan.stamp_s != self._scan.stamp_s):
            self._scan_fault = self._judge(view, robot)
            if view.laser is not None and self._scan_fault == ALL_WELL:
                self._obstacles.add_scan(view.scan, view.laser, self.laser.z_m, view.tilt_rad, now_s)
            self._scan = view.scan
        if sonar is not None and self.ring is not None and sonar is not self._sonar:
            self._sonar = sonar
            self._listen(sonar, self.ring, robot, with_laser, now_s)

    def laser_fault(self, now_s: float) -> Verdict:
        """Why the laser cannot be trusted now; ALL_WELL if it can, or if the robot has none."""
        if self.laser is None:
            return ALL_WELL
        if self._scan is not None and now_s - self._scan.stamp_s > self.parameters.laser_stale_s and self._scan_fault.code != LinkStatus.LASER_FATAL:
            return Verdict(LinkStatus.LASER_SLOW_STOP, reasons.LASER_STALE, f"no scan younger than {self.parameters.laser_stale_s:g} s")
        return self._scan_fault

    def sonar_fault(self, now_s: float) -> Verdict:
        """Why the sonar cannot be trusted now; ALL_WELL if it can, or if the robot has none."""
        if self.ring is None or (self._sonar_is_good and self._sonar is not None and now_s - self._sonar.stamp_s <= self.parameters.sonar_stale_s):
            return ALL_WELL
        return Verdict(LinkStatus.SONAR_FRONT, reasons.SONAR_STALE, f"no usable echoes younger than {self.parameters.sonar_stale_s:g} s")

    def points(self, robot: Planar, with_laser: bool, with_sonar: bool, now_s: float) -> Array:
        """(n, 5) x, y, margin, velocity x, y in the robot frame of what is known around the robot."""
        return self._obstacles.around(robot, with_laser and self.laser is not None, with_sonar and self.ring is not None, now_s)

    def is_echo(self, which: int) -> bool:
        """True if that one of the `points` given last was heard and not seen."""
        return which >= self._obstacles.first_echo

    def sees_behind(self, with_sonar: bool) -> bool:
        """True if something watches while the robot backs."""
        return with_sonar and self.ring is not None and self.ring.hears_behind

    def _judge(self, view: ScanView, robot: Planar) -> Verdict:
        """Whether a scan can be trusted."""
        ranges = view.scan.ranges_m
        most_m = float(ranges.max()) if len(ranges) else math.nan  # NaN if any beam is
        if most_m < 0.0:
            return Verdict(LinkStatus.LASER_FATAL, reasons.LASER_FATAL, "the laser had a fatal error and is rebooting")
        if math.isnan(most_m):
            holes = float(np.mean(np.isnan(ranges))) if len(ranges) else 1.0
            if holes > self.parameters.laser_holes:
                return Verdict(LinkStatus.LASER_SLOW_STOP, reasons.LASER_STALE, f"{holes:.0%} of the beams give no number")
        if view.laser is None:
            return Verdict(reason=reasons.ODOMETRY_STALE, text=NO_PLACE)
        if self._is_frozen(ranges, robot):
            return Verdict(LinkStatus.LASER_SLOW_STOP, reasons.LASER_STALE, "the laser sees exactly the same although the robot moves")
        return ALL_WELL

    def _is_frozen(self, ranges: Array, robot: Planar) -> bool:
        at = self._changed_at
        if at is None or self._scan is None or not are_same(ranges, self._scan.ranges_m):
            self._changed_at = robot
            return False
        is_open = self.laser is not None and float(np.nanmin(ranges)) >= self.laser.max_range_m  # an empty field always looks the same
        turned_rad = math.remainder(robot[2] - at[2], math.tau)
        has_moved = math.hypot(robot[0] - at[0], robot[1] - at[1]) > FROZEN_TRAVEL_M or abs(turned_rad) > FROZEN_TURN_RAD
        return has_moved and not is_open

    def _listen(self, sonar: SonarState, ring: SonarRing, robot: Planar, with_laser: bool, now_s: float) -> None:
        """Remember the echoes that the laser does not explain; where it sees the same thing it knows better where."""
        ranges = np.array(sonar.ranges_m)
        self._sonar_is_good = ranges.shape == (ring.count,) and bool(np.isfinite(ranges).all())
        if not self._sonar_is_good:
            return
        p = self.parameters
        near = ranges < min(p.reach_m, ring.max_range_m)
        memory_s = p.sonar_memory_s
        if with_laser and self.laser is not None:
            known = self._obstacles.around(robot, True, False, now_s, BEYOND_M)
            near = near & unexplained(ring.axes, ranges, ring.half_cone_rad, known, SLACK_M)
            memory_s = p.open_echo_memory_s
        echoes = ring.place(ranges, near, p.margin_m)
        self._obstacles.add_echoes(echoes, ring.axes, ranges, ring.half_cone_rad, robot, memory_s, now_s)
