"""The stop filter: whatever the command, no contact with what can be known about (DESIGN.md, section 3). It slows and stops, it never steers.

It stands between drive and base, has its own eyes (`SeenSpace`), and lets a command through only as far as the robot, taking it for one
more decision and braking then, meets nothing and moves into nothing unseen faster than it creeps. Start reading at `StopFilter.step`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.blackboard.messages import ActuatorState, BumperState, FVectorState, LaserScan, SonarState
from pluto_bt.maps.platform import Platform
from pluto_bt.skills import reasons, stop_path
from pluto_bt.skills.approach import Approach
from pluto_bt.skills.filter_parameters import FilterParameters
from pluto_bt.skills.limits import STILL, Twist, limits_of, ramp
from pluto_bt.skills.map_area import MapArea
from pluto_bt.skills.map_hold import held_by_area
from pluto_bt.skills.outline import Array, Planar, outline_of
from pluto_bt.skills.scan_watch import ScanWatch
from pluto_bt.skills.seen_kernels import CELL_M, LEVEL
from pluto_bt.skills.seen_space import BEHIND_M, SeenSpace
from pluto_bt.skills.sonar import SonarRing, sonar_code, where_word
from pluto_bt.skills.stop_path import first_trouble, rim_of
from pluto_bt.skills.verdict import ALL_WELL, Verdict
from pluto_bt.skills.walkers import WalkerWatch
from pluto_bt.skills.wheel_watch import WheelWatch

BRAKING_SHARE = 0.8  # of the deceleration is counted on; the rest is in reserve for slopes and worn brakes
HALVINGS = 5  # the share of a command that may pass is found to 3 %
SLOWEST: Twist = (0.01, 0.015)  # less than both is not worth the motors' while
TOUCH_M = 0.01  # so near is as good as touching


class FilterSenses(NamedTuple):
    """The newest readings; None = there is none. `pose` is dead reckoning, `pose_map` interface 3; `age_s`: of the executive's last step.

    `laser` and `tilt_rad`: where `scan` was taken from, in the frame of dead reckoning; `sonar_at`: where the robot was when `sonar` listened.
    """

    raw: ActuatorState | None
    pose: tuple[float, Planar] | None
    pose_map: Planar | None = None
    scan: LaserScan | None = None
    laser: Planar | None = None
    tilt_rad: float = 0.0
    sonar: SonarState | None = None
    sonar_at: Planar | None = None
    bumper: BumperState | None = None
    executive_age_s: float = 0.0


class StopFilter:
    """The state of the filter between two steps."""

    def __init__(self, platform: Platform, parameters: FilterParameters, area: MapArea) -> None:
        self.parameters = p = parameters
        self.limits = limits_of(platform)
        self._platform, self._area = platform, area
        self._outline = outline_of(platform.body.outline_m)
        self._rim = rim_of(self._outline, platform.body.outline_m)
        devices, motors = platform.devices, platform.limits
        self._lag_s = motors.motor_latency_s + motors.motor_time_constant_s
        self._hold_s = p.period_s + self._lag_s + 0.05  # odometry and scheduling take their time too
        self._laser, self._sonar = devices.laser, devices.sonar
        self._watch = ScanWatch(devices.laser, p.laser_stale_s, p.laser_holes) if devices.laser else None
        self._ring = SonarRing(devices.sonar, self._outline) if devices.sonar else None
        self._approach = Approach(self._ring) if self._ring else None
        axes = self._ring.axes.tolist() if self._ring else []
        self._leaves_m = np.array([self._outline.way_out_m(x, y, math.cos(theta), math.sin(theta)) for x, y, theta in axes])
        self._least_m = (devices.bumpers.depth_m if devices.bumpers else 0.0) + TOUCH_M  # nearer the bumpers would feel it
        self.has_eyes = self._laser is not None or self._sonar is not None
        reach_m = self._window_m(self.limits.speed_mps) if self._laser else max(self._window_m(self.limits.speed_mps), p.hear_m)
        fleeting_s = max(0.0, p.obstacle_memory_s - p.fleeting_memory_s)
        self.space = SeenSpace(self._outline, reach_m + BEHIND_M, p.hear_m, fleeting_s) if self.has_eyes else None
        self.walkers = WalkerWatch(p.walker_memory_s)
        self._wheels = WheelWatch(self.limits, p.wheels_still_s, p.retry_s) if platform.body.kinematics != "ackermann" else None
        self._first_trouble = first_trouble.compiled()
        self.verdict = Verdict()
        self.out: Twist = STILL
        self._scan: LaserScan | None = None
        self._heard: SonarState | None = None
        self._has_begun = False

    def step(self, wanted: Twist, now_s: float, senses: FilterSenses) -> Twist:
        """The twist that may go to the base now."""
        out, verdict = self._passed(wanted, now_s, senses)
        is_same = verdict[:2] == self.verdict[:2] and (out == STILL) == (self.out == STILL)
        self.verdict = self.verdict if is_same else verdict  # a text is written once when a state begins, not anew with each figure
        self.out = out
        return out

    def hold(self, verdict: Verdict) -> Twist:
        """Zero, for a reason that lies outside: the latch, or a command that is missing or makes no sense."""
        self.verdict, self.out = verdict, STILL
        return STILL

    def status(self, now_s: float) -> FVectorState:
        """`filter/status` after the step: data = the velocities let through."""
        return FVectorState(now_s, self.out, (int(self.verdict.code),), self.verdict.reason, self.verdict.text)

    # ---------------------------------------------------------------- looking

    def look(self, now_s: float, senses: FilterSenses) -> None:
        """Take what is new; also called while there is no command, so that the memory is there when one comes."""
        if self.space is None or senses.pose is None:
            return
        p, space, robot = self.parameters, self.space, senses.pose[1]
        speed_mps = self.limits.speed_mps if senses.raw is None else max(abs(senses.raw.velocity[0]), abs(self.out[0]))
        window_m = self._window_m(min(speed_mps + 0.1, self.limits.speed_mps))
        grown_m = 0.0 if self._has_begun else p.assumed_clear_m
        space.roll(robot)
        self._take_scan(senses)
        self._take_echoes(senses, now_s)
        space.stand(robot, grown_m, now_s, now_s - p.obstacle_memory_s, window_m)
        self._has_begun = True

    def _take_scan(self, senses: FilterSenses) -> None:
        scan, last, self._scan = senses.scan, self._scan, senses.scan
        if scan is None or self._watch is None or self._laser is None or self.space is None or (last is not None and scan.stamp_s == last.stamp_s):
            return
        if self._watch.look(scan, senses.laser) and senses.laser is not None:
            is_level = self.space.add_scan(scan, senses.laser, self._laser.z_m, senses.tilt_rad)
            if is_level:
                self.walkers.take_scan(scan, senses.laser, self.space.believed)

    def _take_echoes(self, senses: FilterSenses, now_s: float) -> None:
        sonar, ring = senses.sonar, self._ring
        if sonar is None or sonar is self._heard or ring is None or self._sonar is None or self._approach is None or self.space is None or senses.sonar_at is None:
            return
        self._heard = sonar
        ranges_m = np.array(sonar.ranges_m)
        if ranges_m.shape != (ring.count,) or not np.isfinite(ranges_m).all() or now_s - sonar.stamp_s > self.parameters.sonar_stale_s:
            self._heard = None
            self.space.drop_echoes()
            return
        self.space.add_echoes(ring.axes, self._leaves_m, ranges_m, self._sonar, senses.sonar_at, sonar.stamp_s)
        came = self._approach.look(ranges_m, senses.sonar_at, sonar.stamp_s)
        if len(came):
            self.walkers.take_echoes(came, sonar.stamp_s)

    def _stop_m(self, speed_mps: float) -> float:
        """The way from a decision to standstill."""
        return abs(speed_mps) * self._hold_s + speed_mps * speed_mps / (2.0 * BRAKING_SHARE * self.limits.deceleration_mps2)

    def _window_m(self, speed_mps: float) -> float:
        """How far from the robot's centre things matter at a speed."""
        return self._outline.reach_m + self._stop_m(speed_mps) + stop_path.MOST_MARGIN_M + 2 * CELL_M

    # ---------------------------------------------------------------- deciding

    def _passed(self, wanted: Twist, now_s: float, senses: FilterSenses) -> tuple[Twist, Verdict]:
        """What passes of a command, and why not all of it."""
        p = self.parameters
        if not p.enabled:
            return wanted, ALL_WELL
        trouble = self._trouble(now_s, senses)
        if trouble != ALL_WELL:
            return STILL, trouble
        if wanted == STILL:
            return STILL, ALL_WELL
        held, verdict = self._bumped(wanted, senses.bumper)
        if not self.has_eyes:
            return held_by_area(self._area, held, senses.pose_map, self._stop_m(held[0]), verdict)
        if not self._hears(now_s):
            deaf = Verdict(LinkStatus.SONAR_FRONT, reasons.SONAR_STALE, f"no usable echoes younger than {p.sonar_stale_s:g} s")
            held, verdict = self._slowed(held, p.without_sonar_mps, deaf, verdict)
        laser = ALL_WELL if self._watch is None else self._watch.verdict(now_s)
        if laser != ALL_WELL:
            held, verdict = self._slowed(held, p.without_laser_mps, laser, verdict)
        assert senses.raw is not None and senses.pose is not None  # else `_trouble` had spoken
        return self._cleared(held, senses.raw, senses.pose[1], now_s, verdict)

    def _trouble(self, now_s: float, senses: FilterSenses) -> Verdict:
        """What forbids every motion."""
        p, raw = self.parameters, senses.raw
        wheels = ALL_WELL if self._wheels is None or raw is None else self._wheels.step(raw, self.out, now_s)
        if senses.executive_age_s > p.executive_silent_s:
            return Verdict(LinkStatus.NORMAL, reasons.EXECUTIVE_SILENT, f"the executive has done nothing for {senses.executive_age_s:.2f} s")
        if raw is None or now_s - raw.stamp_s > p.odometry_stale_s:
            age = "no odometry at all" if raw is None else f"the newest odometry is {now_s - raw.stamp_s:.2f} s old"
            return Verdict(LinkStatus.NORMAL, reasons.ODOMETRY_STALE, f"{age}; {p.odometry_stale_s:g} s are allowed")
        if self.has_eyes and (senses.pose is None or now_s - senses.pose[0] > p.odometry_stale_s):
            return Verdict(LinkStatus.NORMAL, reasons.NO_POSE, f"dead reckoning has given no pose for {p.odometry_stale_s:g} s")
        return wheels

    def _bumped(self, twist: Twist, bumper: BumperState | None) -> tuple[Twist, Verdict]:
        """A pressed panel: no motion towards it, and no rotation."""
        if bumper is None or not (bumper.front or bumper.back):
            return twist, ALL_WELL
        forbidden = (bumper.front and twist[0] > 0.0) or (bumper.back and twist[0] < 0.0)
        code = LinkStatus.FRONT_BUMPER if bumper.front else LinkStatus.BACK_BUMPER
        held = (0.0 if forbidden else twist[0], 0.0)
        return held, ALL_WELL if held == twist else Verdict(code, reasons.BUMPER, f"the {'front' if bumper.front else 'back'} bumper is pressed")

    def _hears(self, now_s: float) -> bool:
        """Whether the sonar, where there is one, can be trusted."""
        return self._ring is None or (self._heard is not None and now_s - self._heard.stamp_s <= self.parameters.sonar_stale_s)

    def _slowed(self, twist: Twist, most_mps: float, why: Verdict, verdict: Verdict) -> tuple[Twist, Verdict]:
        """The twist along the same arc, so slow that no point of the outline is faster than `most_mps`."""
        fastest_mps = max(abs(twist[0]), abs(twist[1]) * self._outline.reach_m)
        if fastest_mps <= most_mps:
            return twist, verdict
        share = most_mps / fastest_mps
        return (twist[0] * share, twist[1] * share), why

    def _cleared(self, twist: Twist, raw: ActuatorState, robot: Planar, now_s: float, verdict: Verdict) -> tuple[Twist, Verdict]:
        """The largest share of a twist whose stopping path is free."""
        figures = self._figures(raw)
        walkers = self.walkers.rows(now_s)
        trouble = self._look_along(twist, figures, robot, now_s, walkers)
        if trouble[0] == stop_path.CLEAR:
            return twist, verdict
        low, high = 0.0, 1.0
        for _ in range(HALVINGS):
            share = 0.5 * (low + high)
            found = self._look_along((twist[0] * share, twist[1] * share), figures, robot, now_s, walkers)
            if found[0] == stop_path.CLEAR:
                low = share
            else:
                high, trouble = share, found
        out = (twist[0] * low, twist[1] * low)
        if abs(out[0]) < SLOWEST[0] and abs(out[1]) < SLOWEST[1]:
            out = STILL
        return out, self._why(trouble, twist, out)

    def _figures(self, raw: ActuatorState) -> Array:
        """The robot as `first_trouble` reckons with it: it is already on its way to what it was told last."""
        limits, p = self.limits, self.parameters
        now = ramp((raw.velocity[0], raw.velocity[1]), self.out, limits, self._lag_s)
        return np.array([
            now[0], now[1], limits.acceleration_mps2, BRAKING_SHARE * limits.deceleration_mps2, BRAKING_SHARE * limits.turn_acceleration_radps2,
            self._hold_s, self._outline.reach_m, self._least_m, self._least_m + p.margin_m, p.margin_s, p.creep_mps,
        ])  # fmt: skip

    def _look_along(self, twist: Twist, figures: Array, robot: Planar, now_s: float, walkers: Array) -> tuple[int, int, float]:
        space = self.space
        assert space is not None
        return self._first_trouble(
            space.points, space.count, self._outline.planes, self._rim, space.seen, space.stamps, *space.corner_m, *robot, figures, *twist,
            now_s - self.parameters.free_memory_s, walkers, now_s - self.parameters.walker_gap_s,
        )  # fmt: skip

    def _why(self, trouble: tuple[int, int, float], wanted: Twist, out: Twist) -> Verdict:
        """A sentence with figures."""
        kind, which, _ = trouble
        asked = f"{wanted[0]:.2f} m/s and {math.degrees(wanted[1]):.0f} deg/s were asked for, {out[0]:.2f} and {math.degrees(out[1]):.0f} pass"
        if kind == stop_path.UNSEEN:
            x_m, y_m = self._rim[which, :2].tolist()
            return Verdict(LinkStatus.NORMAL, reasons.UNSEEN, f"{asked}: the outline {where_word(x_m, y_m)} would move where nothing was ever seen")
        if kind == stop_path.WALKER:
            x_m, y_m = self._rim[which, :2].tolist()
            return Verdict(LinkStatus.NORMAL, reasons.WALKER, f"{asked}: the outline {where_word(x_m, y_m)} would move to where somebody may walk")
        assert self.space is not None
        x_m, y_m, layer, _ = self.space.points[which].tolist()
        is_laser = layer == LEVEL and self._laser is not None
        code = LinkStatus.LASER_SLOW_STOP if is_laser else sonar_code(x_m, y_m, self._outline)
        what = f"{'the laser saw' if is_laser else 'the sonar heard'} something {self._outline.distance_m(x_m, y_m):.2f} m from the outline"
        return Verdict(code, reasons.LASER if is_laser else reasons.SONAR, f"{asked}: {what}, {where_word(x_m, y_m)}")
