"""What stands around the robot: points of the last scan and echoes, remembered for a while in the frame of dead reckoning."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.blackboard.messages import LaserScan
from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills import movers
from pluto_bt.skills.avoid_parameters import AvoidParameters
from pluto_bt.skills.fan import Fan
from pluto_bt.skills.lone_beams import believed_ends
from pluto_bt.skills.movers import Mask, Movers, came_closer
from pluto_bt.skills.outline import Array, Outline, Planar
from pluto_bt.skills.seen_kernels import outside_m

X, Y, MARGIN, SINCE, VX, VY = range(6)  # columns of the memory
FIELD_EDGE_RAD = math.radians(1.0)  # memory this near the edge of the field of view is kept: the edge beam may just miss it
BACKED_M = 0.2  # what is met by two neighbouring beams lies so near together
HEARD_THROUGH_M = 0.4  # an echo so much farther says that nothing is where one was before
INSIDE_M = -0.02  # what stood deeper inside the outline than this is not there any more: the robot is
APEX_M = 0.06  # an echo from nearer than the ring can tell was put so near to its transducer
FORETELL_S = 1.0  # what moves is thought to go on for so long after it was seen


class Obstacles:
    """The memory. Points leave it when the laser looks where they were, when they are old, and when they are far.

    Attributes: `first_echo`: from this number on, the points given last by `around` were heard and not seen.
    """

    def __init__(self, parameters: AvoidParameters, outline: Outline) -> None:
        self.parameters = parameters
        self._planes = outline.planes
        self.reach_m = parameters.reach_m
        self._fan = Fan()
        self.forget()

    def forget(self) -> None:
        """Nothing is known."""
        self._seen = np.zeros((0, 6))  # the newest scan
        self._kept = np.zeros((0, 6))  # what left the field of view
        self._echoes = np.zeros((0, 6))  # what the sonar heard and the laser does not say better
        self.first_echo = 0
        self._movers = Movers()
        self._last_ranges_m: Array | None = None
        self._last_pose: Planar = (0.0, 0.0, 0.0)

    def add_scan(self, scan: LaserScan, laser: Planar, z_m: float, tilt_rad: float, now_s: float) -> None:
        """Take a scan.

        Args:
            laser: where it was taken from, in the frame of dead reckoning; the yaw includes the wrist's pan.
            z_m, tilt_rad: height of the laser above the ground, and how far it looked down.
        """
        p, ranges = self.parameters, scan.ranges_m
        _, cos, sin = self._fan.beams(scan.angle_min_rad, scan.angle_step_rad, len(ranges))
        near = (ranges > 0.0) & (ranges < self.reach_m + 1.0) & (believed_ends(ranges, self._last_ranges_m, True) > 0.0)  # NaN compares False
        if tilt_rad:
            near &= z_m - ranges * cos * math.sin(tilt_rad) > 0.05  # the rest is the ground
        beams = near.nonzero()[0]
        r = ranges[beams]
        seen = np.zeros((len(r), 6))
        _place(r * cos[beams] * math.cos(tilt_rad), r * sin[beams], laser, seen)
        seen[:, SINCE] = scan.stamp_s
        moved = self._has_moved(ranges, near, len(beams), laser, scan)
        moves, seen[:, VX:] = self._movers.velocities(seen[:, :MARGIN], beams, moved, scan.stamp_s)
        seen[:, MARGIN] = p.margin_m
        seen[moves, MARGIN] = p.moving_margin_m
        self._keep_what_left_the_field(laser, scan, now_s)
        self._seen = seen
        self._last_ranges_m, self._last_pose = (ranges if tilt_rad == 0.0 else None), laser

    def add_echoes(
        self, echoes: Array, axes: Array, ranges_m: Array, half_cone_rad: float, robot: Planar, memory_s: float, now_s: float
    ) -> None:
        """Take sonar points, also none; forget what is too old, and what the sonar now hears through.

        Args:
            echoes: (n, 5) points in the robot frame.
            axes, ranges_m: (k, 3) x, y, theta of all transducers in the robot frame, and what each reads.
        """
        old = self._echoes
        if len(old):
            old = old[(old[:, SINCE] > now_s - memory_s) & ~_heard_through(old, axes, ranges_m, half_cone_rad, robot[0], robot[1], robot[2])]
        fresh = np.zeros((len(echoes), 6))
        fresh[:, MARGIN] = echoes[:, 2]
        fresh[:, SINCE] = now_s
        _place(echoes[:, 0], echoes[:, 1], robot, fresh)
        self._echoes = np.concatenate((old, fresh)) if len(fresh) else old

    def around(self, robot: Planar, with_laser: bool, with_sonar: bool, now_s: float, beyond_m: float = 0.0) -> Array:
        """(n, 5) x, y, margin, velocity x, y in the robot frame, of all that is remembered nearer than the reach and `beyond_m`."""
        reach_m = self.reach_m + beyond_m
        if len(self._kept):
            self._kept = _outside_the_robot(self._kept, self._planes, robot[0], robot[1], robot[2], self.parameters.margin_m)
        seen = np.concatenate((self._seen, self._kept)) if with_laser else self._echoes[:0]
        points = _seen_from(seen, robot[0], robot[1], robot[2], now_s, reach_m)
        self.first_echo = len(points)
        if not with_sonar or not len(self._echoes):
            return points
        return np.concatenate((points, _seen_from(self._echoes, robot[0], robot[1], robot[2], now_s, reach_m)))

    def _has_moved(self, ranges: Array, near: Mask, count: int, laser: Planar, scan: LaserScan) -> Mask:
        """Which of the near points stand where the scan before looked through: somebody walked there."""
        before = self._last_ranges_m
        if before is None or len(before) != len(ranges):
            return np.zeros(count, dtype=bool)
        return came_closer(ranges, near, before, laser, self._last_pose, scan.angle_min_rad, scan.angle_step_rad, count)

    def _keep_what_left_the_field(self, laser: Planar, scan: LaserScan, now_s: float) -> None:
        """The scan decides about all that lies in its field of view; what lies outside stays for a while."""
        old = np.concatenate((self._kept, self._seen)) if len(self._seen) else self._kept
        if not len(old):
            return
        p = self.parameters
        first_rad, last_rad = scan.angle_min_rad, scan.angle_min_rad + scan.angle_step_rad * (len(scan.ranges_m) - 1)
        field = (first_rad + FIELD_EDGE_RAD, last_rad - FIELD_EDGE_RAD)
        oldest = (p.margin_m, now_s - p.memory_s, now_s - p.walker_memory_s)
        self._kept = _outside_the_field(old, len(self._kept), laser, field, oldest, self.reach_m + 1.0)


def _place(x: Array, y: Array, frame: Planar, out: Array) -> None:
    """Write points given in `frame` into the first two columns of `out`, in the frame that `frame` is given in."""
    c, s = math.cos(frame[2]), math.sin(frame[2])
    out[:, X] = frame[0] + c * x - s * y
    out[:, Y] = frame[1] + s * x + c * y


@kernel
def _outside_the_field(
    points: Array, old_count: int, laser: Planar, field_rad: tuple[float, float], oldest: tuple[float, float, float], reach_m: float
) -> Array:
    """The points (rows of the memory) that a laser does not look at, are near enough, and young enough.

    What leaves the field of view is near the robot's flank, where many beams meet all that stands: a single one was dazzled.

    Args:
        old_count: so many had left the field of view before; the others are of one scan, beam by beam.
        field_rad: the first and the last bearing of the field of view.
        oldest: margin of what stands, s since when such counts, and s since when others do: who walks may be seen before his pace is known.
    """
    kept = np.zeros(points.shape[0], dtype=np.bool_)
    c, s = math.cos(laser[2]), math.sin(laser[2])
    for i in range(points.shape[0]):
        dx, dy = points[i, 0] - laser[0], points[i, 1] - laser[1]
        if points[i, 3] <= (oldest[1] if points[i, 2] == oldest[0] else oldest[2]) or dx * dx + dy * dy >= reach_m * reach_m:
            continue
        bearing_rad = math.atan2(c * dy - s * dx, c * dx + s * dy)
        is_outside = bearing_rad < field_rad[0] or bearing_rad > field_rad[1]
        kept[i] = is_outside and (i < old_count or _is_backed(points, i, old_count))
    return points[kept]


@inline_kernel
def _is_backed(points: Array, i: int, first: int) -> bool:
    """Whether a neighbour in the same scan, whose rows begin at `first`, met the same thing."""
    for other in (i - 1, i + 1):
        if first <= other < points.shape[0]:
            dx, dy = points[other, 0] - points[i, 0], points[other, 1] - points[i, 1]
            if dx * dx + dy * dy < BACKED_M * BACKED_M:
                return True
    return False


@kernel
def _outside_the_robot(points: Array, planes: Array, x_m: float, y_m: float, theta_rad: float, standing_margin_m: float) -> Array:
    """The points (rows of the memory) without those that stand where the robot is now: somebody who walked past its flank left them there.

    Who walks is let out first: he may be half under the outline.
    """
    kept = np.zeros(points.shape[0], dtype=np.bool_)
    c, s = math.cos(theta_rad), math.sin(theta_rad)
    for i in range(points.shape[0]):
        dx, dy = points[i, 0] - x_m, points[i, 1] - y_m
        kept[i] = points[i, 2] != standing_margin_m or outside_m(planes, c * dx + s * dy, c * dy - s * dx) > INSIDE_M
    return points[kept]


@kernel
def _heard_through(
    points: Array, axes: Array, ranges_m: Array, half_cone_rad: float, x_m: float, y_m: float, theta_rad: float
) -> NDArray[np.bool_]:
    """Which remembered points lie well inside a cone and nearer than what its transducer reads now."""
    gone = np.zeros(points.shape[0], dtype=np.bool_)
    c, s, opening = np.cos(theta_rad), np.sin(theta_rad), np.tan(0.7 * half_cone_rad)
    for k in range(axes.shape[0]):
        c_k, s_k, free_m = np.cos(axes[k, 2]), np.sin(axes[k, 2]), ranges_m[k] - HEARD_THROUGH_M
        for i in range(points.shape[0]):
            dx, dy = points[i, 0] - x_m, points[i, 1] - y_m
            away_x, away_y = c * dx + s * dy - axes[k, 0], c * dy - s * dx - axes[k, 1]
            ahead_m, aside_m = c_k * away_x + s_k * away_y, c_k * away_y - s_k * away_x
            away_m = np.sqrt(away_x * away_x + away_y * away_y)
            if away_m < free_m and (away_m < APEX_M or abs(aside_m) < ahead_m * opening):
                gone[i] = True
    return gone


@kernel
def _seen_from(points: Array, x_m: float, y_m: float, theta_rad: float, now_s: float, reach_m: float) -> Array:
    """The points nearer than `reach_m` where they are now, in the frame (x, y, theta): (n, 5) x, y, margin, velocity."""
    out = np.zeros((points.shape[0], 5))
    c, s = np.cos(theta_rad), np.sin(theta_rad)
    n = 0
    for i in range(points.shape[0]):
        gone_s = min(now_s - points[i, 3], FORETELL_S)
        vx, vy = points[i, 4], points[i, 5]
        dx, dy = points[i, 0] + vx * gone_s - x_m, points[i, 1] + vy * gone_s - y_m
        if dx * dx + dy * dy < reach_m * reach_m:
            out[n, 0], out[n, 1], out[n, 2] = c * dx + s * dy, c * dy - s * dx, points[i, 2]
            out[n, 3], out[n, 4] = c * vx + s * vy, c * vy - s * vx
            n += 1
    return out[:n]


def warm() -> None:
    """Use the kernels once that an empty place does not need."""
    movers.warm()
    here = (0.0, 0.0, 0.0)
    _outside_the_field(np.zeros((1, 6)), 0, here, (0.0, 0.0), here, 1.0)
    _outside_the_robot(np.zeros((1, 6)), np.zeros((1, 3)), *here, 0.0)
    _heard_through(np.zeros((1, 6)), np.zeros((1, 3)), np.zeros(1), 0.1, *here)
