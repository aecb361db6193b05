"""The rectangle that motion never leaves (Pluto manual, 6.3; DESIGN.md, section 9)."""

from __future__ import annotations

import math
from typing import NamedTuple

from pluto_bt.skills.outline import Planar

ON_THE_EDGE_M = 0.3  # a pose is not known better: so near the edge still counts as inside for a start or a goal


class Rectangle(NamedTuple):
    """x' in [0, height], y' in [-base, base] in the frame of home: home is the middle of the base (2 * base_m long) and looks into it.

    `doubt_m` is how far the robot may by now be from where it believes to be in this frame; ways keep so much farther inside.
    """

    base_m: float
    height_m: float
    home: Planar
    doubt_m: float = 0.0

    def inward(self, x_m: float, y_m: float) -> tuple[float, float]:
        """(x', y') of a point."""
        dx, dy = x_m - self.home[0], y_m - self.home[1]
        c, s = math.cos(self.home[2]), math.sin(self.home[2])
        return c * dx + s * dy, c * dy - s * dx

    def depth_m(self, x_m: float, y_m: float) -> float:
        """How far inside the nearest side a point is; negative outside."""
        x, y = self.inward(x_m, y_m)
        return min(x, self.height_m - x, self.base_m - abs(y))

    def holds(self, x_m: float, y_m: float) -> bool:
        """True inside, and on the edge as well as a pose can tell."""
        return self.depth_m(x_m, y_m) >= -ON_THE_EDGE_M

    def inside(self, x_m: float, y_m: float, depth_m: float) -> tuple[float, float]:
        """The point nearest to a point that lies `depth_m` inside, or in the middle where the rectangle is narrower."""
        x, y = self.inward(x_m, y_m)
        deep_x, deep_y = min(depth_m, 0.5 * self.height_m), min(depth_m, self.base_m)
        x, y = min(max(x, deep_x), self.height_m - deep_x), min(max(y, deep_y - self.base_m), self.base_m - deep_y)
        c, s = math.cos(self.home[2]), math.sin(self.home[2])
        return self.home[0] + c * x - s * y, self.home[1] + s * x + c * y
