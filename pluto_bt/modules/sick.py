"""Adapter `sick`: laser scans to the three interfaces of the manual (section 8.1)."""

from __future__ import annotations

import numpy as np

from drivers.records import ScanRecord
from pluto_bt.blackboard.messages import LaserScan, ScanTiming, read_only
from pluto_bt.modules.context import Context

RWI_POINTS = 181


class Sick:
    """`sick/scan` and `sick/timing` carry the stamp of the middle of the scan, `sick/rwi181` that of its arrival.

    Timing comes last, because it wakes localisation, which then finds the scan in place.
    """

    def __init__(self, context: Context) -> None:
        board = context.board
        self._device = context.devices["laser"]
        self._say = context.say
        self._rwi181 = board.publisher("sick/rwi181", "sick")
        self._scan = board.publisher("sick/scan", "sick")
        self._timing = board.publisher("sick/timing", "sick")
        self._pick = np.zeros(0, dtype=np.intp)  # which beams make the 181, for the last number of beams seen
        self._n_beams = 0
        self._was_fatal = False

    def start(self, now_s: float) -> None:
        """Nothing to get ready."""

    def stop(self) -> None:
        """Nothing to let go of."""

    def step(self, now_s: float) -> None:
        """Publish each scan that has arrived. One without beams is none: where only such come, the topics grow stale."""
        for record in self._device.read():
            if isinstance(record, ScanRecord) and len(record.ranges_m):
                self._publish(record, now_s)

    def _publish(self, record: ScanRecord, now_s: float) -> None:
        ranges = record.ranges_m if not record.ranges_m.flags.writeable else read_only(record.ranges_m.copy())
        n = len(ranges)
        if n != self._n_beams:
            self._pick, self._n_beams = np.linspace(0, n - 1, RWI_POINTS).round().astype(np.intp), n  # 361 beams: every second one
        self._tell_fatal(bool(ranges[0] == -1.0) and bool((ranges == -1.0).all()))
        coarse_step_rad = record.angle_step_rad * (n - 1) / (RWI_POINTS - 1)
        self._rwi181.put(LaserScan(record.arrival_s, record.angle_min_rad, coarse_step_rad, read_only(ranges[self._pick]), RWI_POINTS), now_s)
        self._scan.put(LaserScan(record.stamp_s, record.angle_min_rad, record.angle_step_rad, ranges, n), now_s)
        self._timing.put(ScanTiming(record.stamp_s, n), now_s)

    def _tell_fatal(self, is_fatal: bool) -> None:
        if is_fatal != self._was_fatal:
            self._was_fatal = is_fatal
            if is_fatal:
                self._say("error", "laser-fatal", "sick", "the laser had a fatal error and reboots (about 20 s without ranges)")
            else:
                self._say("info", "laser-back", "sick", "the laser delivers ranges again")
