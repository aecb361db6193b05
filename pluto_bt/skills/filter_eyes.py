"""The stop filter's own eyes and ears: what laser and sonar tell goes into its memory of space and of walkers, if it can be trusted."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pluto_bt.blackboard.messages import ActuatorState, BumperState, LaserScan, SonarState
from pluto_bt.maps.platform import Laser, Platform, Sonar
from pluto_bt.skills.approach import Approach
from pluto_bt.skills.filter_parameters import FilterParameters
from pluto_bt.skills.outline import Array, Outline, Planar
from pluto_bt.skills.scan_watch import Lack, ScanWatch
from pluto_bt.skills.seen_kernels import CAME
from pluto_bt.skills.seen_space import BEHIND_M, SeenSpace
from pluto_bt.skills.sonar import SonarRing
from pluto_bt.skills.verdict import ALL_WELL, Verdict
from pluto_bt.skills.walkers import ANYWHERE, WalkerWatch


class FilterSenses(NamedTuple):
    """The newest readings; None = there is none. `pose` is dead reckoning, `pose_map` interface 3, each with its stamp.

    `laser`, `tilt_rad` and `lacks` are those of `ScanView`: where `scan` was taken from, in the frame of dead reckoning;
    `sonar_at`: where the robot was when `sonar` listened; `executive_age_s`: seconds since the executive's last step;
    `doubt`: what localisation says against its own pose, because a sensor is silent.
    """

    raw: ActuatorState | None
    pose: tuple[float, Planar] | None
    pose_map: tuple[float, Planar] | None = None
    scan: LaserScan | None = None
    laser: Planar | None = None
    tilt_rad: float = 0.0
    lacks: Lack = Lack.NOTHING
    sonar: SonarState | None = None
    sonar_at: Planar | None = None
    bumper: BumperState | None = None
    executive_age_s: float = 0.0
    doubt: Verdict = ALL_WELL


class FilterEyes:
    """`space` and `walkers` are the memory; `window_m` = how far from the robot's middle things matter at most."""

    def __init__(self, platform: Platform, parameters: FilterParameters, outline: Outline, window_m: float) -> None:
        self._parameters = p = parameters
        laser, sonar = platform.devices.laser, platform.devices.sonar
        self._eye = _Eye(laser, p) if laser else None
        self._ear = _Ear(sonar, outline, p, laser is None) if sonar else None
        reach_m = window_m if laser else max(window_m, p.hear_m)
        self.space = SeenSpace(outline, reach_m + BEHIND_M, p.hear_m, max(0.0, p.obstacle_memory_s - p.fleeting_memory_s))
        self.walkers = WalkerWatch(p.walker_memory_s)
        self._begun_s: float | None = None

    @property
    def has_laser(self) -> bool:
        """True if beams are seen too, not only echoes heard."""
        return self._eye is not None

    def look(self, now_s: float, senses: FilterSenses, robot: Planar, window_m: float) -> None:
        """Take what is new; points within `window_m` are gathered."""
        p, space = self._parameters, self.space
        space.roll(robot)
        if self._eye is not None:
            self._eye.take(senses, space, self.walkers)
        if self._ear is not None:
            self._ear.take(now_s, senses, space, self.walkers)
        space.stand(robot, p.assumed_clear_m if self._begun_s is None else 0.0, now_s, now_s - p.obstacle_memory_s, window_m)
        self._begun_s = now_s if self._begun_s is None else self._begun_s

    def forget(self) -> None:
        """Nothing and nobody was ever seen."""
        self.space.forget()
        self.walkers.forget()

    def people(self, now_s: float) -> Array:
        """Where somebody may be, as `WalkerWatch.rows`. Where one walks, others may whom no sensor found, and so may who started it a moment ago."""
        rows = self.walkers.rows(now_s)
        is_new = self._begun_s is not None and now_s - self._begun_s < self._parameters.starter_s
        is_anywhere = is_new or self.walkers.is_anybody_about(now_s)
        return np.vstack((rows, ANYWHERE)) if is_anywhere else rows

    def hears(self, now_s: float) -> bool:
        """Whether the sonar, where there is one, can be trusted."""
        return self._ear is None or self._ear.is_fresh(now_s)

    def laser_fault(self, now_s: float) -> Verdict:
        """Why the laser, where there is one, cannot be trusted; ALL_WELL if it can."""
        return ALL_WELL if self._eye is None else self._eye.watch.verdict(now_s)


class _Eye:
    """The laser."""

    def __init__(self, laser: Laser, parameters: FilterParameters) -> None:
        self._z_m = laser.z_m
        self.watch = ScanWatch(laser, parameters.laser_stale_s, parameters.laser_holes)
        self._scan: LaserScan | None = None

    def take(self, senses: FilterSenses, space: SeenSpace, walkers: WalkerWatch) -> None:
        scan, last, self._scan = senses.scan, self._scan, senses.scan
        if scan is None or (last is not None and scan.stamp_s == last.stamp_s):
            return
        if not self.watch.look(scan, senses.laser, senses.lacks) or senses.laser is None:
            return
        if space.add_scan(scan, senses.laser, self._z_m, senses.tilt_rad, walkers.bodies(scan.stamp_s)):
            walkers.take_scan(scan, senses.laser, space.believed)


class _Ear:
    """The sonar ring."""

    def __init__(self, sonar: Sonar, outline: Outline, parameters: FilterParameters, is_alone: bool) -> None:
        """`is_alone`: no laser will tell in a moment what was heard."""
        self._is_alone = is_alone
        self._sonar, self._stale_s = sonar, parameters.sonar_stale_s
        self._ring = ring = SonarRing(sonar, outline)
        self._approach = Approach(ring, is_alone)
        self._leaves_m = np.array([outline.way_out_m(x, y, math.cos(theta), math.sin(theta)) for x, y, theta in ring.axes.tolist()])
        self._heard: SonarState | None = None

    def is_fresh(self, now_s: float) -> bool:
        return self._heard is not None and now_s - self._heard.stamp_s <= self._stale_s

    def take(self, now_s: float, senses: FilterSenses, space: SeenSpace, walkers: WalkerWatch) -> None:
        sonar, at = senses.sonar, senses.sonar_at
        if sonar is None or sonar is self._heard or at is None:
            return
        self._heard = sonar
        ranges_m = self._ring.readings(sonar.ranges_m)
        if ranges_m is None or now_s - sonar.stamp_s > self._stale_s:
            self._heard = None
            space.drop_echoes()
            return
        news = space.add_echoes(self._ring.axes, self._leaves_m, ranges_m, self._sonar, at, sonar.stamp_s)
        found = self._approach.look(ranges_m, at, sonar.stamp_s, news)
        walkers.take_echoes(found, sonar.stamp_s)
        if self._is_alone and (len(found) or (news >= CAME).any()):
            walkers.doubt(sonar.stamp_s)
