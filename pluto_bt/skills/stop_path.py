"""The stopping path: if the robot takes this command for one more decision and then brakes, what does its outline run into?"""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills.outline import Array, Outline
from pluto_bt.skills.seen_kernels import CELL_M, NEVER, cell_of, outside_m

CLEAR, MEETS, UNSEEN, WALKER = 0, 1, 2, 3
STEP_M = 0.03  # the rim is looked at each time the outline may have moved so far …
STEP_S = 0.1  # … and after so long where somebody may come up meanwhile
NEARER_M = 0.004  # a point already within its margin may come nearer by so much in one decision, but never nearer than LEAST_M
DEEP_M = -0.1  # points deeper inside the outline are the robot itself
MOST_MARGIN_M = 0.1
LONGEST_S = 8.0
BODY_M, SLIM_M = 0.2, 0.1  # who touches the outline has his middle about so far outside of it, give or take the second
FAN_RAD = math.radians(15.0)  # a corner may be touched from all directions between its two edges' normals: one is looked at in each so much
WALKER_X, WALKER_Y, DRIFT_X, DRIFT_Y, SPREAD_M, GROWTH_MPS, IN_VIEW, WALKER_COLUMNS = range(8)  # columns of the walkers, and how many there are
STRANGER = -1.0  # in place of IN_VIEW: somebody whom no sensor found
SPEED, TURN_RATE, ACCELERATION, DECELERATION, TURN_ACCELERATION, HOLD_S, REACH_M, LEAST_M, MARGIN_M, MARGIN_S, CREEP_MPS = range(11)


@kernel
def first_trouble(
    points: Array, count: int, planes: Array, rim: Array, seen: Array, stamps: Array, corner_x_m: float, corner_y_m: float,
    x_m: float, y_m: float, theta_rad: float, figures: Array, speed_mps: float, turn_rate_radps: float, known_since_s: float,
    walkers: Array, fresh_since_s: float, lately_since_s: float,
) -> tuple[int, int, float]:  # fmt: skip
    """Drive the command, brake, and look on the way.

    Args:
        points: (n, 4) x m, y m in the robot frame; the last column is used here. count: how many of them count.
        rim: (m, 4) points of the outline with their outward normals, at most 0.7 cells apart.
        figures: the robot's twist now, its limits, how long the command holds before the brakes bite, and so on (the constants above).
        speed_mps, turn_rate_radps: the command.
        known_since_s: cells seen before are not known any more.
        walkers: (k, WALKER_COLUMNS) the discs in which the middles of walkers are; see `Walker.row`.
        fresh_since_s, lately_since_s: nobody who is out of view is where it was seen to be free since, and no STRANGER.
    Returns: (CLEAR, -1, 0), (MEETS, point, s), (UNSEEN, rim point, s) or (WALKER, rim point, s): what comes first, and when.
    """
    v, w = figures[SPEED], figures[TURN_RATE]
    fastest = max(abs(v), abs(speed_mps)) + max(abs(w), abs(turn_rate_radps)) * figures[REACH_M]
    margin_m = min(figures[MARGIN_M] + figures[MARGIN_S] * fastest, MOST_MARGIN_M)
    for i in range(count):
        points[i, 3] = margin_of(outside_m(planes, points[i, 0], points[i, 1]), margin_m, figures[LEAST_M])
    x, y, turned, t_s, to_point_m, to_rim_m, looked_s, was_held = 0.0, 0.0, 0.0, 0.0, 0.0, STEP_M, 0.0, True
    while t_s < LONGEST_S:
        if to_point_m <= 0.0:
            to_point_m, which = nearest(points, count, planes, x, y, turned)
            if to_point_m <= 0.0:
                return MEETS, which, t_s
        goes_on = t_s < figures[HOLD_S]
        is_due = to_rim_m <= 0.0 or (walkers.shape[0] > 0 and t_s - looked_s > STEP_S)
        if is_due or (was_held and not goes_on):  # when the brakes begin to bite it is fastest
            to_rim_m, looked_s, was_held = STEP_M, t_s, goes_on
            creep_mps = figures[CREEP_MPS]
            kind, which = rim_in_danger(
                rim, seen, stamps, corner_x_m, corner_y_m, x_m, y_m, theta_rad, x, y, turned, v, w, creep_mps, known_since_s,
                walkers, fresh_since_s, lately_since_s, t_s,
            )  # fmt: skip
            if kind != CLEAR:
                return kind, which, t_s
        dt_s = min(0.05, max(0.005, 0.5 * STEP_M / max(abs(v) + abs(w) * figures[REACH_M], 1e-3)))
        v_next = towards(v, speed_mps if goes_on else 0.0, figures[ACCELERATION] * dt_s, figures[DECELERATION] * dt_s)
        w_next = towards(w, turn_rate_radps if goes_on else 0.0, figures[TURN_ACCELERATION] * dt_s, figures[TURN_ACCELERATION] * dt_s)
        v_mean, w_mean = 0.5 * (v + v_next), 0.5 * (w + w_next)
        x += v_mean * dt_s * math.cos(turned + 0.5 * w_mean * dt_s)
        y += v_mean * dt_s * math.sin(turned + 0.5 * w_mean * dt_s)
        turned += w_mean * dt_s
        moved_m = (abs(v_mean) + abs(w_mean) * figures[REACH_M]) * dt_s
        to_point_m, to_rim_m, v, w, t_s = to_point_m - moved_m, to_rim_m - moved_m, v_next, w_next, t_s + dt_s
        if not goes_on and v == 0.0 and w == 0.0:
            break
    return CLEAR, -1, 0.0


@inline_kernel
def margin_of(distance_m: float, margin_m: float, least_m: float) -> float:
    """The margin of a point that is so far away now: who stands too near already may leave, and slide along."""
    if distance_m < DEEP_M:
        return -1e9
    if distance_m >= margin_m + NEARER_M:
        return margin_m
    return min(distance_m - 0.001, max(least_m, distance_m - NEARER_M))


@inline_kernel
def nearest(points: Array, count: int, planes: Array, x: float, y: float, turned: float) -> tuple[float, int]:
    """How far the outline at (x, y, turned) may move before it may come within a point's margin, and which point that is."""
    c, s = math.cos(turned), math.sin(turned)
    least_m, which = 1e9, -1
    for i in range(count):
        dx, dy = points[i, 0] - x, points[i, 1] - y
        free_m = outside_m(planes, c * dx + s * dy, c * dy - s * dx) - points[i, 3]
        if free_m < least_m:
            least_m, which = free_m, i
    if least_m <= 0.0:
        return least_m, which
    return max(least_m, 0.001), which


@inline_kernel
def rim_in_danger(
    rim: Array, seen: Array, stamps: Array, corner_x_m: float, corner_y_m: float, x_m: float, y_m: float, theta_rad: float,
    x: float, y: float, turned: float, v: float, w: float, creep_mps: float, known_since_s: float, walkers: Array, fresh_since_s: float,
    lately_since_s: float, t_s: float,
) -> tuple[int, int]:  # fmt: skip
    """Which point of the rim moves outwards, faster than creeping, where nothing was ever seen, or where a walker may be by then."""
    c0, s0 = math.cos(theta_rad), math.sin(theta_rad)
    c, s = math.cos(theta_rad + turned), math.sin(theta_rad + turned)
    at_x, at_y = x_m + c0 * x - s0 * y, y_m + s0 * x + c0 * y
    for i in range(rim.shape[0]):
        px, py, nx, ny = rim[i, 0], rim[i, 1], rim[i, 2], rim[i, 3]
        if (v - w * py) * nx + w * px * ny <= creep_mps:
            continue
        column, row = cell_of(at_x + c * px - s * py, corner_x_m), cell_of(at_y + s * px + c * py, corner_y_m)
        if not is_known(seen, stamps, row, column, known_since_s):
            return UNSEEN, i
        if walkers.shape[0] > 0:
            px, py = px + BODY_M * nx, py + BODY_M * ny
            px, py = at_x + c * px - s * py, at_y + s * px + c * py
            column, row = cell_of(px, corner_x_m), cell_of(py, corner_y_m)
            seen_s = seen[row, column] if 0 <= row < seen.shape[0] and 0 <= column < seen.shape[1] else NEVER
            if is_walked_to(walkers, px, py, t_s, seen_s >= fresh_since_s, seen_s >= lately_since_s):
                return WALKER, i
    return CLEAR, -1


@inline_kernel
def is_walked_to(walkers: Array, px: float, py: float, t_s: float, is_fresh: bool, is_late: bool) -> bool:
    """Whether the middle of a walker may be at a point after `t_s`; of those out of view none is where it `is_fresh`, no stranger where `is_late`."""
    found = False
    for k in range(walkers.shape[0]):
        dx, dy = walkers[k, WALKER_X] + walkers[k, DRIFT_X] * t_s - px, walkers[k, WALKER_Y] + walkers[k, DRIFT_Y] * t_s - py
        near_m = walkers[k, SPREAD_M] + walkers[k, GROWTH_MPS] * t_s + SLIM_M
        is_elsewhere = is_fresh if walkers[k, IN_VIEW] == 0.0 else is_late and walkers[k, IN_VIEW] == STRANGER
        if dx * dx + dy * dy < near_m * near_m and not is_elsewhere:
            found = True
    return found


@inline_kernel
def is_known(seen: Array, stamps: Array, row: int, column: int, known_since_s: float) -> bool:
    """Whether a cell or one beside it was seen free, or holds a point (which is looked at as such): beams leave gaps of a cell."""
    known = False
    if 1 <= row < seen.shape[0] - 1 and 1 <= column < seen.shape[1] - 1:
        known = (
            seen[row, column] >= known_since_s
            or stamps[0, row, column] > NEVER
            or stamps[1, row, column] > NEVER
            or seen[row - 1, column] >= known_since_s
            or seen[row + 1, column] >= known_since_s
            or seen[row, column - 1] >= known_since_s
            or seen[row, column + 1] >= known_since_s
        )
    return known


@inline_kernel
def towards(now: float, wanted: float, faster: float, slower: float) -> float:
    """One step of a motor from `now` to `wanted`; a change of direction pauses at rest."""
    if now * wanted < 0.0:
        wanted = 0.0
    step = slower if abs(wanted) < abs(now) else faster
    return min(wanted, now + step) if wanted > now else max(wanted, now - step)


def rim_of(outline: Outline, corners_m: tuple[tuple[float, float], ...]) -> Array:
    """(m, 4) points x, y of the outline with their outward normals, at most 0.7 cells apart, so that none of their steps leaps over a cell.

    A corner comes again with directions between the normals of its two edges.
    """
    planes = outline.planes.tolist()
    rows = []
    for (nx, ny, c), (mx, my, _) in zip(planes, planes[1:] + planes[:1], strict=True):
        on_edge = [-ny * x + nx * y for x, y in corners_m if abs(nx * x + ny * y - c) < 1e-6]
        first, last = min(on_edge), max(on_edge)
        n = max(2, math.ceil((last - first) / (0.7 * CELL_M)) + 1)
        rows += [(nx * c - ny * along, ny * c + nx * along, nx, ny) for along in np.linspace(first, last, n).tolist()]
        corner, normal_rad = rows[-1][:2], math.atan2(ny, nx)
        bend_rad = math.atan2(nx * my - ny * mx, nx * mx + ny * my)
        steps = math.ceil(bend_rad / FAN_RAD)
        rows += [(*corner, math.cos(normal_rad + bend_rad * k / steps), math.sin(normal_rad + bend_rad * k / steps)) for k in range(1, steps)]
    return np.array(rows)
