"""Who walks there: pieces of a scan that stand where the scan before saw free space, and how fast they go."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills.outline import Array, Planar

Mask = NDArray[np.bool_]
Beams = NDArray[np.intp]
CAME_CLOSER_M = 0.12  # a beam so much shorter than the scan before allows ends on something that moved there
NEEDLE_BEAMS = 0.7  # what is narrower in the scan before may have stood between two of its beams, …
THIN_M, DEEP_M = 0.08, 0.3  # … or have been seen on edge: so thin, as far as noise lets tell, and deeper than a person is
BESIDE_M, BESIDE_BEAMS = 0.05, 2  # where a point lay is known so well, or to so many beams: what passed it nearer by does not say that it was free
GRAZING_M = 1.5  # neighbouring beams that differ by less may graze one wall, which goes on beyond its end by as much till the next beam
APART_M = 0.3  # neighbouring beams that differ more end on different things
WIDEST_M = 1.2  # what is wider is no person and no vehicle of our size, and its visible part shifts as we pass
PERSON_M = 0.7  # what is wider may be somebody beside a wall …
RUN_BEAMS = 5  # … if so many beams side by side end in former free space
MOVED_BEAMS = 2  # so many beams must end in former free space
LEFT_SHARE = 0.8  # of the beams of somebody who walked away are free where he stood; of what only shows another side, fewer
STEP_M = 0.5  # nothing that is tracked goes farther between two scans
FASTEST_MPS = 2.0
FOLLOW_S, FOLLOW_M = 1.0, 0.4  # who was seen walking is followed for so long where he is expected, also where only a part of him is in view


class Movers:
    """Follows pieces from scan to scan. Velocities are in the frame of the points."""

    def __init__(self) -> None:
        self._last: tuple[Array, Beams, Mask] = (np.zeros((0, 2)), np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.bool_))
        self._last_pieces: _Pieces | None = None  # of the last scan, once somebody needed them
        self._stamp_s = -np.inf
        self._walkers = np.zeros((0, 5))  # x, y at the last scan, velocity x, y, stamp of the scan that saw him walk

    @property
    def walkers(self) -> Array:
        """(n, 5) x m, y m, velocity x, y m/s, and when he was last seen walking, s: who is in the newest scan."""
        return self._walkers

    def velocities(self, points: Array, beams: Beams, moved: Mask, stamp_s: float) -> tuple[Mask, Array]:
        """Which points belong to something that moves, and its velocity (0 where it was not seen before).

        Args:
            points: (n, 2) near points of a scan in the order of the beams.
            beams: (n,) the number of each point's beam.
            moved: (n,) whether the beam ends in what was free space.
        """
        last, self._last = self._last, (points, beams, moved)
        last_pieces, self._last_pieces = self._last_pieces, None
        dt_s, self._stamp_s = stamp_s - self._stamp_s, stamp_s
        expected = self._walkers[self._walkers[:, 4] > stamp_s - FOLLOW_S]
        expected[:, :2] += expected[:, 2:4] * min(dt_s, 1.0)
        self._walkers = np.zeros((0, 5))
        if not len(points) or (np.count_nonzero(moved) < MOVED_BEAMS and not len(expected)):
            return np.zeros(len(points), dtype=bool), np.zeros((len(points), 2))
        starts, sizes, centres, is_narrow = self._last_pieces = _pieces(points, beams, moved)
        walks = (np.add.reduceat(moved.astype(np.intp), starts) >= MOVED_BEAMS) & is_narrow
        before = np.zeros((0, 2))
        if len(last[0]) and 0.0 < dt_s < 1.0:
            pieces = last_pieces or _pieces(*last)
            before = pieces.centres[pieces.is_narrow]
        rows = np.zeros((len(starts), 5))  # as self._walkers
        rows[:, :2], rows[:, 4] = centres, stamp_s
        for i in np.flatnonzero(is_narrow).tolist():
            if walks[i]:
                rows[i, 2:4] = _velocity(centres[i], before, dt_s)
            elif (k := _nearest(centres[i], expected, FOLLOW_M)) >= 0:
                walks[i], rows[i, 2:] = True, expected[k, 2:]
        self._walkers = rows[walks]
        piece = np.repeat(np.arange(len(starts)), sizes)
        return walks[piece], rows[piece, 2:4]


def gone_away(points: Array, beams: Beams, before: Array, beams_before: Beams, left: Mask, dt_s: float) -> Array:
    """(n, 4) x m, y m, velocity x, y m/s: who walks away. He stands where nobody looked through before, for he hid that ground himself.

    Args:
        points, beams: as of `Movers.velocities`. before, beams_before: the same of a scan `dt_s` older.
        left: (m,) whether a point of `before` lies in what is free space now.
    """
    old = _pieces(before, beams_before, left)
    is_gone = (np.add.reduceat(left.astype(np.intp), old.starts) >= np.maximum(MOVED_BEAMS, LEFT_SHARE * old.sizes)) & old.is_narrow
    if not is_gone.any() or not len(points):
        return np.zeros((0, 4))
    remains = before[~np.repeat(is_gone, old.sizes)]
    new = _pieces(points, beams, np.zeros(len(points), dtype=np.bool_))
    now = np.array([at for at in new.centres[new.is_narrow] if _nearest(at, remains, APART_M) < 0]).reshape(-1, 2)  # what stood there is nobody
    found = [(at, now[k]) for at in old.centres[is_gone] if (k := _nearest(at, now, FASTEST_MPS * dt_s)) >= 0]
    return np.array([(*to, *((to - at) / dt_s)) for at, to in found]).reshape(-1, 4)


class _Pieces(NamedTuple):
    """The pieces of a scan that hang together: first point, number of points and centre of each, and whether it may be a person or a vehicle."""

    starts: Beams
    sizes: Beams
    centres: Array
    is_narrow: Mask


def _pieces(points: Array, beams: Beams, moved: Mask) -> _Pieces:
    """The pieces of the points of a scan, as `velocities` takes them; at least one."""
    x_m, y_m = points.T.copy()  # contiguous, however many: one signature to compile
    starts, is_narrow = apart(x_m, y_m, beams, moved)
    sizes = np.diff(starts, append=len(points))
    return _Pieces(starts, sizes, np.add.reduceat(points, starts, axis=0) / sizes[:, None], is_narrow)


@kernel
def apart(x_m: Array, y_m: Array, beams: Beams, moved: Mask) -> tuple[Beams, Mask]:
    """Where the pieces of a scan begin, and which of them may be a person or a vehicle: (k,), (k,).

    Somebody so near to a wall that he hangs together with it is a piece of his own: the beams that end in former free space. The rest of the
    wall is nobody.

    Args:
        x_m, y_m, beams, moved: (n,) as `Movers.velocities` takes them, n > 0.
    """
    n = x_m.shape[0]
    begins, is_rest = np.zeros(n + 1, dtype=np.bool_), np.zeros(n, dtype=np.bool_)
    begins[0] = begins[n] = True
    for i in range(1, n):
        begins[i] = math.hypot(x_m[i] - x_m[i - 1], y_m[i] - y_m[i - 1]) > APART_M or beams[i] - beams[i - 1] > 3
    first = 0
    for end in range(1, n + 1):
        if begins[end]:
            if math.hypot(x_m[end - 1] - x_m[first], y_m[end - 1] - y_m[first]) > PERSON_M:
                cut_out(moved, first, end, begins, is_rest)
            first = end
    starts, is_narrow = np.zeros(n, dtype=np.intp), np.zeros(n, dtype=np.bool_)
    count = first = 0
    for end in range(1, n + 1):
        if begins[end]:
            width_m = math.hypot(x_m[end - 1] - x_m[first], y_m[end - 1] - y_m[first])
            starts[count], is_narrow[count] = first, width_m < WIDEST_M and not is_rest[first]
            count, first = count + 1, end
    return starts[:count], is_narrow[:count]


@inline_kernel
def cut_out(moved: Mask, first: int, end: int, begins: Mask, is_rest: Mask) -> None:
    """Where the piece [first, end) has a run of beams that ended in former free space, let it begin and end there; mark the rest of the piece."""
    run, is_cut = first, False
    for i in range(first, end):
        if not moved[i]:
            run = i + 1
        elif i + 1 - run >= RUN_BEAMS and (i + 1 == moved.shape[0] or not moved[i + 1]) and (run > first or first == 0 or not moved[first - 1]):
            begins[run] = begins[i + 1] = is_cut = True
    for i in range(first, end):
        is_rest[i] = is_cut and not moved[i]


def _nearest(place: Array, others: Array, within_m: float) -> int:
    """Which of the others (x, y, …) is nearest, -1 if none is so near."""
    if not len(others):
        return -1
    lengths = np.hypot(others[:, 0] - place[0], others[:, 1] - place[1])
    nearest = int(np.argmin(lengths))
    return nearest if lengths[nearest] <= within_m else -1


def _velocity(centre: Array, before: Array, dt_s: float) -> Array:
    """From the nearest piece of the scan before; 0 if none was near."""
    nearest = _nearest(centre, before, STEP_M)
    if nearest < 0:
        return np.zeros(2)
    step = centre - before[nearest]
    return np.asarray(step / max(dt_s, float(np.hypot(step[0], step[1])) / FASTEST_MPS))


@kernel
def came_closer(
    ranges: Array, near: Mask, before: Array, laser: Planar, last: Planar, angle_min_rad: float, angle_step_rad: float, count: int
) -> Mask:
    """For each of the `count` near beams, whether its end lies in what the scan before saw as free space, in all beams that passed close by.

    So the back of a round thing that comes into view as we pass by did not come. What is grazed is not seen up to its end, which may lie
    anywhere before the next beam: so far it is thought to go on. And what lay between two beams of the scan before, as a thin wall in line with
    the laser, may have stood there unseen.

    Args:
        ranges, before: (n,) this scan and the one before, of equal angles; NaN in `before` says nothing.
        laser, last: where they were taken from, in one frame.
    """
    moved, beam_last, range_last = np.zeros(count, dtype=np.bool_), np.zeros(count), np.zeros(count)
    c_now, s_now, c_last, s_last = np.cos(laser[2]), np.sin(laser[2]), np.cos(last[2]), np.sin(last[2])
    k = -1
    for i in range(ranges.shape[0]):
        if not near[i]:
            continue
        k += 1
        angle = angle_min_rad + angle_step_rad * i
        x, y = ranges[i] * np.cos(angle), ranges[i] * np.sin(angle)
        dx, dy = laser[0] + c_now * x - s_now * y - last[0], laser[1] + s_now * x + c_now * y - last[1]
        x_last, y_last = c_last * dx + s_last * dy, c_last * dy - s_last * dx
        beam_last[k] = (np.arctan2(y_last, x_last) - angle_min_rad) / angle_step_rad
        range_last[k] = np.sqrt(x_last * x_last + y_last * y_last)
        j, seen_m = int(np.round(beam_last[k])), range_last[k] + CAME_CLOSER_M
        if j < BESIDE_BEAMS or j >= before.shape[0] - BESIDE_BEAMS or not before[j] > seen_m:
            continue
        beside = max(BESIDE_BEAMS, int(np.ceil(BESIDE_M / max(range_last[k], 0.1) / angle_step_rad)))
        free_m = before[max(j - beside, 0) : j + beside + 1].min()
        free_m = min(free_m, beyond_m(before[j], before[j + 1]), beyond_m(before[j], before[j - 1]))
        free_m = min(free_m, beyond_m(before[j + 1], before[j + 2]), beyond_m(before[j - 1], before[j - 2]))
        moved[k] = free_m > seen_m
    leave_out_needles(moved, beam_last, range_last, angle_step_rad)
    return moved


@inline_kernel
def leave_out_needles(moved: Mask, beam_last: Array, range_last: Array, angle_step_rad: float) -> None:
    """Take back those side by side that all lay between two beams of the scan before, or on a face that it saw on edge.

    Args:
        beam_last, range_last: (k,) their numbers there, and how far they lay from the laser, m.
    """
    first = 0
    for k in range(moved.shape[0]):
        if not moved[k]:
            first = k + 1
        elif k == moved.shape[0] - 1 or not moved[k + 1]:
            beams, away_m = beam_last[first : k + 1], range_last[first : k + 1]
            width = beams.max() - beams.min()
            is_thin = width * angle_step_rad * away_m.mean() < THIN_M and away_m.max() - away_m.min() > DEEP_M
            if width < NEEDLE_BEAMS or is_thin:
                moved[first : k + 1] = False


@inline_kernel
def beyond_m(end_m: float, next_m: float) -> float:
    """Where the beam beyond the last one on a grazed wall, `end_m`, would meet it; the one before the last ended at `next_m`."""
    return 2.0 * end_m - next_m if next_m - end_m < GRAZING_M else end_m


def warm() -> None:
    """Use the kernel once that only a place where somebody walks needs."""
    _pieces(np.zeros((1, 2)), np.zeros(1, dtype=np.intp), np.zeros(1, dtype=np.bool_))
