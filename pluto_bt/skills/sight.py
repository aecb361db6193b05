"""What avoidance sees: takes scans and echoes, says whether they can be trusted, gives the points around the robot."""

from __future__ import annotations

import math
from typing import NamedTuple

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.blackboard.messages import LaserScan, SonarState
from pluto_bt.maps.platform import Platform
from pluto_bt.skills import reasons
from pluto_bt.skills.avoid_parameters import AvoidParameters
from pluto_bt.skills.obstacles import Obstacles
from pluto_bt.skills.outline import Array, Outline, Planar
from pluto_bt.skills.scan_watch import Lack, ScanWatch
from pluto_bt.skills.sonar import SonarRing, unexplained
from pluto_bt.skills.verdict import ALL_WELL, Verdict

SLACK_M = 0.2  # how much farther than an echo a laser point may be and still explain it
BEYOND_M = 1.0  # what explains an echo may lie a little beyond the reach


class ScanView(NamedTuple):
    """A scan with the place it was taken from; `laser` is in the frame of dead reckoning, None where that is not known (any more), for want of
    what `lacks` says."""

    scan: LaserScan
    laser: Planar | None
    tilt_rad: float = 0.0
    lacks: Lack = Lack.NOTHING


class Sight:
    """Laser and sonar of one robot, as far as it has them."""

    def __init__(self, platform: Platform, parameters: AvoidParameters, outline: Outline) -> None:
        devices = platform.devices
        self.parameters = parameters
        self.laser = devices.laser
        self.ring = SonarRing(devices.sonar, outline) if devices.sonar else None
        self._obstacles = Obstacles(parameters, outline)
        self.forget()

    def tune(self, parameters: AvoidParameters) -> None:
        """These parameters count from now on; the reach stays."""
        self.parameters = self._obstacles.parameters = parameters
        if self._watch is not None:
            self._watch.tune(parameters.laser_stale_s, parameters.laser_holes)

    def forget(self) -> None:
        """As after the start."""
        self._obstacles.forget()
        self._scan: LaserScan | None = None
        p = self.parameters
        self._watch = ScanWatch(self.laser, p.laser_stale_s, p.laser_holes, good_in_a_row=1) if self.laser is not None else None
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
        if view is not None and (self._scan is None or view.scan.stamp_s != self._scan.stamp_s):
            self._take(view, now_s)
        if sonar is not None and self.ring is not None and sonar is not self._sonar:
            self._sonar = sonar
            self._listen(sonar, self.ring, robot, with_laser, now_s)

    def laser_fault(self, now_s: float) -> Verdict:
        """Why the laser cannot be trusted now; ALL_WELL if it can, or if the robot has none."""
        return ALL_WELL if self._watch is None else self._watch.verdict(now_s)

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

    def _take(self, view: ScanView, now_s: float) -> None:
        """Remember what a scan shows, if it can be trusted and it is known where it was taken."""
        if self.laser is None or self._watch is None:
            return
        self._scan = view.scan
        if self._watch.look(view.scan, view.laser, view.lacks) and view.laser is not None:
            self._obstacles.add_scan(view.scan, view.laser, self.laser.z_m, view.tilt_rad, now_s)

    def _listen(self, sonar: SonarState, ring: SonarRing, robot: Planar, with_laser: bool, now_s: float) -> None:
        """Remember the echoes that the laser does not explain; where it sees the same thing it knows better where."""
        ranges = ring.readings(sonar.ranges_m)
        self._sonar_is_good = ranges is not None
        if ranges is None:
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
