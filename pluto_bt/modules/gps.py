"""Adapter `gps`: fixes in the map frame."""

from __future__ import annotations

from drivers.records import GpsRecord
from pluto_bt.blackboard.messages import GpsState
from pluto_bt.modules.context import Context
from pluto_bt.modules.relay import Relay


class Gps(Relay[GpsRecord]):
    """`gps/state` from the receiver; quality 0 is published too: it says that there is no fix."""

    def __init__(self, context: Context) -> None:
        super().__init__(
            context, "gps", "gps/state", GpsRecord, lambda r: r.x_m + r.y_m, lambda r: GpsState(r.stamp_s, r.x_m, r.y_m, r.satellites, r.quality)
        )
