"""The drive: velocities and headings within what the robot can do, bumpers, sonar protection, the 4 s timeout (Pluto manual, 6.1).

`cmdFlags` 0 velocity, 1 regulator; +10 adds sonar protection. Everything else is refused with zero velocity.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import msgspec
from msgspec import Meta

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.blackboard.messages import ActuatorState, BumperState, FVectorState, SonarState
from pluto_bt.maps.platform import NotNegative, Platform, Positive
from pluto_bt.skills import reasons
from pluto_bt.skills.bumper import BumperLatch
from pluto_bt.skills.heading import Line, regulate
from pluto_bt.skills.limits import STILL, Limits, Twist, limits_of, ramp, within
from pluto_bt.skills.outline import Array, outline_of
from pluto_bt.skills.sonar import SonarRing, sonar_code, where_word
from pluto_bt.skills.sweep import allowed_share, first_contact, horizon_s
from pluto_bt.skills.verdict import ALL_WELL, Verdict, kept

FLAGS = (0, 1, 10, 11)


class DriveParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Table [drive] of a platform file. A limit of 0 is the platform's own."""

    max_speed_mps: Annotated[NotNegative, Meta(description="speed limit; 0 = the platform's own")] = 0.0
    max_turn_rate_dps: Annotated[NotNegative, Meta(description="limit of the turn rate; 0 = the platform's own")] = 0.0
    acceleration_mps2: Annotated[NotNegative, Meta(description="limit when it gets faster; 0 = the platform's own")] = 0.0
    deceleration_mps2: Annotated[NotNegative, Meta(description="limit when it gets slower; 0 = the platform's own")] = 0.0
    timeout_s: Annotated[Positive, Meta(description="without a new command for so long the robot makes a controlled stop")] = 4.0
    odometry_stale_s: Annotated[Positive, Meta(description="older odometry means zero velocity")] = 0.3
    bumper_stale_s: Annotated[Positive, Meta(description="older bumper readings mean zero velocity")] = 0.5
    sonar_stale_s: Annotated[Positive, Meta(description="older echoes mean zero velocity while sonar protection is asked for")] = 0.5
    sonar_margin_m: Annotated[NotNegative, Meta(description="distance that sonar protection keeps from the outline")] = 0.08
    sonar_look_m: Annotated[Positive, Meta(description="echoes farther than this do not matter")] = 2.5
    blind_speed_mps: Annotated[NotNegative, Meta(description="speed under sonar protection towards a side without transducers")] = 0.15
    calibration_file: Annotated[str, Meta(description="odometry calibration, written to the base at start; empty = the platform's figures")] = ""
    period_s: Annotated[Positive, Meta(description="time between two steps, part of the reaction time that is reckoned with")] = 0.05


class DriveSenses(NamedTuple):
    """The newest readings; None = there never was one."""

    raw: ActuatorState | None
    sonar: SonarState | None = None
    bumper: BumperState | None = None


def drive_limits(platform: Platform, parameters: DriveParameters) -> Limits:
    """The limits that the drive holds; avoidance reckons with the same."""
    p = parameters
    return limits_of(
        platform,
        speed_mps=p.max_speed_mps,
        turn_rate_dps=p.max_turn_rate_dps,
        acceleration_mps2=p.acceleration_mps2,
        deceleration_mps2=p.deceleration_mps2,
    )


def is_finite(command: ActuatorState) -> bool:
    """True if every number of the command is one that can be driven; where one was missing the inbox has put NaN."""
    numbers = (*command.position, *command.velocity, *command.acceleration, *command.force)
    return all(map(math.isfinite, numbers))


class Drive:
    """The state of the drive between two steps: the command, since when it counts, the twist in force, the latch."""

    def __init__(self, platform: Platform, parameters: DriveParameters) -> None:
        self.tune(platform, parameters)
        self._outline = outline_of(platform.body.outline_m)
        self._latency_s = parameters.period_s + platform.limits.motor_latency_s + platform.limits.motor_time_constant_s
        self._ring = SonarRing(platform.devices.sonar, self._outline) if platform.devices.sonar else None
        self._echoes: Array | None = None
        self._heard: SonarState | None = None
        self._has_bumpers = platform.devices.bumpers is not None
        self._latch = BumperLatch()
        self._line = Line()
        self.reset()

    def tune(self, platform: Platform, parameters: DriveParameters) -> None:
        """These parameters count from now on."""
        self.parameters, self.limits = parameters, drive_limits(platform, parameters)

    def reset(self) -> None:
        """Stand still without a command, as after the start."""
        self.command: ActuatorState | None = None
        self.twist: Twist = STILL
        self.verdict = ALL_WELL
        self._is_stopped = False
        self._is_bad = False
        self._since_s = 0.0
        self._last_s: float | None = None
        self._bumper = BumperState(0.0)

    def accept(self, command: ActuatorState, now_s: float, amends: bool = False) -> None:
        """Take a command.

        Args:
            amends: it is the order already held with other figures (avoidance slows, or follows a moving frame): neither
                the timeout nor the bumper latch counts it as new.
        """
        self.command, self._is_stopped = command, False
        self._is_bad = command.flags not in FLAGS or not is_finite(command)
        if not amends:
            self._since_s = now_s
            self._latch.new_command(self._bumper.front, self._bumper.back)

    def stop(self, command: ActuatorState) -> None:
        """Zero velocity at once; `command` is the empty one that stands for the stop."""
        self.command, self._is_stopped, self._is_bad = command, True, False
        self.twist = STILL

    def step(self, now_s: float, senses: DriveSenses) -> Twist:
        """The twist that the base must drive now."""
        dt_s = 0.0 if self._last_s is None else min(max(now_s - self._last_s, 0.0), 2.0 * self.parameters.period_s)
        self._last_s = now_s
        if senses.bumper is not None:
            self._bumper = senses.bumper
            self._latch.press(senses.bumper.front, senses.bumper.back)
        wanted, at_once, verdict = self._wanted(now_s, senses)
        held = self._latch.held(wanted)
        if self._latch.code:
            verdict = Verdict(self._latch.code, reasons.BUMPER, f"{'front' if self._latch.front else 'back'} bumper pressed")
            self.twist = self._latch.held(self.twist)  # no ramp against a wall
        self.twist = STILL if at_once else ramp(self.twist, held, self.limits, dt_s)
        self.verdict = kept(self.verdict, verdict)
        return self.twist

    def status(self, now_s: float) -> FVectorState:
        """`drive/status` after the step."""
        return FVectorState(now_s, self.twist, (int(self.verdict.code),), self.verdict.reason, self.verdict.text)

    def _wanted(self, now_s: float, senses: DriveSenses) -> tuple[Twist, bool, Verdict]:
        """What the command asks for after all protection but the bumpers; whether zero means at once; and why."""
        command, p = self.command, self.parameters
        if command is None:
            return STILL, False, ALL_WELL
        if self._is_stopped:
            return STILL, True, Verdict(reason=reasons.STOPPED, text="stop was commanded")
        if self._is_bad:
            return STILL, True, Verdict(reason=reasons.BAD_COMMAND, text=f"drive takes finite numbers and cmdFlags 0, 1, 10, 11; not {command.flags}")
        raw = senses.raw
        if raw is None or now_s - raw.stamp_s > p.odometry_stale_s:
            return STILL, True, Verdict(reason=reasons.ODOMETRY_STALE, text=f"no odometry for more than {p.odometry_stale_s:g} s")
        if self._has_bumpers and (senses.bumper is None or now_s - senses.bumper.stamp_s > p.bumper_stale_s):
            return STILL, True, Verdict(reason=reasons.BUMPER_STALE, text=f"no bumper reading for more than {p.bumper_stale_s:g} s")
        if now_s - self._since_s >= p.timeout_s:
            text = f"no new command for {p.timeout_s:g} s"
            return STILL, False, Verdict(LinkStatus.COMMAND_TIMEOUT, reasons.COMMAND_TIMEOUT, text)
        twist = self._commanded(command, raw)
        if command.flags >= 10 and self._ring is not None and twist != STILL:
            return self._guarded(twist, now_s, senses.sonar, self._ring)
        return twist, False, ALL_WELL

    def _commanded(self, command: ActuatorState, raw: ActuatorState) -> Twist:
        """The twist of the command itself, within the limits."""
        if command.flags % 10 == 0:
            return within(command.velocity, self.limits)
        error_rad = self._line.error_rad(command.position[1], raw.position[1], raw.position[0])
        speed_mps, most_radps = command.velocity
        return within(regulate(error_rad, speed_mps, self.limits, max(0.0, most_radps)), self.limits)

    def _guarded(self, twist: Twist, now_s: float, sonar: SonarState | None, ring: SonarRing) -> tuple[Twist, bool, Verdict]:
        """Sonar protection: so slow that the robot stops before the nearest echo on its way."""
        p = self.parameters
        if sonar is not self._heard:
            self._heard = sonar
            self._echoes = None if sonar is None else ring.points(sonar.ranges_m, p.sonar_look_m, p.sonar_margin_m)
        if sonar is None or self._echoes is None or now_s - sonar.stamp_s > p.sonar_stale_s:
            return STILL, True, Verdict(LinkStatus.SONAR_FRONT, reasons.SONAR_STALE, f"no usable echoes for more than {p.sonar_stale_s:g} s")
        is_blind = not (ring.hears_ahead if twist[0] > 0.0 else ring.hears_behind)
        if is_blind and abs(twist[0]) > p.blind_speed_mps:
            twist = within((math.copysign(p.blind_speed_mps, twist[0]), twist[1]), self.limits)
        latency_s = self._latency_s + (now_s - sonar.stamp_s)
        span_s = horizon_s(twist, self.limits, latency_s)
        free_s, which = first_contact(self._echoes, self._outline.planes, twist[0], twist[1], span_s)
        share = allowed_share(free_s, twist, self.limits, latency_s)
        if share >= 1.0:
            return twist, False, ALL_WELL
        x_m, y_m = self._echoes[which, :2].tolist()
        text = f"echo {max(0.0, self._outline.distance_m(x_m, y_m)):.2f} m from the outline, {where_word(x_m, y_m)}"
        return (twist[0] * share, twist[1] * share), share == 0.0, Verdict(sonar_code(x_m, y_m, self._outline), reasons.SONAR, text)
