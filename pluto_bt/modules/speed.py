"""Adapter `speed`: the car's wheel speed, unsigned."""

from __future__ import annotations

from drivers.records import SpeedRecord
from pluto_bt.blackboard.messages import SpeedState
from pluto_bt.modules.context import Context
from pluto_bt.modules.relay import Relay


class Speed(Relay[SpeedRecord]):
    """`car/speed` from the wheel sensor."""

    def __init__(self, context: Context) -> None:
        super().__init__(context, "speed", "car/speed", SpeedRecord, lambda r: r.speed_mps, lambda r: SpeedState(r.stamp_s, abs(r.speed_mps)))
