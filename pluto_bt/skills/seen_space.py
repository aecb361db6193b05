"""The stop filter's own memory of space: which cells round the robot were seen free, in which something stands, which nobody ever saw.

A shell round the kernels of `seen_kernels`; it rolls with the robot. Frame: dead reckoning. It shares nothing with avoidance's memory.
"""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.blackboard.messages import LaserScan
from pluto_bt.maps.platform import Sonar
from pluto_bt.skills.fan import Fan
from pluto_bt.skills.grid_shift import shift
from pluto_bt.skills.lone_beams import believed_ends
from pluto_bt.skills.outline import Array, Outline, Planar
from pluto_bt.skills.seen_kernels import CELL_M, LOW, NEVER, TOUCHING_M, Counts, hear_cones, place_cones, put_all, see_beams, stand

ROLL_CELLS = 12  # so far the robot leaves the middle before the cells are moved
MOST_POINTS = 4000
LEVEL_RAD = math.radians(1.5)  # a scan tilted by less counts as level
GROUND_M = 0.05  # what a tilted beam meets lower than this is the ground
BEHIND_M = 0.5  # echoes are used so much less far than beams, so that the laser has seen what they come from
ECHO = 3  # column of the cones
DEAF_M = 0.02
ROUNDS = 3  # so many rounds of the sonar must agree that a cone is free: echoes get lost

NOWHERE: Array = np.zeros((0, 2))


class SeenSpace:
    """Cells as far as `reach_m` to each side; `fleeting_s` is that of `hear_cones`."""

    def __init__(self, outline: Outline, reach_m: float, hear_m: float, fleeting_s: float = 0.0) -> None:
        n = 2 * (math.ceil(reach_m / CELL_M) + ROLL_CELLS) + 1
        self._outline, self._hear_m, self._reach_m, self._fleeting_s = outline, hear_m, reach_m, fleeting_s
        self.seen: Array = np.full((n, n), NEVER)
        self._heard: Array = np.full((2, n, n), NEVER)
        self.stamps: Array = np.full((2, n, n), NEVER)
        self.spots: Array = np.full((2, n, n, 2), NEVER)
        self.points: Array = np.zeros((MOST_POINTS, 4))
        self.count = 0
        self.believed: Array = np.zeros(0)
        self._fan = Fan()
        self._corner = (0, 0)  # of the lower left cell, in cells
        self._middle: tuple[int, int] | None = None
        self._last_ranges_m: Array | None = None
        self._rounds = 0  # of the sonar since it was away; the last of them:
        self._rounds_m: Array = np.zeros((ROUNDS, 0))
        self._cones: Array = np.zeros((0, 6))
        self._touching: Array = NOWHERE  # robot frame
        self._see, self._stand = see_beams.compiled(), stand.compiled()
        self._place, self._hear = place_cones.compiled(), hear_cones.compiled()

    @property
    def corner_m(self) -> tuple[float, float]:
        """The lower left corner in the frame of dead reckoning."""
        return self._corner[0] * CELL_M, self._corner[1] * CELL_M

    def forget(self) -> None:
        """Nothing was ever seen: the robot stands in another place."""
        for cells in (self.seen, self._heard, self.stamps, self.spots):
            cells.fill(NEVER)
        self._last_ranges_m = None
        self.drop_echoes()

    def add_scan(self, scan: LaserScan, laser: Planar, z_m: float, tilt_rad: float, people: Array) -> bool:
        """Take a scan from where the laser was, yaw with the wrist's pan. One that looks down finds low things, and proves nothing free.

        Args:
            people: (n, 3) discs x m, y m, radius m in which somebody walks: what is found there may go by itself.
        Returns: True if it was level; then `believed` tells which of its beams count.
        """
        ranges, first, step = scan.ranges_m, scan.angle_min_rad, scan.angle_step_rad
        if abs(tilt_rad) > LEVEL_RAD:
            self._last_ranges_m = None
            self._add_tilted(scan, laser, z_m, tilt_rad, people)
            return False
        self.believed = believed = believed_ends(ranges, self._last_ranges_m, False)
        self._last_ranges_m = ranges
        self._see(
            self.seen, self.stamps, self.spots, *self.corner_m, laser[0], laser[1], laser[2] + first, step, ranges, believed,
            scan.stamp_s, self._reach_m,
        )  # fmt: skip
        return True

    def _add_tilted(self, scan: LaserScan, laser: Planar, z_m: float, tilt_rad: float, people: Array) -> None:
        _, cos, sin = self._fan.beams(scan.angle_min_rad, scan.angle_step_rad, len(scan.ranges_m))
        ahead = scan.ranges_m * cos
        usable = (scan.ranges_m > 0.0) & (scan.ranges_m < self._reach_m) & (z_m - ahead * math.sin(tilt_rad) > GROUND_M)
        usable &= believed_ends(scan.ranges_m, None, False) > 0.0  # no level scan could take a dazzled beam back
        c, s = math.cos(laser[2]), math.sin(laser[2])
        x, y = ahead[usable] * math.cos(tilt_rad), (scan.ranges_m * sin)[usable]
        points = np.column_stack((laser[0] + c * x - s * y, laser[1] + s * x + c * y))
        is_body = (np.hypot(points[:, None, 0] - people[:, 0], points[:, None, 1] - people[:, 1]) < people[:, 2]).any(axis=1)
        stamps_s = scan.stamp_s - np.where(is_body, self._fleeting_s, 0.0)
        put_all(self.stamps, self.spots, LOW, *self.corner_m, points, laser[0], laser[1], stamps_s)

    def add_echoes(self, axes: Array, leaves_m: Array, ranges_m: Array, sonar: Sonar, robot: Planar, stamp_s: float) -> Counts:
        """Take a round of the ring.

        Args:
            axes: (k, 3) transducers in the robot frame. leaves_m: (k,) how far each one's axis runs inside the outline.
        Returns: (k,) UNSEEN, UNKNOWN, CAME, SUDDEN, HIDDEN or 0: what is new about each echo; see `hear_cones`.
        """
        if len(ranges_m) != self._rounds_m.shape[1]:
            self._rounds_m, self._cones = np.zeros((ROUNDS, len(ranges_m))), np.zeros((len(ranges_m), 6))
        self._rounds_m[:-1] = self._rounds_m[1:]
        self._rounds_m[-1] = ranges_m * (ranges_m > sonar.min_range_m + DEAF_M)  # nearer it is deaf: it may be anywhere, and nothing is proved
        self._rounds += 1
        cones = self._cones
        self._place(axes, leaves_m, self._rounds_m, self._rounds, *robot, cones)
        most_m = min(self._hear_m, self._reach_m - BEHIND_M, sonar.max_range_m - 0.01)
        half_cone_rad = math.radians(sonar.cone_deg) / 2.0
        news = np.zeros(len(cones), dtype=np.intp)
        self._touching = NOWHERE
        space = (self.seen, self._heard, self.stamps, self.spots)
        if self._hear(*space, *self.corner_m, cones, half_cone_rad, stamp_s, most_m, self._fleeting_s, news):
            touching = cones[:, ECHO] == TOUCHING_M
            x, y, theta = axes[touching].T
            self._touching = np.column_stack((x + leaves_m[touching] * np.cos(theta), y + leaves_m[touching] * np.sin(theta)))
        return news

    def drop_echoes(self) -> None:
        """The sonar was away: what it said before does not confirm what it says next."""
        self._rounds, self._touching = 0, NOWHERE

    def stand(self, robot: Planar, grown_m: float, now_s: float, obstacles_since_s: float, window_m: float) -> None:
        """The robot stands here: its place is free. Gather the points within `window_m` into `points`."""
        outline = self._outline
        self.count = self._stand(
            self.seen, self.stamps, self.spots, *self.corner_m, *robot, outline.planes, outline.reach_m, grown_m, now_s, obstacles_since_s,
            max(window_m, outline.reach_m + grown_m + CELL_M), self.points[: MOST_POINTS - len(self._touching)],
        )  # fmt: skip
        for x, y in self._touching.tolist():
            self.points[self.count] = x, y, LOW, 0.0
            self.count += 1

    def roll(self, robot: Planar) -> None:
        """Keep the robot in the middle; what leaves the cells is forgotten."""
        at = (math.floor(robot[0] / CELL_M), math.floor(robot[1] / CELL_M))
        if self._middle is not None and max(abs(at[0] - self._middle[0]), abs(at[1] - self._middle[1])) <= ROLL_CELLS:
            return
        half = len(self.seen) // 2
        corner = (at[0] - half, at[1] - half)
        moved = (corner[1] - self._corner[1], corner[0] - self._corner[0])  # rows, columns
        self._corner, self._middle = corner, at
        for cells in (self.seen, *self._heard, *self.stamps, *self.spots):
            shift(cells, *moved, NEVER)

    @property
    def is_empty(self) -> bool:
        """True while nothing stands in the cells."""
        return not bool((self.stamps > NEVER).any())


def warm() -> None:
    """Use the kernel once that only a scan which looks down needs."""
    put_all(np.full((2, 1, 1), NEVER), np.zeros((2, 1, 1, 2)), LOW, 0.0, 0.0, np.zeros((1, 2)), 0.0, 0.0, np.zeros(1))
