"""Adapter `dmu`: the gyro with its bias removed, filtered, and theta integrated (manual, section 8.2; seed 002 for the bias)."""

from __future__ import annotations

import math
from typing import Annotated

import msgspec
from msgspec import Meta

from drivers.records import InertialRecord
from estimation.gyro_bias import BiasNews, GyroBias
from estimation.gyro_rest import GyroRest
from estimation.inertial import InertialHeading
from pluto_bt.blackboard.messages import ActuatorState, ImuState, SpeedState
from pluto_bt.modules.context import Context
from pluto_bt.modules.imu import imu_state, sum_of_numbers
from pluto_bt.modules.link import newest
from pluto_bt.modules.relay import Relay
from pluto_bt.skills.limits import STILL


class DmuParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Table `[dmu]` of the platform file."""

    bias_samples: Annotated[int, Meta(ge=1, le=1_000_000, description="standstill samples whose mean is the gyro's bias")] = 1000
    max_bias_spread_dps: Annotated[float, Meta(gt=0, description="largest standard deviation that passes for standing still")] = 2.0
    filter_s: Annotated[float, Meta(ge=0, le=1, description="time constant of the low-pass on rates and accelerations")] = 0.04
    still_speed_mps: Annotated[float, Meta(ge=0, description="speed below which the robot stands still")] = 0.01
    still_turn_rate_dps: Annotated[float, Meta(ge=0, description="wheels' turn rate below which the robot stands still")] = 1.0


class Dmu(Relay[InertialRecord]):
    """`dmu/raw` as measured; `dmu/state` filtered, bias removed once it is known, stamped the filter's delay earlier."""

    def __init__(self, context: Context) -> None:
        super().__init__(context, "dmu", "dmu/raw", InertialRecord, sum_of_numbers, imu_state)
        p = context.parameters(DmuParameters)
        self._parameters = p
        self._state = context.board.publisher("dmu/state", "dmu")
        self._odometry, self._speed = newest(context, "ATRV2/Drive/Raw"), newest(context, "car/speed")
        self._command = newest(context, "ATRV2/Drive/Command")
        self.bias = GyroBias(p.bias_samples, math.radians(p.max_bias_spread_dps))
        self.heading = InertialHeading(p.filter_s)
        self._rest: GyroRest | None = None
        self._stamp_s = 0.0
        self._has_told = False
        self._still_turn_radps = math.radians(p.still_turn_rate_dps)

    def step(self, now_s: float) -> None:
        """Publish each sample that has arrived, both ways."""
        records = self.read()
        is_still = bool(records) and self._is_still()
        for record in records:
            x, y, z = record.turn_rates_radps
            if not self.bias.known:
                self._tell(self.bias.add(z, is_still))
            bias = self.bias.bias_radps if self._rest is None else self._rest.bias_radps
            before_rad = self.heading.theta_rad
            rates, accelerations = self.heading.step(record.stamp_s, (x, y, z - bias), record.accelerations_mps2, record.phi_rad, record.psi_rad)
            self._look_at_rest(record.stamp_s, z, before_rad, is_still)
            self._publisher.put(imu_state(record), now_s)
            stamp_s, theta = record.stamp_s - self.heading.delay_s, self.heading.theta_rad
            self._state.put(ImuState(stamp_s, theta, record.phi_rad, record.psi_rad, rates, accelerations, bias, self.bias.known), now_s)

    def _look_at_rest(self, stamp_s: float, rate_radps: float, before_rad: float, is_still: bool) -> None:
        """Once the bias is known: find it anew whenever the robot stands, and turn nothing meanwhile."""
        dt_s, self._stamp_s = stamp_s - self._stamp_s, stamp_s
        if self._rest is None:
            if self.bias.known:
                self._rest = GyroRest(self.bias.bias_radps, self.bias.spread_radps, self._parameters.bias_samples)
            return
        was_radps = self._rest.bias_radps
        self.heading.theta_rad = before_rad + self._rest.step(dt_s, rate_radps, self.heading.theta_rad - before_rad, is_still)
        if self._rest.jumped:
            now, was = math.degrees(self._rest.bias_radps), math.degrees(was_radps)
            text = f"the robot stands and the gyro shows {now:.2f} deg/s: its bias, {was:.2f} deg/s till now"
            self._say("warning", "gyro-bias-changed", "dmu", text)

    def _is_still(self) -> bool:
        """True if the wheels say so and nothing else is commanded; without any word from the wheels it is not known, so False."""
        command: ActuatorState | None = self._command()
        if command is not None and command.velocity != STILL:
            return False
        p, speed = self._parameters, self._speed()
        if isinstance(speed, SpeedState):
            return speed.speed_mps <= p.still_speed_mps
        odometry: ActuatorState | None = self._odometry()
        if odometry is None:
            return False
        v, w = odometry.velocity
        return abs(v) <= p.still_speed_mps and abs(w) <= self._still_turn_radps

    def _tell(self, news: BiasNews) -> None:
        if news is BiasNews.KNOWN:
            dps = math.degrees(self.bias.bias_radps)
            self._say("info", "gyro-bias-known", "dmu", f"gyro bias {dps:.4f} deg/s from {self.bias.taken} samples at rest")
        elif news is BiasNews.MOVED and (not self._has_told or self.bias.thrown_away >= self._parameters.bias_samples // 4):
            self._has_told = True  # later only when much was lost: a robot that stops and goes would say it all the time
            text = "the robot moved while the gyro's bias was measured: until it stands still the wheels stand in; starting again"
            self._say("info", "gyro-bias-refused", "dmu", text)
        elif news is BiasNews.UNSTEADY:
            spread = math.degrees(self.bias.spread_radps)
            self._say("warning", "gyro-bias-refused", "dmu", f"the gyro scatters by {spread:.2f} deg/s, too much for a robot at rest; starting again")
