"""Adapter `wrist`: the pan-tilt unit (manual, section 8.3)."""

from __future__ import annotations

import math
from typing import Protocol, cast

from drivers.records import WristRecord
from pluto_bt.blackboard.messages import ActuatorState, Pair
from pluto_bt.maps.platform import Wrist as WristLimits
from pluto_bt.modules.context import Context, Device
from pluto_bt.modules.refusal import Refusal
from pluto_bt.modules.relay import Relay


class WristDevice(Device, Protocol):
    """A device that can be pointed."""

    def move(self, pan_rad: float, tilt_rad: float, rate_radps: float, acceleration_radps2: float) -> None:
        """Go to these angles."""


def _state(record: WristRecord) -> ActuatorState:
    return ActuatorState(record.stamp_s, 0, (record.pan_rad, record.tilt_rad), (record.pan_rate_radps, record.tilt_rate_radps))


def _numbers(command: ActuatorState) -> str:
    return f"{command.position}, {command.velocity}, {command.acceleration}"


class Wrist(Relay[WristRecord]):
    """`wrist/state` from the unit; commands to it, held within the limits of the platform. An axis moves only if its
    velocity and its acceleration are both above 0. A stop holds it where it is. What makes no sense moves nothing, and that is said."""

    def __init__(self, context: Context) -> None:
        super().__init__(context, "wrist", "wrist/state", WristRecord, lambda r: r.pan_rad + r.tilt_rad, _state)
        self._mover = cast(WristDevice, self._device)
        self._inbox = context.inboxes["wrist"]
        self._command = context.board.publisher("wrist/command", "wrist")
        self._reader = context.board.reader("wrist/state")
        self._limits = context.platform.devices.wrist or WristLimits()
        self._target: Pair = (0.0, 0.0)
        self._refusal = Refusal(context, "wrist")

    def step(self, now_s: float) -> None:
        """Command first, then what the unit says."""
        letter = self._inbox.take()
        if letter is not None:
            self._move(self._hold(now_s) if letter.is_stop else letter.command, now_s)
        super().step(now_s)

    def _hold(self, now_s: float) -> ActuatorState:
        sample = self._reader()
        here = sample.value.position if sample is not None and isinstance(sample.value, ActuatorState) else self._target
        rate, acceleration = math.radians(self._limits.max_rate_dps), math.radians(self._limits.max_acceleration_dps2)
        return ActuatorState(now_s, 0, here, (rate, rate), (acceleration, acceleration))

    def _move(self, command: ActuatorState, now_s: float) -> None:
        axes = [i for i in (0, 1) if command.velocity[i] > 0.0 and command.acceleration[i] > 0.0]
        is_sense = not any(map(math.isnan, (*command.velocity, *command.acceleration))) and all(math.isfinite(command.position[i]) for i in axes)
        self._refusal.judge("" if is_sense else f"the wrist takes finite angles, rates and accelerations, not {_numbers(command)}")
        if not axes or not is_sense:
            return
        limits = (math.radians(self._limits.pan_limit_deg), math.radians(self._limits.tilt_limit_deg))
        pan, tilt = (max(-limits[i], min(limits[i], command.position[i])) if i in axes else self._target[i] for i in (0, 1))
        self._target = (pan, tilt)
        rate = min(math.radians(self._limits.max_rate_dps), *(command.velocity[i] for i in axes))
        acceleration = min(math.radians(self._limits.max_acceleration_dps2), *(command.acceleration[i] for i in axes))
        self._mover.move(pan, tilt, rate, acceleration)
        self._command.put(ActuatorState(now_s, 0, self._target, (rate, rate), (acceleration, acceleration)), now_s)
