"""The laser's scans with the places they were taken from, for whoever keeps a map of them."""

from __future__ import annotations

from pluto_bt.blackboard.messages import LaserScan
from pluto_bt.blackboard.poses import pose_at
from pluto_bt.modules.context import Context
from pluto_bt.modules.mount import LaserMount
from pluto_bt.skills.sight import ScanView

DEAD_RECKONING = "Localization/Dead-Reckoning"


class ScanViews:
    """One reader of `sick/scan` that misses none, as far as the topic's history goes back."""

    def __init__(self, context: Context) -> None:
        self._board = context.board
        self._mount = LaserMount(context.board, context.platform)
        self._seq = 0

    def new(self) -> list[ScanView]:
        """The scans since the last call, oldest first."""
        newest = self._board.newest("sick/scan")
        if newest is None or newest.seq == self._seq:
            return []
        views = []
        for sample in self._board.history("sick/scan"):
            if sample.seq > self._seq and isinstance(sample.value, LaserScan):
                at = pose_at(self._board, DEAD_RECKONING, sample.value.stamp_s)
                views.append(self._mount.view(sample.value, None if at is None else (at.pose[0], at.pose[1], at.pose[3])))
        self._seq = newest.seq
        return views
