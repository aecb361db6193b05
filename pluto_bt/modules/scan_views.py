"""The laser's scans with the places they were taken from, for whoever keeps a map of them."""

from __future__ import annotations

from pluto_bt.blackboard import Snapshot
from pluto_bt.blackboard.messages import LaserScan
from pluto_bt.blackboard.poses import pose_at
from pluto_bt.maps.platform import Platform
from pluto_bt.modules.mount import LaserMount
from pluto_bt.skills.sight import ScanView

DEAD_RECKONING = "Localization/Dead-Reckoning"


class ScanViews:
    """One reader of `sick/scan` that misses none, as far as the topic's history goes back."""

    def __init__(self, platform: Platform) -> None:
        self._platform = platform
        self._seq = 0

    def new(self, moment: Snapshot) -> list[ScanView]:
        """The scans since the last call up to this moment, oldest first."""
        newest = moment.newest("sick/scan")
        if newest is None or newest.seq == self._seq:
            return []
        views, mount = [], LaserMount(moment, self._platform)
        for sample in moment.history("sick/scan"):
            if sample.seq > self._seq and isinstance(sample.value, LaserScan):
                at = pose_at(moment, DEAD_RECKONING, sample.value.stamp_s)
                views.append(mount.view(sample.value, None if at is None else (at.pose[0], at.pose[1], at.pose[3])))
        self._seq = newest.seq
        return views
