"""The hot loops of `SeenSpace`. A space is four arrays over square cells, in the frame of dead reckoning:

`seen` (n, n): when the cell was last seen or heard to be free, s; `heard` (2, n, n): the same by the sonar alone, and well inside a cone.
`stamps` (2, n, n): when something was last seen to stand in it, and `spots` (2, n, n, 2): where, x m, y m; for two heights: LEVEL, the plane of
the laser, and LOW, what only the sonar hears or a scan that looks down sees. NEVER = never.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills.outline import Array

Counts = NDArray[np.intp]
CELL_M = 0.05
LEVEL, LOW = 0, 1
X, Y = range(2)
NEVER = -1e18
BEAM_SLACK_M = 0.05  # a beam that ends so little beyond a point does not prove that the point is gone: three sigma of an LMS200 and more
BESIDE_M = 0.015  # nor does one that passes farther beside it …
ALONG = 4  # … or as close by so many: it runs along the face of a wall
CONE_SLACK_M = 0.12  # the same for an echo
FRESH_S = 1.0  # what the laser saw so short a time ago, the sonar does not take away
TOUCHING_M = -1.0  # in place of an echo: something may touch the transducer
LATELY_S = 1.0
TWICE_S = 0.25  # a round of the ring ago, and in between none may be missing but one
SUDDEN_M = 1.0  # who is heard so near where nothing was known may be on his way
UNSEEN, UNKNOWN, CAME, SUDDEN, HIDDEN = 1, 2, 3, 4, 5
ANYHOW, INSIDE = 0, 1  # layers of `heard`
INSIDE_M = -0.03  # points so deep inside the outline are not there: the robot is


@inline_kernel
def cell_of(x_m: float, corner_m: float) -> int:
    """The row or column of a coordinate."""
    return int(math.floor((x_m - corner_m) / CELL_M))  # noqa: RUF046  # a kernel's floor gives a float


@inline_kernel
def cells_of(apex_m: float, axis_m: float, side_m: float, corner_m: float, n: int) -> tuple[int, int]:
    """The rows or columns that a cone covers, as a range: from its apex along its axis, with so much to each side of its end."""
    first, last = cell_of(apex_m + min(0.0, axis_m - abs(side_m)), corner_m), cell_of(apex_m + max(0.0, axis_m + abs(side_m)), corner_m)
    return max(0, first), min(n, last + 1)


@kernel
def see_beams(
    seen: Array, stamps: Array, spots: Array, corner_x_m: float, corner_y_m: float, x_m: float, y_m: float, first_rad: float, step_rad: float,
    ranges_m: Array, believed: Array, stamp_s: float, most_m: float,
) -> None:  # fmt: skip
    """Take a level scan from (x, y): what the beams run through is free, where they end something stands.

    Args:
        ranges_m: (n,); what is not a positive number says nothing. believed: (n,) 0 = this beam's end is not believed yet.
        most_m: beams are followed so far.
    A beam clears only as far as its two neighbours reach too: one lost beam opens no hole in a wall. So every second beam is enough.
    """
    n = ranges_m.shape[0]
    flat_seen, flat_level = seen.reshape(-1), stamps[LEVEL].reshape(-1)
    places = np.zeros(max(0, int(most_m / (0.7 * CELL_M))) + 1, dtype=np.int32)
    passed = places.copy()
    for i in range(0, n, 2):
        right_m, left_m = ranges_m[max(i - 1, 0)], ranges_m[min(i + 1, n - 1)]
        if not (ranges_m[i] > 0.0 and right_m > 0.0 and left_m > 0.0):  # also NaN
            continue
        free_m = min(ranges_m[i], right_m, left_m)
        free_m = min(free_m - BEAM_SLACK_M, most_m)
        if free_m < 0.0:
            continue
        count = int(free_m / (0.7 * CELL_M)) + 1
        c, s = math.cos(first_rad + i * step_rad), math.sin(first_rad + i * step_rad)
        cells_along(places[:count], x_m, y_m, c, s, free_m, corner_x_m, corner_y_m, seen.shape[0], seen.shape[1])
        met = 0
        for k in range(count):
            if places[k] < 0:
                break
            flat_seen[places[k]] = stamp_s
            level_s = flat_level[places[k]]
            if level_s > NEVER and level_s < stamp_s:
                row, column = places[k] // seen.shape[1], places[k] % seen.shape[1]
                dx, dy = spots[LEVEL, row, column, X] - x_m, spots[LEVEL, row, column, Y] - y_m
                away_m = math.hypot(dx, dy)
                is_close = away_m < free_m and abs(c * dy - s * dx) < max(BESIDE_M, 2.0 * away_m * step_rad)
                if is_close and (met == 0 or passed[met - 1] != places[k]):
                    passed[met], met = places[k], met + 1
        for k in range(met if met < ALONG else 0):
            flat_level[passed[k]] = NEVER
    for i in range(n):
        range_m = ranges_m[i]
        if range_m > 0.0 and range_m < most_m and believed[i] != 0.0:
            x, y = x_m + range_m * math.cos(first_rad + i * step_rad), y_m + range_m * math.sin(first_rad + i * step_rad)
            put(stamps, spots, LEVEL, corner_x_m, corner_y_m, x, y, x_m, y_m, stamp_s)


@inline_kernel
def cells_along(
    places: NDArray[np.int32], x_m: float, y_m: float, c: float, s: float, free_m: float, corner_x_m: float, corner_y_m: float, rows: int,
    columns: int,
) -> None:  # fmt: skip
    """Fill in the cells along a beam from (x, y) up to `free_m`, numbered row by row; -1 = beyond the edge. Without a branch, so it is vectorised."""
    for k in range(places.shape[0]):
        along_m = min(0.7 * CELL_M * k, free_m)
        column, row = math.floor((x_m + c * along_m - corner_x_m) / CELL_M), math.floor((y_m + s * along_m - corner_y_m) / CELL_M)
        is_inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        places[k] = row * columns + column if is_inside else -1


@inline_kernel
def put(
    stamps: Array, spots: Array, layer: int, corner_x_m: float, corner_y_m: float, x: float, y: float, from_x: float, from_y: float, stamp_s: float
) -> None:
    """Note a point; of several in one cell at one time the nearest to the sensor."""
    column, row = cell_of(x, corner_x_m), cell_of(y, corner_y_m)
    if 0 <= column < stamps.shape[2] and 0 <= row < stamps.shape[1]:
        is_new = stamps[layer, row, column] != stamp_s
        if is_new or math.hypot(x - from_x, y - from_y) < math.hypot(spots[layer, row, column, X] - from_x, spots[layer, row, column, Y] - from_y):
            stamps[layer, row, column], spots[layer, row, column, X], spots[layer, row, column, Y] = stamp_s, x, y


@kernel
def put_all(
    stamps: Array, spots: Array, layer: int, corner_x_m: float, corner_y_m: float, points: Array, from_x: float, from_y: float, stamps_s: Array
) -> None:
    """Note points (n, 2), each with its own stamp (n,), as `put` does."""
    for i in range(points.shape[0]):
        put(stamps, spots, layer, corner_x_m, corner_y_m, points[i, X], points[i, Y], from_x, from_y, stamps_s[i])


@kernel
def place_cones(axes: Array, leaves_m: Array, heard_m: Array, rounds: int, x_m: float, y_m: float, theta_rad: float, cones: Array) -> None:
    """The cones of a round as `hear_cones` takes them, for the robot at (x, y, theta).

    Args:
        axes: (k, 3) transducers in the robot frame. leaves_m: (k,) how far each one's axis runs inside the outline.
        heard_m: (ROUNDS, k) the last rounds, the newest one last, 0 = deaf. rounds: how many there have been; with fewer nothing clears.
    """
    c, s, newest = math.cos(theta_rad), math.sin(theta_rad), heard_m.shape[0] - 1
    for k in range(axes.shape[0]):
        cones[k, 0], cones[k, 1] = x_m + c * axes[k, 0] - s * axes[k, 1], y_m + s * axes[k, 0] + c * axes[k, 1]
        cones[k, 2], cones[k, 3], cones[k, 5] = axes[k, 2] + theta_rad, max(heard_m[newest, k], leaves_m[k]), leaves_m[k]
        cones[k, 4] = heard_m[newest, k] if rounds > newest else 0.0
        for r in range(newest):
            cones[k, 4] = min(cones[k, 4], heard_m[r, k])


@kernel
def hear_cones(
    seen: Array, heard: Array, stamps: Array, spots: Array, corner_x_m: float, corner_y_m: float, cones: Array, half_cone_rad: float,
    stamp_s: float, most_m: float, fleeting_s: float, news: Counts,
) -> int:  # fmt: skip
    """Take a round of the sonar ring.

    Args:
        cones: (k, 6) x m, y m, theta rad, echo m (now; most_m and more = none), clear m (surely free so far), where the body ends m.
        news: (k,) is filled: UNKNOWN, the laser saw nothing that explains an echo, where all was seen free once; CAME, also its whole arc was
            heard free a moment ago, so what is there now walks; SUDDEN, it is near and new; UNSEEN and, if it is near and new, HIDDEN: nobody ever
            looked where it is, so it may always have stood there.
    Within a cone everything nearer than its clear range is free. An echo that nothing known explains may have arisen anywhere on its arc:
    the part of the arc that no other cone of this round clears counts as an obstacle. An echo from nearer than a transducer can tell is not
    noted but marked in the cones: something touches the skin as long as it is heard; from farther away its place is known. What appears
    where it was free a moment ago came by itself and may go by itself: it counts as so much older, `fleeting_s`, from the start.
    Returns: how many cones are marked.
    """
    opening, touching = math.tan(half_cone_rad), 0
    for clears in (1, 0):
        for k in range(cones.shape[0]):
            x_m, y_m, clear_m, echo_m = cones[k, 0], cones[k, 1], cones[k, 4] - CONE_SLACK_M, cones[k, 3]
            if clears == 0 and (echo_m >= most_m or is_explained(LEVEL, stamps, spots, corner_x_m, corner_y_m, cones, k, half_cone_rad)):
                continue
            if clears == 0 and echo_m <= cones[k, 5]:
                cones[k, 3], touching = TOUCHING_M, touching + 1
                continue
            if clears == 0:
                is_new = echo_m < SUDDEN_M and not is_explained(LOW, stamps, spots, corner_x_m, corner_y_m, cones, k, half_cone_rad)
                news[k] = SUDDEN if is_new else UNKNOWN
            c, s = math.cos(cones[k, 2]), math.sin(cones[k, 2])
            far_m = min(clear_m, most_m) if clears == 1 else max(echo_m, cones[k, 5]) + CELL_M
            column_0, column_1 = cells_of(x_m, c * far_m, abs(s) * far_m * opening, corner_x_m, seen.shape[1])
            row_0, row_1 = cells_of(y_m, s * far_m, abs(c) * far_m * opening, corner_y_m, seen.shape[0])
            on_arc, was_free, was_seen, near_m = 0, 0, 0, max(0.0, far_m - 2.0 * CELL_M)
            for row in range(row_0, row_1):
                dy = corner_y_m + (row + 0.5) * CELL_M - y_m
                if clears == 1:
                    span = slice(column_0, column_1)
                    clear_cells(seen[row, span], stamps[LOW, row, span], stamps[LEVEL, row, span], heard[ANYHOW, row, span],
                                heard[INSIDE, row, span], corner_x_m, x_m, column_0, dy, c, s, opening, clear_m, stamp_s)  # fmt: skip
                    continue
                for column in range(column_0, column_1):
                    dx = corner_x_m + (column + 0.5) * CELL_M - x_m
                    square = dx * dx + dy * dy
                    if square > far_m * far_m or square < near_m * near_m:
                        continue  # surely not on the arc
                    ahead_m, aside_m, away_m = c * dx + s * dy, abs(c * dy - s * dx), math.sqrt(square)
                    if ahead_m <= 0.0 or aside_m > ahead_m * opening:
                        continue
                    if abs(away_m - far_m + CELL_M) < 0.75 * CELL_M and seen[row, column] < stamp_s:
                        share = (far_m - CELL_M) / max(away_m, 1e-6)
                        on_arc, was_free = on_arc + 1, was_free + (heard[INSIDE, row, column] > stamp_s - LATELY_S)
                        was_seen += seen[row, column] > NEVER
                        put_s = stamp_s - fleeting_s if heard[ANYHOW, row, column] > stamp_s - LATELY_S else stamp_s
                        put(stamps, spots, LOW, corner_x_m, corner_y_m, x_m + dx * share, y_m + dy * share, x_m, y_m, put_s)
            if on_arc > 0 and was_free == on_arc:
                news[k] = CAME
            elif was_seen < on_arc:
                news[k] = HIDDEN if news[k] == SUDDEN else UNSEEN
    return touching


@inline_kernel
def clear_cells(
    seen: Array, low: Array, level: Array, anyhow: Array, inside: Array, corner_x_m: float, x_m: float, first: int, dy_m: float, c: float,
    s: float, opening: float, clear_m: float, stamp_s: float,
) -> None:  # fmt: skip
    """The sonar hears through the cells of a row that lie in a cone: what was heard there is gone, and so is what the laser saw there long ago.

    All arrays (n,), of the columns from `first` on. x_m: of the apex, from which the row lies `dy_m` aside; c, s: the cone's axis.
    Every cell is written, most of them as they were: without a branch the loop is vectorised.
    """
    for k in range(seen.shape[0]):
        dx = corner_x_m + (first + k + 0.5) * CELL_M - x_m
        ahead_m, aside_m = c * dx + s * dy_m, abs(c * dy_m - s * dx)
        is_in = (ahead_m > 0.0) & (aside_m <= ahead_m * opening) & (math.sqrt(dx * dx + dy_m * dy_m) < clear_m)
        is_sure = anyhow[k] > stamp_s - TWICE_S  # one lost echo proves nothing
        is_well_in = is_in & is_sure & (aside_m < ahead_m * opening - CELL_M)  # what stands on the edge is heard now and then
        seen[k] = stamp_s if is_in else seen[k]
        low[k] = NEVER if is_in else low[k]
        level[k] = NEVER if is_well_in & (level[k] < stamp_s - FRESH_S) else level[k]
        anyhow[k] = stamp_s if is_in else anyhow[k]
        inside[k] = stamp_s if is_well_in else inside[k]


@inline_kernel
def is_explained(
    layer: int, stamps: Array, spots: Array, corner_x_m: float, corner_y_m: float, cones: Array, k: int, half_cone_rad: float
) -> bool:
    """Whether something is known in the cone about as near as the echo, by the laser or from echoes before."""
    x_m, y_m, reach_m, opening = cones[k, 0], cones[k, 1], cones[k, 3] + 2.0 * CONE_SLACK_M, math.tan(half_cone_rad)
    c, s = math.cos(cones[k, 2]), math.sin(cones[k, 2])
    column_0, column_1 = cells_of(x_m, c * reach_m, abs(s) * reach_m * opening, corner_x_m, stamps.shape[2])
    row_0, row_1 = cells_of(y_m, s * reach_m, abs(c) * reach_m * opening, corner_y_m, stamps.shape[1])
    for row in range(row_0, row_1):
        if not has_any(stamps[layer, row, column_0:column_1]):
            continue
        for column in range(column_0, column_1):
            if stamps[layer, row, column] > NEVER:
                dx, dy = spots[layer, row, column, X] - x_m, spots[layer, row, column, Y] - y_m
                ahead_m, aside_m = c * dx + s * dy, abs(c * dy - s * dx)
                if dx * dx + dy * dy < reach_m * reach_m and aside_m < ahead_m * opening + CELL_M:
                    return True
    return False


@inline_kernel
def has_any(stamps: Array) -> bool:
    """Whether anything stands in a row of cells (n,): without a branch in the loop, so that it is vectorised."""
    found = False
    for k in range(stamps.shape[0]):
        found = found | (stamps[k] > NEVER)
    return found


@kernel
def stand(
    seen: Array, stamps: Array, spots: Array, corner_x_m: float, corner_y_m: float, x_m: float, y_m: float, theta_rad: float, planes: Array,
    reach_m: float, grown_m: float, stamp_s: float, hits_since_s: float, window_m: float, out: Array,
) -> int:  # fmt: skip
    """Where the robot stands (and `grown_m` around) is free; gather the points around it. The outermost cell is left out: cells beside a free one
    count as known, and the robot must not know what it is about to move into.

    Args:
        out: (n, 4) is filled: x m, y m in the robot frame, LEVEL or LOW, room for a margin.
    Returns: how many points lie within `window_m`. Those older than `hits_since_s`, those inside the robot, and echoes where the laser sees
        something too, are forgotten.
    """
    count = 0
    c, s = math.cos(theta_rad), math.sin(theta_rad)
    near_m = reach_m + grown_m + CELL_M
    column_0, column_1 = max(0, cell_of(x_m - window_m, corner_x_m)), min(seen.shape[1], cell_of(x_m + window_m, corner_x_m) + 1)
    near_0 = max(column_0, cell_of(x_m - near_m, corner_x_m))
    near_1, outside = max(near_0, min(column_1, cell_of(x_m + near_m, corner_x_m) + 1)), np.zeros(seen.shape[1])
    for row in range(max(0, cell_of(y_m - window_m, corner_y_m)), min(seen.shape[0], cell_of(y_m + window_m, corner_y_m) + 1)):
        dy = corner_y_m + (row + 0.5) * CELL_M - y_m
        if dy * dy < near_m * near_m:
            stand_on(seen[row, near_0:near_1], corner_x_m, x_m, near_0, dy, c, s, planes, near_m, grown_m - CELL_M, stamp_s, outside)
        if not (has_any(stamps[LEVEL, row, column_0:column_1]) or has_any(stamps[LOW, row, column_0:column_1])):
            continue
        for column in range(column_0, column_1):
            for layer in range(2):
                if stamps[layer, row, column] == NEVER:
                    continue
                away_x, away_y = spots[layer, row, column, X] - x_m, spots[layer, row, column, Y] - y_m
                px, py = c * away_x + s * away_y, c * away_y - s * away_x
                is_old = stamps[layer, row, column] < hits_since_s or (layer == LOW and is_level_near(stamps, row, column))
                if is_old or outside_m(planes, px, py) < INSIDE_M:
                    stamps[layer, row, column] = NEVER
                elif count < out.shape[0]:
                    out[count, 0], out[count, 1], out[count, 2] = px, py, layer
                    count += 1
    return count


@inline_kernel
def stand_on(
    seen: Array, corner_x_m: float, x_m: float, first: int, dy_m: float, c: float, s: float, planes: Array, near_m: float, least_m: float,
    stamp_s: float, outside: Array,
) -> None:  # fmt: skip
    """Mark those cells of a row (n,), of the columns from `first` on, that are nearer than `near_m` to the robot's middle and less than `least_m`
    outside of its outline. The row lies `dy_m` aside from the middle, x_m; `outside` (n or more,) is to work on. Plane by plane, so that the loops
    are vectorised.
    """
    for p in range(planes.shape[0]):
        nx, ny, at_m = planes[p, 0], planes[p, 1], planes[p, 2]
        for k in range(seen.shape[0]):
            dx = corner_x_m + (first + k + 0.5) * CELL_M - x_m
            beyond_m = nx * (c * dx + s * dy_m) + ny * (c * dy_m - s * dx) - at_m
            outside[k] = beyond_m if p == 0 or beyond_m > outside[k] else outside[k]
    for k in range(seen.shape[0]):
        dx = corner_x_m + (first + k + 0.5) * CELL_M - x_m
        seen[k] = stamp_s if (dx * dx + dy_m * dy_m < near_m * near_m) & (outside[k] < least_m) else seen[k]


@inline_kernel
def is_level_near(stamps: Array, row: int, column: int) -> bool:
    """Whether the laser sees something in this cell or one beside it: then it knows better where."""
    found = False
    for i in range(max(0, row - 1), min(stamps.shape[1], row + 2)):
        for j in range(max(0, column - 1), min(stamps.shape[2], column + 2)):
            found = found or stamps[LEVEL, i, j] > NEVER
    return found


@inline_kernel
def outside_m(planes: Array, x: float, y: float) -> float:
    """How far a point of the robot frame is outside the outline; negative inside."""
    distance_m = -1e9
    for k in range(planes.shape[0]):
        distance_m = max(distance_m, planes[k, 0] * x + planes[k, 1] * y - planes[k, 2])
    return distance_m
