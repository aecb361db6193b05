"""What localisation reckons with: the way from the wheels, the turn from the best heading there is."""

from __future__ import annotations

import math
from typing import NamedTuple

from estimation.covariance import StepNoise
from estimation.heading import AbsoluteHeading, GyroHeading, HeadingSource, WheelHeading
from estimation.motion_check import Limits, MotionCheck
from estimation.odometer import Odometer, SignedSpeed
from estimation.se2 import Pose2, arc
from estimation.track import LEVEL, Tilt
from pluto_bt.blackboard.messages import ActuatorState, ImuState, SpeedState
from pluto_bt.blackboard.topics import TOPICS
from pluto_bt.modules.context import Context
from pluto_bt.skills import reasons

STALE_AFTER_S = {topic.name: topic.stale_after_s for topic in TOPICS}


class Step(NamedTuple):
    """One step of dead reckoning."""

    stamp_s: float
    motion: Pose2
    distance_var_m2: float
    turn_var_rad2: float
    tilt: Tilt


class WheelWay:
    """Way and turn from `ATRV2/Drive/Raw`."""

    def __init__(self, context: Context) -> None:
        self._raw = context.board.reader("ATRV2/Drive/Raw")
        self._odometer = Odometer(context.platform.limits.max_speed_mps)
        self._say = context.say
        self._seq = 0

    def step(self, now_s: float) -> tuple[float, float, float, float] | None:
        """(stamp s, dt s, distance m, turn rad) once for each new reading."""
        sample = self._raw()
        if sample is None or sample.seq == self._seq or not isinstance(sample.value, ActuatorState):
            return None
        self._seq = sample.seq
        distance_m, heading_rad = sample.value.position
        jumps = self._odometer.jumps
        way = self._odometer.step(sample.value.stamp_s, distance_m, heading_rad)
        if self._odometer.jumps > jumps:
            self._say("warning", "odometry-jump", "local", f"odometry jumped to {distance_m:.2f} m: the step counts as standing still")
        return None if way is None else (sample.value.stamp_s, *way)


class SpeedWay:
    """Way from the car's unsigned wheel speed, with the sign of the last command; turn as the base makes it out of the steering it was told.

    While the wheel speed is silent, the base's own count stands in: the car stands then, but it rolls on to where it stands.
    """

    def __init__(self, context: Context) -> None:
        self._speed = context.board.reader("car/speed")
        self._command = context.board.reader("ATRV2/Drive/Command")
        self._base = WheelWay(context)
        self._signed = SignedSpeed()
        self.age_s = 0.0  # of the wheel speed

    def step(self, now_s: float) -> tuple[float, float, float, float] | None:
        """(stamp s, dt s, distance m, turn rad) each time it is called; None while both are silent."""
        sample, command, base = self._speed(), self._command(), self._base.step(now_s)
        speed = sample.value if sample is not None and isinstance(sample.value, SpeedState) else None
        self.age_s = now_s if speed is None else now_s - speed.stamp_s
        is_silent = speed is None or self.age_s > STALE_AFTER_S["car/speed"]
        commanded = command.value.velocity[0] if command is not None and isinstance(command.value, ActuatorState) else 0.0
        dt_s, way_m = self._signed.step(now_s, 0.0 if speed is None else speed.speed_mps, commanded)
        if dt_s <= 0.0 or (is_silent and base is None):
            return None
        counted_m, steered_rad = (0.0, 0.0) if base is None else base[2:]
        return now_s, dt_s, counted_m if is_silent else way_m, steered_rad


class MotionSources:
    """Joins the way and the heading that this platform has.

    The heading is the gyro's (`dmu/state`; until its bias is known the wheels teach it), an absolute sensor's (`imu/state`), or the
    wheels' where there is neither or it is stale, or where `yaw_enable` is off. The tilt comes from the sensor in any case.
    """

    def __init__(self, context: Context, noise: StepNoise, yaw_enable: bool = True) -> None:
        devices = context.platform.devices
        is_car = context.platform.body.kinematics == "ackermann" and devices.speed is not None
        self._way: WheelWay | SpeedWay = SpeedWay(context) if is_car else WheelWay(context)
        self._noise = noise
        self._heading: HeadingSource
        if devices.imu is not None and devices.imu.absolute:
            self._heading, topic = AbsoluteHeading(context.start_pose[2]), "imu/state"
        else:
            self._heading, topic = GyroHeading(teaches=not is_car), "dmu/state"
        has_gyro = isinstance(self._heading, GyroHeading) and yaw_enable
        if not yaw_enable:
            self._heading = WheelHeading()
        laser = devices.laser
        limits = context.platform.limits
        able = Limits(limits.max_speed_mps, math.radians(limits.max_turn_rate_dps), laser.max_range_m if laser is not None else 0.0)
        self.check = MotionCheck(able, wheels_know_turns=not is_car, has_gyro=has_gyro, judges_turns=yaw_enable)
        self._needs_gyro = is_car and has_gyro
        self._gyro_age_s = 0.0
        self._bias_radps = 0.0
        self._sensor = context.board.reader(topic)
        self._stale_after_s = STALE_AFTER_S[topic]

    @property
    def silence(self) -> tuple[str, str]:
        """Which sensor of a car says nothing, though nothing can stand in for it: word and sentence; "" if none."""
        if isinstance(self._way, SpeedWay) and self._way.age_s > STALE_AFTER_S["car/speed"]:
            return reasons.SPEED_STALE, "the wheel speed sensor says nothing: it is not known how far the car has driven"
        if self._needs_gyro and self._gyro_age_s > self._stale_after_s:
            return reasons.GYRO_STALE, "the gyro says nothing: it is not known where the car points"
        return "", ""

    def step(self, now_s: float) -> Step | None:
        """The next step, or None if nothing new has come."""
        way = self._way.step(now_s)
        if way is None:
            return None
        stamp_s, dt_s, distance_m, wheel_turn_rad = way
        theta_rad, bias_known, tilt = self._theta_at(stamp_s, now_s)
        turn_rad, is_measured = self._heading.turn(dt_s, wheel_turn_rad, theta_rad, bias_known)
        distance_m, turn_rad = self.check.step(stamp_s, dt_s, distance_m, wheel_turn_rad, turn_rad, is_measured)
        noise = self._noise
        turn_var = noise.gyro_turn_var_rad2(dt_s) if is_measured else noise.wheel_turn_var_rad2(distance_m, wheel_turn_rad)
        tilt = tilt if self.check.believes_tilt else LEVEL
        return Step(stamp_s, arc(distance_m, turn_rad), noise.distance_var_m2(distance_m) + self.check.step_var_m2, turn_var, tilt)

    def _theta_at(self, stamp_s: float, now_s: float) -> tuple[float | None, bool, Tilt]:
        """(heading, whether its bias is known, tilt) of the sensor; None if it is missing or too old.

        The heading is carried from its own, older stamp to `stamp_s` by its turn rate.
        """
        sample = self._sensor()
        state = sample.value if sample is not None and isinstance(sample.value, ImuState) else None
        self._gyro_age_s = now_s if state is None else now_s - state.stamp_s
        if state is None or self._gyro_age_s > self._stale_after_s:
            return None, False, LEVEL
        if state.bias_radps != self._bias_radps:
            self.check.bias_moved(state.bias_radps - self._bias_radps)
            self._bias_radps = state.bias_radps
        theta_rad = state.theta_rad + state.turn_rates_radps[2] * (stamp_s - state.stamp_s)
        return theta_rad, state.bias_known, (state.phi_rad, state.psi_rad)
