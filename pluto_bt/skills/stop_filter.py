"""The stop filter: whatever the command, no contact with what can be known about (DESIGN.md, section 3). It slows and stops, it never steers.

It stands between drive and base, has its own eyes (`FilterEyes`), and lets a command through only as far as the robot, taking it for one
more decision and braking then, meets nothing and moves into nothing unseen faster than it creeps. Start reading at `StopFilter.step`.
"""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.blackboard.messages import ActuatorState, BumperState, FVectorState
from pluto_bt.maps.platform import Platform
from pluto_bt.skills import reasons, stop_path
from pluto_bt.skills.filter_eyes import FilterEyes, FilterSenses
from pluto_bt.skills.filter_parameters import FilterParameters
from pluto_bt.skills.hindrance import Hindrance
from pluto_bt.skills.limits import STILL, Twist, limits_of, ramp
from pluto_bt.skills.map_area import MapArea
from pluto_bt.skills.map_hold import Braking, held_at_edge, held_by_area
from pluto_bt.skills.outline import Array, Planar, outline_of
from pluto_bt.skills.seen_kernels import CELL_M, LEVEL
from pluto_bt.skills.sonar import sonar_code, where_word
from pluto_bt.skills.stop_path import first_trouble, rim_of
from pluto_bt.skills.verdict import ALL_WELL, Verdict
from pluto_bt.skills.wheel_watch import WheelWatch

__all__ = ["FilterSenses", "StopFilter"]

BRAKING_SHARE = 0.8  # of the deceleration is counted on; the rest is in reserve for slopes and worn brakes
HALVINGS = 5  # the share of a command that may pass is found to 3 %
SLOWEST: Twist = (0.01, 0.015)  # less than both is not worth the motors' while
TOUCH_M = 0.01  # so near is as good as touching


class StopFilter:
    """The state of the filter between two steps."""

    def __init__(self, platform: Platform, parameters: FilterParameters, area: MapArea) -> None:
        self.parameters = p = parameters
        self.limits = limits_of(platform)
        self._platform, self._area = platform, area.shrunk(p.area_margin_m)
        self._outline = outline_of(platform.body.outline_m)
        self._rim = rim_of(self._outline, platform.body.outline_m)
        devices, motors = platform.devices, platform.limits
        self._lag_s = motors.motor_latency_s + motors.motor_time_constant_s
        self._hold_s = p.period_s + self._lag_s + 0.05  # odometry and scheduling take their time too
        self._braking = Braking(self._hold_s, BRAKING_SHARE * self.limits.deceleration_mps2)
        self._has_bumpers = devices.bumpers is not None
        self._least_m = (devices.bumpers.depth_m if devices.bumpers else 0.0) + TOUCH_M  # nearer the bumpers would feel it
        has_eyes = devices.laser is not None or devices.sonar is not None
        self.eyes = FilterEyes(platform, p, self._outline, self._window_m(self.limits.speed_mps)) if has_eyes else None
        self._wheels = WheelWatch(self.limits, p.wheels_still_s, p.retry_s) if platform.body.kinematics != "ackermann" else None
        self._first_trouble = first_trouble.compiled()
        self._hindrance = Hindrance() if self._wheels is None else None
        limits = self.limits
        self._robot: Array = np.array([
            0.0, 0.0, limits.acceleration_mps2, BRAKING_SHARE * limits.deceleration_mps2, BRAKING_SHARE * limits.turn_acceleration_radps2,
            self._hold_s, self._outline.reach_m, self._least_m, self._least_m + p.margin_m, p.margin_s, p.creep_mps,
        ])  # fmt: skip
        self.verdict = Verdict()
        self.out: Twist = STILL

    def step(self, wanted: Twist, now_s: float, senses: FilterSenses) -> Twist:
        """The twist that may go to the base now."""
        out, verdict = self._passed(wanted, now_s, senses)
        if self._hindrance is not None and senses.raw is not None:
            hindered = self._hindrance.step(self.out[0], senses.raw.position[0], now_s)
            verdict = hindered if verdict == ALL_WELL else verdict
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
        if self.eyes is None or senses.pose is None:
            return
        speed_mps = self.limits.speed_mps if senses.raw is None else max(abs(senses.raw.velocity[0]), abs(self.out[0]))
        self.eyes.look(now_s, senses, senses.pose[1], self._window_m(min(speed_mps + 0.1, self.limits.speed_mps)))

    def forget(self) -> None:
        """The robot stands in another place: nothing that was seen is there."""
        if self.eyes is not None:
            self.eyes.forget()

    def _window_m(self, speed_mps: float) -> float:
        """How far from the robot's centre things matter at a speed."""
        return self._outline.reach_m + self._braking.way_m(speed_mps) + stop_path.MOST_MARGIN_M + 2 * CELL_M

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
        if self.eyes is None:
            place = senses.pose_map  # fresh, or `_trouble` had spoken, where there is an area to leave
            return (held, verdict) if place is None else self._in_area(held, place[1], verdict)
        if not self.eyes.hears(now_s):
            deaf = Verdict(LinkStatus.SONAR_FRONT, reasons.SONAR_STALE, f"no usable echoes younger than {p.sonar_stale_s:g} s")
            held, verdict = self._slowed(held, p.without_sonar_mps, deaf, verdict)
        laser = self.eyes.laser_fault(now_s)
        if laser != ALL_WELL:
            held, verdict = self._slowed(held, p.without_laser_mps, laser, verdict)
        assert senses.raw is not None and senses.pose is not None  # else `_trouble` had spoken
        return self._cleared(self.eyes, held, senses.raw, senses.pose[1], now_s, verdict)

    def _trouble(self, now_s: float, senses: FilterSenses) -> Verdict:
        """What forbids every motion."""
        p, raw = self.parameters, senses.raw
        wheels = ALL_WELL if self._wheels is None or raw is None else self._wheels.step(raw, self.out, now_s)
        if senses.executive_age_s > p.executive_silent_s:
            return Verdict(LinkStatus.NORMAL, reasons.EXECUTIVE_SILENT, f"the executive has done nothing for more than {p.executive_silent_s:g} s")
        if raw is None or now_s - raw.stamp_s > p.odometry_stale_s:
            text = "no odometry at all" if raw is None else f"the newest odometry is older than {p.odometry_stale_s:g} s"
            return Verdict(LinkStatus.NORMAL, reasons.ODOMETRY_STALE, text)
        bumper = senses.bumper
        if self._has_bumpers and (bumper is None or now_s - bumper.stamp_s > p.bumper_stale_s):
            return Verdict(LinkStatus.NORMAL, reasons.BUMPER_STALE, f"no bumper reading younger than {p.bumper_stale_s:g} s")
        return self._placeless(now_s, senses) or wheels

    def _placeless(self, now_s: float, senses: FilterSenses) -> Verdict | None:
        """What is missing of the pose that the filter reckons with: with eyes dead reckoning, else the one on the map, if an area holds it there."""
        stale_s = self.parameters.odometry_stale_s
        if self.eyes is not None:
            pose, whose = senses.pose, "dead reckoning"
        elif self._area.is_everything:
            return None
        elif senses.doubt != ALL_WELL:
            return senses.doubt
        else:
            pose, whose = senses.pose_map, "localisation"
        is_known = pose is not None and now_s - pose[0] <= stale_s
        return None if is_known else Verdict(LinkStatus.NORMAL, reasons.NO_POSE, f"{whose} has given no pose for {stale_s:g} s")

    def _in_area(self, twist: Twist, robot: Planar, verdict: Verdict) -> tuple[Twist, Verdict]:
        """What the mapped area lets through: as for a point, or so that the robot keeps from its edge."""
        if self.parameters.area_margin_m == 0.0:
            return held_by_area(self._area, twist, robot, self._braking.way_m(twist[0]), verdict)
        return held_at_edge(self._area, twist, robot, self._braking, verdict)

    def _bumped(self, twist: Twist, bumper: BumperState | None) -> tuple[Twist, Verdict]:
        """A pressed panel: no motion towards it, and no rotation."""
        if bumper is None or not (bumper.front or bumper.back):
            return twist, ALL_WELL
        forbidden = (bumper.front and twist[0] > 0.0) or (bumper.back and twist[0] < 0.0)
        code = LinkStatus.FRONT_BUMPER if bumper.front else LinkStatus.BACK_BUMPER
        held = (0.0 if forbidden else twist[0], 0.0)
        return held, ALL_WELL if held == twist else Verdict(code, reasons.BUMPER, f"the {'front' if bumper.front else 'back'} bumper is pressed")

    def _slowed(self, twist: Twist, most_mps: float, why: Verdict, verdict: Verdict) -> tuple[Twist, Verdict]:
        """The twist along the same arc, so slow that no point of the outline is faster than `most_mps`."""
        fastest_mps = max(abs(twist[0]), abs(twist[1]) * self._outline.reach_m)
        if fastest_mps <= most_mps:
            return twist, verdict
        share = most_mps / fastest_mps
        return (twist[0] * share, twist[1] * share), why

    def _cleared(
        self, eyes: FilterEyes, twist: Twist, raw: ActuatorState, robot: Planar, now_s: float, verdict: Verdict
    ) -> tuple[Twist, Verdict]:
        """The largest share of a twist whose stopping path is free."""
        space, figures, walkers, p = eyes.space, self._figures(raw), eyes.people(now_s), self.parameters

        def trouble_at(share: float) -> tuple[int, int, float]:
            return self._first_trouble(
                space.points, space.count, self._outline.planes, self._rim, space.seen, space.stamps, *space.corner_m, *robot, figures,
                twist[0] * share, twist[1] * share, now_s - p.free_memory_s, walkers, now_s - p.walker_gap_s,
                now_s - p.stranger_gap_s,
            )  # fmt: skip

        trouble = trouble_at(1.0)
        if trouble[0] == stop_path.CLEAR:
            return twist, verdict
        low, high = 0.0, 1.0
        for _ in range(HALVINGS):
            share = 0.5 * (low + high)
            found = trouble_at(share)
            if found[0] == stop_path.CLEAR:
                low = share
            else:
                high, trouble = share, found
        out = (twist[0] * low, twist[1] * low)
        if abs(out[0]) < SLOWEST[0] and abs(out[1]) < SLOWEST[1]:
            out = STILL
        return out, self._why(eyes, trouble, twist, out)

    def _figures(self, raw: ActuatorState) -> Array:
        """The robot as `first_trouble` reckons with it: it is already on its way to what it was told last."""
        self._robot[stop_path.SPEED], self._robot[stop_path.TURN_RATE] = ramp(raw.velocity, self.out, self.limits, self._lag_s)
        return self._robot

    def _why(self, eyes: FilterEyes, trouble: tuple[int, int, float], wanted: Twist, out: Twist) -> Verdict:
        """A sentence with figures."""
        kind, which, _ = trouble
        asked = f"{wanted[0]:.2f} m/s and {math.degrees(wanted[1]):.0f} deg/s were asked for, {out[0]:.2f} and {math.degrees(out[1]):.0f} pass"
        if kind != stop_path.MEETS:
            part = where_word(*self._rim[which, :2].tolist())
            if kind == stop_path.UNSEEN:
                return Verdict(LinkStatus.NORMAL, reasons.UNSEEN, f"{asked}: the outline {part} would move where nothing was ever seen")
            return Verdict(LinkStatus.NORMAL, reasons.WALKER, f"{asked}: the outline {part} would move to where somebody may walk")
        x_m, y_m, layer, _ = eyes.space.points[which].tolist()
        is_laser = layer == LEVEL and eyes.has_laser
        code = LinkStatus.LASER_SLOW_STOP if is_laser else sonar_code(x_m, y_m, self._outline)
        away_m = max(0.0, self._outline.distance_m(x_m, y_m))
        what = f"{'the laser saw' if is_laser else 'the sonar heard'} something {away_m:.2f} m from the outline"
        return Verdict(code, reasons.LASER if is_laser else reasons.SONAR, f"{asked}: {what}, {where_word(x_m, y_m)}")
