"""Adapter `compass`: magnetic heading."""

from __future__ import annotations

from drivers.records import CompassRecord
from pluto_bt.blackboard.messages import CompassState
from pluto_bt.modules.context import Context
from pluto_bt.modules.relay import Relay


class Compass(Relay[CompassRecord]):
    """`compass/state` from the compass."""

    def __init__(self, context: Context) -> None:
        super().__init__(
            context, "compass", "compass/state", CompassRecord, lambda r: r.heading_rad, lambda r: CompassState(r.stamp_s, r.heading_rad)
        )
