"""Module `alarms`: what the orientation sensor and the encoders say of a robot in trouble (jBot article, section IX), in `imu/alarms`.

Stasis and stuck wheels stay until somebody reads them: a letter in the inbox `alarms`, as the first leaf of the Escape tree sends it.
"""

from __future__ import annotations

import math
from typing import Annotated

import msgspec
from msgspec import Meta

from estimation.stasis import Stasis, StuckWheels, tilt_rad
from pluto_bt.blackboard.messages import ActuatorState, AlarmState, ImuState
from pluto_bt.blackboard.topics import TOPICS
from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.modules.context import Context
from pluto_bt.modules.link import newest
from pluto_bt.skills import reasons

STALE_AFTER_S = {topic.name: topic.stale_after_s for topic in TOPICS}


class AlarmsParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Table `[alarms]` of the platform file. The defaults are the constants of the jBot article."""

    not_turning_radps: Annotated[float, Meta(ge=0, description="the orientation sensor shows less: the body does not turn")] = 0.1
    are_turning_radps: Annotated[float, Meta(gt=0, description="the wheels show more: they turn")] = 0.2
    stasis_count: Annotated[int, Meta(ge=1, description="more steps of 0.05 s in which both is so, good ones taken off, raise the alarm")] = 60
    tilt_limit_deg: Annotated[float, Meta(gt=0, le=180, description="steeper, in any direction, is an alarm")] = 50.0
    wheels_stuck_after_s: Annotated[float, Meta(gt=0, description="commanded wheels that stand still for so long are stuck")] = 1.0


class Alarms:
    """Looks 20 times a second. The body's turn is that of `imu/state`, else of the integrated gyro in `dmu/state`."""

    def __init__(self, context: Context) -> None:
        p = context.parameters(AlarmsParameters)
        self._tilt_limit_rad = math.radians(p.tilt_limit_deg)
        self._stasis = Stasis(p.not_turning_radps, p.are_turning_radps, p.stasis_count)
        self._stuck = StuckWheels(p.wheels_stuck_after_s)
        devices = context.platform.devices
        self._sensor = "imu/state" if devices.imu is not None and devices.imu.absolute else "dmu/state"
        self._wheels_know_turns = context.platform.body.kinematics != "ackermann"
        self._body = newest(context, self._sensor)
        self._raw = newest(context, "ATRV2/Drive/Raw")
        self._commanded, self._filter = newest(context, "ATRV2/Drive/Command"), newest(context, "filter/status")
        self._told = (0.0, 0.0)  # what the wheels were told last, before the stop filter let go of wheels that stand still
        self._inbox = context.inboxes["alarms"]
        self._topic = context.board.publisher("imu/alarms", "alarms")
        self._last: tuple[float, float, float] | None = None  # wheels' stamp s, wheels' heading rad, body's theta rad

    def start(self, now_s: float) -> None:
        """Turns are counted from the first step on."""
        self._last = None

    def stop(self) -> None:
        """Nothing to let go of."""

    def step(self, now_s: float) -> None:
        """One look."""
        if self._inbox.take() is not None:
            self._stasis.read()
            self._stuck.read()
        raw, body = self._fresh(self._raw(), "ATRV2/Drive/Raw", now_s), self._fresh(self._body(), self._sensor, now_s)
        command, verdict = self._commanded(), self._filter()
        if isinstance(command, ActuatorState) and (verdict is None or verdict.reason != reasons.ODOMETRY_FROZEN):
            self._told = command.velocity
        if isinstance(raw, ActuatorState):
            self._stuck.step(now_s, self._told, raw.velocity)
        self._look_at_turns(raw, body)
        tilt = tilt_rad(body.phi_rad, body.psi_rad) if isinstance(body, ImuState) else 0.0
        self._topic.put(AlarmState(now_s, self._stasis.alarm, self._stuck.alarm, tilt > self._tilt_limit_rad, tilt, self._stasis.count), now_s)

    def _look_at_turns(self, raw: object, body: object) -> None:
        """The change since the last look, of the wheels and of the body; none across a gap of either."""
        last, self._last = self._last, None
        if not (isinstance(raw, ActuatorState) and isinstance(body, ImuState) and self._wheels_know_turns):
            return
        self._last = (raw.stamp_s, raw.position[1], body.theta_rad)
        if last is None:
            return
        dt_s = raw.stamp_s - last[0]
        if dt_s <= 0.0:
            self._last = last  # the base has said nothing new: the next change is that of both steps
            return
        self._stasis.step(dt_s, wrap_angle(raw.position[1] - last[1]), wrap_angle(body.theta_rad - last[2]))

    @staticmethod
    def _fresh(value: object, topic: str, now_s: float) -> object:
        stamp_s = getattr(value, "stamp_s", -math.inf)
        return value if now_s - stamp_s <= STALE_AFTER_S[topic] else None
