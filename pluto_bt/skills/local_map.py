"""What the robot has seen around it: a grid in the frame of dead reckoning that goes along with the robot and forgets.

A level scan says where something stands and where it is free; a scan that looks down also says where the ground is not: holes, kerbs, low
things that a level scan passes over. Both are remembered, the second for `ground_memory_s`, for no level scan can take it back.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pluto_bt.blackboard.messages import LaserScan, read_only
from pluto_bt.skills import map_kernels
from pluto_bt.skills.fan import Fan
from pluto_bt.skills.grid_shift import shift
from pluto_bt.skills.local_grid import CELLS, NEVER_S, LocalGrid
from pluto_bt.skills.map_kernels import MOST_NUMBER, Bytes, Floats, changes, clearances, mark_ground, mark_level
from pluto_bt.skills.motion_parameters import MotionParameters
from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.walked_ground import BODY_M, Indices
from pluto_bt.skills.window import Cell, Window

CELLS_OF_A_PATH = 6.0  # in half the width of a path
LEVEL_RAD = math.radians(0.5)
HERE_M = 1.0  # so near to where the robot has been nothing needs a visit, though its laser has not looked there


class _Shut(NamedTuple):
    """A disc in which the robot could not go on."""

    x_m: float
    y_m: float
    radius_m: float
    stamp_s: float


class LocalMap(LocalGrid):
    """The grid with what enters it and leaves it. `clearance` is kept up to date by `refresh`."""

    def __init__(self, parameters: MotionParameters, middle: Planar = (0.0, 0.0, 0.0), fine: LocalMap | None = None) -> None:
        """`fine`: the same things on smaller cells, refreshed before this one: a door is as wide there as it is, give or take a cell of that."""
        self.parameters, self._fine = parameters, fine
        cell_m = parameters.path_half_width_m / CELLS_OF_A_PATH
        super().__init__(cell_m, parameters.wide_half_width_m / cell_m)
        self.look_m = min(parameters.look_m, 0.35 * CELLS * cell_m)
        n = math.ceil(HERE_M / self.cell_m)
        self._here: Bytes = (np.hypot(*np.mgrid[-n : n + 1, -n : n + 1]) <= HERE_M / self.cell_m).astype(np.int8)
        self._fan = Fan()
        self.forget(middle)

    def forget(self, middle: Planar) -> None:
        """Nothing is known; the middle of the grid is here."""
        self.blank()
        self.lay(middle)
        self._visited: Cell | None = None  # the robot is here, and that is marked
        self._scans = 0
        self._shut: list[_Shut] = []
        self.refreshed_s = -math.inf  # when `clearance` was brought up to date; long ago if that is due at once
        self._window: Window | None = None  # where something changed since then
        self._newest_low_s = NEVER_S  # when something was last found to lie low; that is forgotten by itself wherever it is

    def blank(self) -> None:
        """Nothing is known, neither in the cells nor in what `refresh` makes `clearance` of."""
        super().blank()
        self._blunt: Floats = self.clearance if self._fine is None else self.clearance.copy()  # as these cells alone have it
        self._renewed: Window | None = None  # where that, or what a grid on larger cells makes of it, is newer than `clearance`

    @property
    def doubt_m(self) -> float:
        """How much narrower than it is a narrow place may show: two halves of a cell of the fine grid. Without one nobody relies on narrow places."""
        return 0.0 if self._fine is None else self._fine.cell_m

    def add(self, scan: LaserScan, laser: Planar, height_m: float, tilt_rad: float, again_s: float = 0.0) -> None:
        """Take a scan.

        Args:
            laser: where it was taken from, in the frame of dead reckoning; the yaw includes the wrist's pan.
            height_m, tilt_rad: of the laser above the ground, and how far it looked down.
            again_s: what lies low counts when it has been seen in one place for so long.
        """
        self._follow(laser)
        angles, _, _ = self._fan.beams(scan.angle_min_rad, scan.angle_step_rad, len(scan.ranges_m))
        x, y = self.place(laser[0], laser[1])
        cell = self.cell_m
        if abs(tilt_rad) < LEVEL_RAD:
            self._scans = self._scans % MOST_NUMBER + 1
            if self._scans == 1:
                self._touched[:] = 0  # the numbers of the round before come again
            p = self.parameters
            touched = mark_level(self.evidence, self.covered, self._touched, self._scans, x, y, angles + laser[2], scan.ranges_m / cell,
                                 self.look_m / cell, p.coverage_m / cell, p.join_m / cell)  # fmt: skip
            self._changed(Window.around(x, y, self.look_m / cell) if self.has_low else Window(*touched))
        elif tilt_rad > 0.0:
            reach_m = self.parameters.ground_look_m
            found = mark_ground(self.low_s, self._first_s, self.evidence, x, y, laser[2], angles, scan.ranges_m, cell, tilt_rad, height_m,
                                reach_m, self.parameters.ground_step_m, scan.stamp_s, again_s)  # fmt: skip
            if found:
                self._newest_low_s = max(self._newest_low_s, scan.stamp_s)
            self._changed(Window.around(x, y, reach_m / cell))

    def uncover(self) -> None:
        """Nothing is covered any more."""
        self.covered[:] = 0
        self._visited = None

    def visit(self, x_m: float, y_m: float) -> None:
        """The robot is here."""
        if (here := self.cell(x_m, y_m)) == self._visited:
            return
        self._visited, (i, j) = here, here
        n = self._here.shape[0] // 2
        if n <= i < CELLS - n and n <= j < CELLS - n:
            self.covered[i - n : i + n + 1, j - n : j + n + 1] |= self._here

    def warm(self) -> None:
        """Take a level scan and one that looks down, and forget both."""
        scan = LaserScan(0.0, -0.1, 0.1, read_only((1.0, 1.0, 1.0)), 3)
        for tilt_rad in (0.0, 0.2):
            self.add(scan, (0.0, 0.0, 0.0), 0.5, tilt_rad)
        self.refresh(0.0)
        self.clearances_m(np.zeros((1, 2)))
        self.clearances_between_m((0.0, 0.0), (1.0, 0.0))
        self.is_seen_free(np.zeros((1, 2)))
        self.forget((0.0, 0.0, 0.0))

    def shut(self, x_m: float, y_m: float, radius_m: float, now_s: float) -> None:
        """Something is here that no scan shows: the robot could not go on. Remembered as what lies low is."""
        self.low_s[self.disc(x_m, y_m, radius_m)] = self._newest_low_s = now_s
        self._shut.append(_Shut(x_m, y_m, radius_m, now_s))
        self.changed_around(x_m, y_m, radius_m)

    def reopen(self, now_s: float) -> bool:
        """Forget what was shut, but for what has been seen to lie low there since. False if nothing was shut that is still remembered."""
        shut, self._shut = self._shut, []
        was_shut = False
        for place in shut:
            cells = self._shut_cells(place)
            was_shut |= len(cells[0]) > 0 and place.stamp_s > self._oldest_s(now_s)
            self.low_s[cells] = NEVER_S
            self.changed_around(place.x_m, place.y_m, place.radius_m)
        return was_shut

    def _shut_cells(self, place: _Shut) -> tuple[Indices, Indices]:
        """The cells that nothing but having been shut keeps shut."""
        i, j = self.disc(place.x_m, place.y_m, place.radius_m)
        is_same = self.low_s[i, j] == np.float32(place.stamp_s)
        return i[is_same], j[is_same]

    def give_up(self, x_m: float, y_m: float, radius_m: float) -> None:
        """What is here cannot be explored any better: it counts as covered."""
        self.covered[self.disc(x_m, y_m, radius_m)] = 1

    def erase(self, middle: tuple[float, float], side_m: float, *, inside: bool) -> None:
        """Forget what was seen in a square round a point, or outside of it."""
        (i, j), half = self.place(*middle), 0.5 * side_m / self.cell_m
        low_i, low_j = (max(0, math.floor(at - half)) for at in (i, j))
        square = np.s_[low_i : max(0, math.ceil(i + half)), low_j : max(0, math.ceil(j + half))]
        for grid, blank in ((self.evidence, 0), (self.low_s, NEVER_S), (self._first_s, NEVER_S)):
            kept = grid[square].copy()
            if inside:
                grid[square] = blank
            else:
                grid[:] = blank
                grid[square] = kept
        self._shut = [place for place in self._shut if len(self._shut_cells(place)[0])]
        self.refreshed_s = -math.inf
        self._changed(Window.around(i, j, side_m / self.cell_m if inside else CELLS))

    def refresh(self, now_s: float) -> None:
        """Bring `clearance` up to date where something changed."""
        self.refreshed_s = now_s
        self._reckon(now_s)
        if self._fine is not None:
            self._sharpen(self._fine)

    def _sharpen(self, fine: LocalMap) -> None:
        """Take over how wide a narrow place is on smaller cells, where those changed or ours did."""
        ratio = self.cell_m / fine.cell_m
        i, j = fine.place(self.i0 * self.cell_m, self.j0 * self.cell_m)  # of our first corner
        window, self._renewed, theirs, fine._renewed = self._renewed, None, fine._renewed, None
        if theirs is not None:
            window = theirs.seen_from(i, j, ratio).joined(window)
        if window is not None:
            at = (ratio, i, j, CELLS_OF_A_PATH, *window.grown(0, CELLS))
            map_kernels.sharpen(self._blunt, fine.clearance, fine.evidence, *at, self.clearance)

    def _reckon(self, now_s: float) -> None:
        if self._window is None:
            return
        keep, oldest_s = math.ceil(self.far_cells), self._oldest_s(now_s)
        window, self._window = self._window.grown(2 * keep if self.has_low else 0, CELLS), None
        if self.has_low and self._newest_low_s <= oldest_s:
            self._newest_low_s, window = NEVER_S, Window(0, CELLS, 0, CELLS)  # all of it is forgotten, wherever it lay
        changed = Window(*changes(self.evidence, self.low_s, oldest_s, self._stands, *window))
        if changed.i0 < changed.i1:  # mostly a few cells, or none
            clearances(self.evidence, self.low_s, oldest_s, *changed.grown(2 * keep, CELLS), self._blunt, keep, self.far_cells)
            self._renewed = changed.grown(keep, CELLS).joined(self._renewed)

    def without_walkers(self, places: Array, now_s: float) -> tuple[Bytes, Floats]:
        """Evidence and clearances as if nothing stood at and beside `places` (n, 2), where somebody walked."""
        at = self.beside(places, BODY_M)
        evidence, low_s, clearance = self.evidence.copy(), self.low_s.copy(), np.full_like(self.clearance, self.far_cells)
        evidence[at], low_s[at] = np.minimum(evidence[at], 0), NEVER_S
        clearances(evidence, low_s, self._oldest_s(now_s), 0, CELLS, 0, CELLS, clearance, math.ceil(self.far_cells), self.far_cells)
        return evidence, clearance

    def forget_feet(self, places: Array) -> None:
        """What a scan that looks down found at `places` (n, 2), where somebody walks, does not lie there."""
        i, j = at = self.beside(places, self.cell_m)
        self.low_s[at] = self._first_s[at] = NEVER_S
        if len(i):
            self._changed(Window(int(i.min()), int(i.max()) + 1, int(j.min()), int(j.max()) + 1))

    @property
    def has_low(self) -> bool:
        """True while something is remembered to lie low."""
        return self._newest_low_s > NEVER_S

    def _oldest_s(self, now_s: float) -> float:
        """What was seen to lie low before is not known any more."""
        return max(0.0, now_s - self.parameters.ground_memory_s) - 1e-3

    def changed_around(self, x_m: float, y_m: float, reach_m: float) -> None:
        """Something was written into the cells up to so far from a point."""
        self._changed(Window.around(*self.place(x_m, y_m), reach_m / self.cell_m))

    def _changed(self, window: Window) -> None:
        self._window = window.joined(self._window)

    def _follow(self, robot: Planar) -> None:
        shift_i, shift_j = self.go_along(robot)
        if not (shift_i or shift_j):
            return
        if self._blunt is not self.clearance:
            shift(self._blunt, shift_i, shift_j, self.far_cells)
        self._window = None if self._window is None else self._window.moved(shift_i, shift_j)
        self._renewed = None if self._renewed is None else self._renewed.moved(shift_i, shift_j)
        self._visited = None
