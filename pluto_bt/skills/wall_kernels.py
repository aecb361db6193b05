"""The hot loops of wall follow: which points stand beside the robot, how a path lies from here, how near it comes, how fast it can be driven."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.seen_kernels import outside_m

X, Y, HEADING = range(3)  # columns of a path
VX, VY = 3, 4  # columns of the obstacles


@kernel
def standing(points: Array, planes: Array, side: float, square_m: float, within_m: float) -> Array:
    """(n, 2) those of the obstacles (m, 5) x, y, margin, velocity that do not move, lie outside the outline's `planes` and are not alone.

    Args:
        side: the factor of y, -1 = the picture is mirrored.
        square_m, within_m: alone is who has no other in his square or one beside it; farther away that says nothing.
    """
    kept, count = np.zeros((points.shape[0], 2)), 0
    low_x, low_y, high_x, high_y = np.inf, np.inf, -np.inf, -np.inf
    for i in range(points.shape[0]):
        if points[i, VX] == 0.0 and points[i, VY] == 0.0:
            kept[count, X], kept[count, Y], count = points[i, X], points[i, Y], count + 1
            low_x, high_x = min(low_x, points[i, X]), max(high_x, points[i, X])
            low_y, high_y = min(low_y, points[i, Y]), max(high_y, points[i, Y])
    if count == 0:
        return kept[:0]
    first_i, first_j = square_of(low_x, square_m) - 1, square_of(low_y, square_m) - 1
    many = np.zeros((square_of(high_x, square_m) - first_i + 2, square_of(high_y, square_m) - first_j + 2), dtype=np.int32)
    for i in range(count):
        many[square_of(kept[i, X], square_m) - first_i, square_of(kept[i, Y], square_m) - first_j] += 1
    good = 0
    for i in range(count):
        x, y = kept[i, X], kept[i, Y]
        a, b = square_of(x, square_m) - first_i, square_of(y, square_m) - first_j
        others = -1
        for da in range(-1, 2):
            others += many[a + da, b - 1] + many[a + da, b] + many[a + da, b + 1]
        if (others > 0 or x * x + y * y >= within_m * within_m) and outside_m(planes, x, y) > 0.0:
            kept[good, X], kept[good, Y], good = x, side * y, good + 1
    return kept[:good]


@inline_kernel
def square_of(at_m: float, square_m: float) -> int:
    """The number of the square in which a coordinate lies."""
    return int(math.floor(at_m / square_m))  # noqa: RUF046  # a kernel's floor gives a float


@kernel
def seen_from(path: Array, before: Planar, now: Planar) -> Array:
    """A path (n, 3) x, y, heading given in the frame `before`, in that of now."""
    out = np.zeros((path.shape[0], 3))
    turn_c, turn_s = math.cos(before[2] - now[2]), math.sin(before[2] - now[2])
    c, s, dx, dy = math.cos(now[2]), math.sin(now[2]), before[0] - now[0], before[1] - now[1]
    x0, y0 = c * dx + s * dy, c * dy - s * dx
    for k in range(path.shape[0]):
        out[k, X] = x0 + turn_c * path[k, X] - turn_s * path[k, Y]
        out[k, Y] = y0 + turn_s * path[k, X] + turn_c * path[k, Y]
        out[k, HEADING] = path[k, HEADING] + before[2] - now[2]
    return out


@kernel
def nearest_of(path: Array, later_m: float) -> int:
    """The point of a path (n, 2 or more) that is nearest to the robot; each counts as `later_m` farther away than the one before."""
    best, least_m = 0, np.inf
    for k in range(path.shape[0]):
        away_m = math.sqrt(path[k, X] * path[k, X] + path[k, Y] * path[k, Y]) + later_m * k
        if away_m < least_m:
            best, least_m = k, away_m
    return best


@kernel
def keeps_away(path: Array, first: int, last: int, step: int, points: Array, least_m: float) -> bool:
    """True if every `step`-th point of a path from `first` up to `last` is at least `least_m` from all points (m, 2)."""
    for k in range(first, min(last, path.shape[0]), step):
        for i in range(points.shape[0]):
            dx, dy = path[k, X] - points[i, X], path[k, Y] - points[i, Y]
            if dx * dx + dy * dy < least_m * least_m:
                return False
    return True


@kernel
def camera_off(path: Array, first: int, last: int, points: Array, x_m: float, y_m: float, away_m: float) -> Array:
    """How much farther than `away_m` from the nearest of the points (m, 2) a camera is that the robot holds at x, y; at rows first up to last."""
    off_m = np.zeros(max(min(last, path.shape[0]) - first, 0))
    for k in range(off_m.shape[0]):
        c, s = math.cos(path[first + k, HEADING]), math.sin(path[first + k, HEADING])
        x, y = path[first + k, X] + c * x_m - s * y_m, path[first + k, Y] + s * x_m + c * y_m
        least = np.inf
        for i in range(points.shape[0]):
            dx, dy = points[i, X] - x, points[i, Y] - y
            least = min(least, dx * dx + dy * dy)
        off_m[k] = math.sqrt(least) - away_m
    return off_m


@kernel
def way_lengths(path: Array, first: int) -> Array:
    """How far it is along a path (n, 2 or more) from its point `first` to that one and all after it."""
    way_m = np.zeros(path.shape[0] - first)
    for k in range(1, way_m.shape[0]):
        dx, dy = path[first + k, X] - path[first + k - 1, X], path[first + k, Y] - path[first + k - 1, Y]
        way_m[k] = way_m[k - 1] + math.sqrt(dx * dx + dy * dy)
    return way_m


@kernel
def bend_speed(path: Array, first: int, way_m: Array, bend_m: float, most_radps: float, brake_mps2: float) -> float:
    """The speed now at which there is time to brake before each bend of a path (n, 3) from `first` on, infinite without bends.

    Args:
        way_m: of `way_lengths`. bend_m: a bend is measured over so much of the path. most_radps: turn rate in bends.
    """
    slowest_mps, j, last = np.inf, 0, way_m.shape[0] - 1
    for k in range(last + 1):
        while j < last and way_m[j] < way_m[k] + bend_m:
            j += 1
        turn_rad = path[first + j, HEADING] - path[first + k, HEADING]
        bend_rad = abs((turn_rad + math.pi) % math.tau - math.pi)
        most_mps = most_radps / max(bend_rad / bend_m, 1e-3)
        slowest_mps = min(slowest_mps, math.sqrt(most_mps * most_mps + 2.0 * brake_mps2 * way_m[k]))
    return slowest_mps


def warm() -> None:
    """Use the kernels once, so that no later use waits for their compilation."""
    here = (0.0, 0.0, 0.0)
    near = standing(np.zeros((1, 5)), np.zeros((1, 3)), 1.0, 1.0, 1.0)
    path = seen_from(np.zeros((1, 3)), here, here)
    keeps_away(np.zeros((1, 5)), nearest_of(np.zeros((1, 5)), 0.0), 1, 1, near, 1.0)
    bend_speed(path, 0, way_lengths(path, 0), 1.0, 1.0, 1.0)
