"""Where the laser was when it looked: the robot's pose, the mount, and the wrist that pans and tilts it."""

from __future__ import annotations

import math

from pluto_bt.blackboard import Blackboard, Snapshot
from pluto_bt.blackboard.messages import LaserScan
from pluto_bt.maps.platform import Platform
from pluto_bt.modules.wrist_angles import wrist_at
from pluto_bt.skills.outline import Planar
from pluto_bt.skills.scan_watch import Lack
from pluto_bt.skills.sight import ScanView


class LaserMount:
    """The mount of one robot."""

    def __init__(self, board: Blackboard | Snapshot, platform: Platform) -> None:
        laser = platform.devices.laser
        self._board = board
        self._has_wrist = platform.devices.wrist is not None
        self._x_m, self._y_m = (laser.x_m, laser.y_m) if laser is not None else (0.0, 0.0)

    def view(self, scan: LaserScan, robot: Planar | None) -> ScanView:
        """The scan as taken by a laser on a robot that stood at `robot` (None: nobody knows)."""
        if robot is None:
            return ScanView(scan, None, lacks=Lack.ODOMETRY)
        angles = wrist_at(self._board, scan.stamp_s) if self._has_wrist else (0.0, 0.0)
        if angles is None:
            return ScanView(scan, None, lacks=Lack.WRIST)
        pan_rad, tilt_rad = angles
        c, s = math.cos(robot[2]), math.sin(robot[2])
        x_m, y_m = robot[0] + c * self._x_m - s * self._y_m, robot[1] + s * self._x_m + c * self._y_m
        return ScanView(scan, (x_m, y_m, robot[2] + pan_rad), tilt_rad)
