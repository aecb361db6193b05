"""The hot loops of the local map. Grids are (n, n), first index x, second index y; cell (i, j) covers [i, i + 1) x [j, j + 1) cells.

`evidence` > 0 = something stands there, < 0 = seen free, 0 = not known. `touched` holds the number of the scan that last changed a cell, so
that one scan changes each cell once and a hit outweighs the many beams that graze past it; one byte a cell, for memory is what takes the time.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.kernel import inline_kernel, kernel

Array = NDArray[np.float64]
Bytes = NDArray[np.int8]
Counts = NDArray[np.int32]
Floats = NDArray[np.float32]

HIT, MISS = 3, 2  # a wall outlives the drop-outs of single beams, somebody who walked on is gone after a second
MOST, LEAST = 6, -4
MOST_NUMBER = 127  # of a scan, then they begin anew at 1
LEVEL, STANDS, HOLE = 1, 2, 3  # what a beam that looks down may find
FORGOTTEN_S = 6.0  # what was seen to lie low before that is not known any more
TALL_M = 0.35  # what is hit so high up is a thing that level scans see, or will be hit lower when it is farther away
LOW_X, HIGH_X, LOW_Y, HIGH_Y = range(4)  # of a box of cells
SAMPLE = 0.7  # cells between two samples of a beam
MOST_BLUNT = np.float32(1.0)  # cells: nothing is farther off than that from where its cell says, seen from the freest place of another cell
ACROSS, DIAGONALLY = np.float32(1.0), np.float32(1.4142)  # cells from the middle of one to that of the next


@kernel
def mark_level(
    evidence: Bytes, covered: Bytes, touched: Bytes, number: int, x: float, y: float, bearings: Array, ranges: Array, look: float, cover: float,
    join: float,
) -> tuple[int, int, int, int]:  # fmt: skip
    """Enter a level scan taken at (x, y); all lengths in cells.

    Beams that end nearer than `look` are hits, and two neighbouring hits less than `join` apart are one wall. What beams pass is free, and
    nearer than `cover` it is also covered. Ranges that are not numbers or not positive say nothing; a single beam that runs on where both
    its neighbours end has lost its echo and is believed no farther than they are.

    Returns: a window that holds all that may have changed, [i0, i1) x [j0, j1).
    """
    size, n = evidence.shape[0], ranges.shape[0]
    cos, sin, reach = np.zeros(n), np.zeros(n), np.zeros(4)
    reach[LOW_X], reach[HIGH_X], reach[LOW_Y], reach[HIGH_Y] = x, x, y, y
    for k in range(n):
        cos[k], sin[k] = math.cos(bearings[k]), math.sin(bearings[k])
    mark_ends(evidence, touched, number, x, y, cos, sin, ranges, look, join, reach)
    mark_free(evidence, covered, touched, number, x, y, cos, sin, ranges, look, cover, join, reach)
    return (
        max(0, math.floor(reach[LOW_X])), min(size, math.floor(reach[HIGH_X]) + 1),
        max(0, math.floor(reach[LOW_Y])), min(size, math.floor(reach[HIGH_Y]) + 1),
    )  # fmt: skip


@inline_kernel
def mark_ends(
    evidence: Bytes, touched: Bytes, number: int, x: float, y: float, cos: Array, sin: Array, ranges: Array, look: float, join: float, reach: Array
) -> None:
    """The first half of `mark_level`: what stands where beams end. cos, sin: (n,) of the bearings."""
    size = evidence.shape[0]
    last_x, last_y, has_last = 0.0, 0.0, False
    for k in range(ranges.shape[0]):
        r = ranges[k]
        if not (0.0 < r < look):
            has_last = False
            continue
        hit_x, hit_y = x + r * cos[k], y + r * sin[k]
        widen(reach, hit_x, hit_y)
        steps = 1
        if has_last:
            gap = math.hypot(hit_x - last_x, hit_y - last_y)
            steps = int(gap / SAMPLE) + 1 if gap < join else 1
        for s in range(1, steps + 1):
            share = 0.0 if steps == 1 else 1.0 - s / steps
            i, j = math.floor(hit_x + share * (last_x - hit_x)), math.floor(hit_y + share * (last_y - hit_y))
            if 0 <= i < size and 0 <= j < size and touched[i, j] != number:
                touched[i, j] = number
                evidence[i, j] = min(MOST, evidence[i, j] + HIT)
        last_x, last_y, has_last = hit_x, hit_y, True


@inline_kernel
def mark_free(
    evidence: Bytes, covered: Bytes, touched: Bytes, number: int, x: float, y: float, cos: Array, sin: Array, ranges: Array, look: float,
    cover: float, join: float, reach: Array,
) -> None:  # fmt: skip
    """The second half: what the beams pass, where nothing was found to stand."""
    size, n = evidence.shape[0], ranges.shape[0]
    flat_evidence, flat_covered, flat_touched = evidence.reshape(-1), covered.reshape(-1), touched.reshape(-1)
    places = np.zeros(max(0, int(look / SAMPLE)) + 1, dtype=np.int32)
    for k in range(n):
        r = ranges[k]
        if not r > 0.0:
            continue
        if 0 < k < n - 1:
            r = min(r, max(ranges[k - 1], ranges[k + 1]) + join)
        count = max(0, int((min(r, look) - 1.0) / SAMPLE))
        widen(reach, x + SAMPLE * count * cos[k], y + SAMPLE * count * sin[k])
        cells_along(places[:count], x, y, cos[k], sin[k], size)
        for m in range(count):
            place = places[m]
            if place < 0:
                break
            if m * SAMPLE < cover:
                flat_covered[place] = 1
            if flat_touched[place] != number:
                flat_touched[place] = number
                flat_evidence[place] = max(LEAST, flat_evidence[place] - MISS)


@inline_kernel
def widen(reach: Array, x: float, y: float) -> None:
    """Let a box of cells, `LOW_X` and so on, hold a place too."""
    reach[LOW_X], reach[HIGH_X] = min(reach[LOW_X], x), max(reach[HIGH_X], x)
    reach[LOW_Y], reach[HIGH_Y] = min(reach[LOW_Y], y), max(reach[HIGH_Y], y)


@inline_kernel
def cells_along(places: Counts, x: float, y: float, c: float, s: float, size: int) -> None:
    """Fill in the cells at the samples of a beam from (x, y), numbered row by row; -1 = beyond the edge. Without a branch, so it is vectorised."""
    for m in range(places.shape[0]):
        i, j = math.floor(x + m * SAMPLE * c), math.floor(y + m * SAMPLE * s)
        is_inside = (i >= 0) & (i < size) & (j >= 0) & (j < size)
        places[m] = i * size + j if is_inside else -1


@kernel
def mark_ground(
    low_s: Floats, first_s: Floats, evidence: Bytes, x: float, y: float, yaw: float, angles: Array, ranges: Array, cell: float, tilt: float,
    height: float, look: float, step: float, now_s: float, again_s: float,
) -> bool:  # fmt: skip
    """Enter what a scan tilted down by `tilt` says of the ground into `low_s`: metres, (x, y) in cells.

    Ends more than `step` above the ground are low obstacles, once they are seen again `again_s` later (`first_s` = when first); a beam that runs on
    more than `step` below the ground has found a hole, where it went through the ground; both only where the beam before says the same.
    Ground that is where it should be takes old marks away. Returns: whether anything counts as lying low now.
    """
    size = low_s.shape[0]
    sin, cos = math.sin(tilt), math.cos(tilt)
    before, found = 0, False
    for k in range(ranges.shape[0]):
        r = ranges[k]
        fall = math.cos(angles[k]) * sin
        verdict, same = 0, before
        if r > 0.0 and fall >= 0.05:
            above = height - r * fall
            verdict = LEVEL if abs(above) <= step else HOLE if above < 0.0 else STANDS if r < look and above < TALL_M else 0
        before = verdict
        if verdict == 0 or (verdict != LEVEL and verdict != same):
            continue  # one beam alone may be dazzled, or have lost its echo
        at = height / fall if verdict == HOLE else r  # of a hole, its near edge
        ahead, aside = at * math.cos(angles[k]) * cos, at * math.sin(angles[k])
        if ahead * ahead + aside * aside > look * look:
            continue
        px = x + (ahead * math.cos(yaw) - aside * math.sin(yaw)) / cell
        py = y + (ahead * math.sin(yaw) + aside * math.cos(yaw)) / cell
        i, j = math.floor(px), math.floor(py)
        if not (0 <= i < size and 0 <= j < size):
            continue
        if verdict == LEVEL:
            low_s[i, j] = first_s[i, j] = -1.0
        elif verdict == HOLE or again_s <= 0.0 or again_s <= now_s - first_s[i, j] <= FORGOTTEN_S:
            low_s[i, j], found = now_s, True
        elif evidence[i, j] <= 0 and (first_s[i, j] < 0.0 or now_s - first_s[i, j] > FORGOTTEN_S):
            first_s[i, j] = now_s
    return found


@kernel
def changes(
    evidence: Bytes, low_s: Floats, oldest_s: float, stands: Bytes, i0: int, i1: int, j0: int, j1: int
) -> tuple[int, int, int, int]:  # fmt: skip
    """Bring `stands` (1 = something stands there, or lies low) up to date in the window [i0, i1) x [j0, j1).

    Returns: the smallest window that holds all that changed, i0, i1, j0, j1; with i0 >= i1 if nothing did.
    """
    first_i, last_i, first_j, last_j = evidence.shape[0], 0, evidence.shape[1], 0
    oldest = np.float32(oldest_s)
    for i in range(i0, i1):
        if not has_changed(evidence[i, j0:j1], low_s[i, j0:j1], oldest, stands[i, j0:j1]):
            continue
        first_i, last_i = min(first_i, i), max(last_i, i + 1)
        for j in range(j0, j1):
            is_there = evidence[i, j] > 0 or low_s[i, j] > oldest
            if is_there != (stands[i, j] != 0):
                stands[i, j] = 1 if is_there else 0
                first_j, last_j = min(first_j, j), max(last_j, j + 1)
    return first_i, last_i, first_j, last_j


@inline_kernel
def has_changed(evidence: Bytes, low_s: Floats, oldest_s: np.float32, stands: Bytes) -> bool:
    """Whether one cell of a row, all of them (n,), is not as `stands` has it. Without a branch in the loop, so that it is vectorised."""
    differences = 0
    for j in range(evidence.shape[0]):
        differences |= ((evidence[j] > 0) | (low_s[j] > oldest_s)) ^ (stands[j] != 0)
    return differences != 0


@kernel
def clearances(
    evidence: Bytes, low_s: Floats, oldest_s: float, i0: int, i1: int, j0: int, j1: int, out: Floats, keep: int, most: float
) -> None:  # fmt: skip
    """Cells to the nearest thing that stands, for the window [i0, i1) x [j0, j1), less `keep` cells at its edges: a chamfer distance.

    Two sweeps carry the distance from cell to cell, 1 across and √2 diagonally; at most 8 % more than the straight one.
    """
    rows, columns = i1 - i0, j1 - j0
    near = np.full((rows + 2, columns + 2), np.float32(most))
    for a in range(1, rows + 1):
        row, stands, low = near[a, 1 : columns + 1], evidence[i0 + a - 1, j0:j1], low_s[i0 + a - 1, j0:j1]
        for b in range(columns):
            if stands[b] > 0 or low[b] > oldest_s:
                row[b] = 0.0
        spread_over(row, near[a - 1])
        for b in range(1, columns):
            row[b] = min(row[b], row[b - 1] + ACROSS)
    for a in range(rows, 0, -1):
        row = near[a, 1 : columns + 1]
        spread_over(row, near[a + 1])
        for b in range(columns - 2, -1, -1):
            row[b] = min(row[b], row[b + 1] + ACROSS)
    first_i, last_i = 0 if i0 == 0 else keep, rows if i1 == evidence.shape[0] else rows - keep
    first_j, last_j = 0 if j0 == 0 else keep, columns if j1 == evidence.shape[1] else columns - keep
    for a in range(first_i, last_i):
        for b in range(first_j, last_j):
            out[i0 + a, j0 + b] = near[a + 1, b + 1]


@kernel
def sharpen(
    blunt: Floats, fine: Floats, fine_evidence: Bytes, ratio: float, fine_i: float, fine_j: float, near: float, i0: int, i1: int, j0: int, j1: int,
    out: Floats,
) -> None:  # fmt: skip
    """Clearances of the window [i0, i1) x [j0, j1) as the freest of the smaller cells in each cell has them; as `blunt` has them where nothing
    is `near` or no smaller cell was seen free.

    Args:
        blunt, out: clearances, cells. fine, fine_evidence: of a grid with cells `ratio` times smaller, whose clearances count in those.
        fine_i, fine_j: where the first corner lies in that grid.
    """
    rows, columns = fine.shape
    for i in range(i0, i1):
        low_i, high_i = math.ceil(fine_i + i * ratio - 0.5), math.ceil(fine_i + (i + 1) * ratio - 0.5)
        for j in range(j0, j1):
            free = blunt[i, j]
            if 0.5 < free < near:
                low_j, high_j = math.ceil(fine_j + j * ratio - 0.5), math.ceil(fine_j + (j + 1) * ratio - 0.5)
                best = np.float32(-1.0)
                for a in range(max(0, low_i), min(rows, high_i)):
                    for b in range(max(0, low_j), min(columns, high_j)):
                        if fine_evidence[a, b] < 0 and fine[a, b] > best:
                            best = fine[a, b]
                if best >= 0.0:
                    free = min(np.float32(best / ratio), free + MOST_BLUNT)
            out[i, j] = free


@inline_kernel
def spread_over(row: Floats, beside: Floats) -> None:
    """Carry the distances of the row `beside`, which has a cell more at both ends, over to a row. Not along it: so the loop is vectorised."""
    before, at, after = beside[:-2], beside[1:-1], beside[2:]
    for b in range(row.shape[0]):
        row[b] = min(min(row[b], at[b] + ACROSS), min(before[b], after[b]) + DIAGONALLY)
