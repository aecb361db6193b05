"""The robot's outline as the chain sees it: its convex hull as half planes, and the sizes that follow from it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.platform import Point

Array = NDArray[np.float64]
Planar = tuple[float, float, float]  # a pose on the ground: x m, y m, theta rad


@dataclass(frozen=True, slots=True)
class Outline:
    """Sizes in the robot frame.

    Attributes:
        planes: (k, 3) rows (nx, ny, c): a point p lies `nx*x + ny*y - c` outside of that edge.
        front_m, back_m, side_m: how far the outline reaches from the centre, all positive.
        reach_m: the farthest corner.
    """

    planes: Array
    front_m: float
    back_m: float
    side_m: float
    reach_m: float

    def distance_m(self, x_m: float, y_m: float) -> float:
        """How far a point is from the outline; negative inside. At corners the nearer of the two edges' lines counts, which is never too far."""
        return float(max(nx * x_m + ny * y_m - c for nx, ny, c in self.planes.tolist()))

    def round_a_circle_m(self, radius_m: float) -> float:
        """How far the outline reaches out of a circle round which the centre goes: its outer corners swing out."""
        return math.hypot(radius_m + self.side_m, max(self.front_m, self.back_m)) - radius_m

    def way_out_m(self, x_m: float, y_m: float, dx: float, dy: float) -> float:
        """How far a ray from (x, y) along the unit vector (dx, dy) runs inside the outline; 0 if it starts outside."""
        if self.distance_m(x_m, y_m) >= 0.0:
            return 0.0
        return float(min((c - nx * x_m - ny * y_m) / (nx * dx + ny * dy) for nx, ny, c in self.planes.tolist() if nx * dx + ny * dy > 1e-9))


def outline_of(corners_m: Sequence[Point]) -> Outline:
    """The outline of a platform. A hollow outline counts as filled: the chain would rather keep too far than too near."""
    hull = _convex_hull(corners_m)
    planes = []
    for (x0, y0), (x1, y1) in zip(hull, hull[1:] + hull[:1], strict=True):
        length_m = math.hypot(x1 - x0, y1 - y0)
        nx, ny = (y1 - y0) / length_m, -(x1 - x0) / length_m
        planes.append((nx, ny, nx * x0 + ny * y0))
    xs, ys = [x for x, _ in hull], [y for _, y in hull]
    return Outline(np.array(planes), max(xs), -min(xs), max(max(ys), -min(ys)), max(math.hypot(x, y) for x, y in hull))


def _convex_hull(points: Sequence[Point]) -> list[Point]:
    """Counter-clockwise hull by the monotone chain; collinear points are dropped."""
    ordered = sorted(set(points))

    def half(run: Sequence[Point]) -> list[Point]:
        chain: list[Point] = []
        for x, y in run:
            while len(chain) >= 2 and _turn(chain[-2], chain[-1], (x, y)) <= 1e-12:
                chain.pop()
            chain.append((x, y))
        return chain[:-1]

    return half(ordered) + half(ordered[::-1])


def _turn(a: Point, b: Point, c: Point) -> float:
    """Positive if a, b, c turn left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
