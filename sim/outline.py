"""The robot's outline as a polygon: where it is on the map, grown by a skin, cut into front and back."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


class Outline:
    """A counter-clockwise polygon in the robot frame, (n, 2) metres."""

    def __init__(self, corners_m: Points) -> None:
        self.corners_m = np.ascontiguousarray(corners_m, dtype=np.float64)
        self.radius_m = float(np.hypot(self.corners_m[:, 0], self.corners_m[:, 1]).max())
        self._corners: list[tuple[float, float]] = [(x, y) for x, y in self.corners_m.tolist()]

    def at(self, pose: tuple[float, float, float]) -> Points:
        """(n, 2) the corners in the map frame, for the robot at `pose`."""
        x0, y0, theta = pose
        c, s = math.cos(theta), math.sin(theta)
        return np.array([(x0 + c * x - s * y, y0 + s * x + c * y) for x, y in self._corners])

    def grown(self, skin_m: float) -> Outline:
        """The outline with every edge moved outwards by `skin_m` (mitred corners)."""
        points = self.corners_m
        edges = np.roll(points, -1, axis=0) - points
        edges = edges / np.hypot(edges[:, 0], edges[:, 1])[:, None]
        normals = np.column_stack([edges[:, 1], -edges[:, 0]])  # outward for a counter-clockwise polygon
        before = np.roll(normals, 1, axis=0)
        shift = (normals + before) / (1.0 + (normals * before).sum(axis=1))[:, None]
        return Outline(points + skin_m * shift)

    def half(self, front: bool) -> Outline | None:
        """The part with x >= 0 (front) or x <= 0 (back); None if nothing of the outline is there."""
        sign = 1.0 if front else -1.0
        kept: list[tuple[float, float]] = []
        for (x, y), (x_next, y_next) in zip(self._corners, self._corners[1:] + self._corners[:1], strict=True):
            if sign * x >= 0.0:
                kept.append((x, y))
            if (sign * x > 0.0 > sign * x_next) or (sign * x < 0.0 < sign * x_next):
                share = x / (x - x_next)
                kept.append((0.0, y + share * (y_next - y)))
        return Outline(np.array(kept)) if len(kept) >= 3 else None
