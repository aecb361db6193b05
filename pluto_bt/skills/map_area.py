"""The mapped area of a world: areas of kind `map`, taken together. Is a straight line inside?"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import TYPE_CHECKING

from pluto_bt.maps.world import World

if TYPE_CHECKING:
    from shapely import Polygon

Corner = tuple[float, float]
EDGE_M = 1e-9  # a point this near to an edge is inside


class MapArea:
    """The union of polygons. Without any polygon everything is inside: nothing is known of a limit.

    Attributes:
        is_everything: no limit is known.
    """

    def __init__(self, polygons: Iterable[tuple[Corner, ...]]) -> None:
        self._polygons = tuple(polygons)
        self.is_everything = not self._polygons
        self._edges = tuple((a, b) for polygon in self._polygons for a, b in zip(polygon, (*polygon[1:], polygon[0]), strict=True))

    @classmethod
    def of(cls, world: World | None) -> MapArea:
        """The mapped area of a world, or everything where there is none."""
        areas = () if world is None else world.areas
        return cls(tuple((float(x), float(y)) for x, y in area.points) for area in areas if area.kind == "map")

    def shrunk(self, margin_m: float) -> MapArea:
        """What is left of it at least `margin_m` from its edge, which may be nothing at all; itself for 0."""
        if self.is_everything or margin_m == 0.0:
            return self
        from shapely import Polygon, union_all

        whole = union_all([Polygon(polygon).buffer(0.0) for polygon in self._polygons])
        left = whole.buffer(-margin_m, join_style="mitre")
        small = MapArea(_as_one_ring(part) for part in getattr(left, "geoms", [left]) if not part.is_empty)
        small.is_everything = False
        return small

    def has_point(self, x: float, y: float) -> bool:
        """True inside one of the polygons or on its edge."""
        return self.is_everything or any(_is_on(x, y, *edge) for edge in self._edges) or any(_is_in(x, y, p) for p in self._polygons)

    def has_line(self, x0: float, y0: float, x1: float, y1: float) -> bool:
        """True if every point of the line is inside: its ends, and the middles between all its crossings with edges."""
        if not (self.has_point(x0, y0) and self.has_point(x1, y1)):
            return False
        if (x0, y0) == (x1, y1) or self.is_everything:
            return True
        shares = sorted({0.0, 1.0, *(share for edge in self._edges for share in _crossings(x0, y0, x1, y1, *edge))})
        middles = ((a + b) / 2.0 for a, b in pairwise(shares))
        return all(self.has_point(x0 + s * (x1 - x0), y0 + s * (y1 - y0)) for s in middles)


def _as_one_ring(polygon: Polygon) -> tuple[Corner, ...]:
    """A polygon with its holes as one ring: a cut goes to each hole and back, which the even-odd rule does not see."""
    rings = [[(float(x), float(y)) for x, y in ring.coords] for ring in (polygon.exterior, *polygon.interiors)]
    return tuple(corner for ring in rings for corner in (*ring, *rings[0][:1]))


def _is_in(x: float, y: float, polygon: tuple[Corner, ...]) -> bool:
    """Even-odd rule."""
    inside = False
    for (ax, ay), (bx, by) in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            inside = not inside
    return inside


def _is_on(x: float, y: float, a: Corner, b: Corner) -> bool:
    """True within EDGE_M of the segment from a to b."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length2 = dx * dx + dy * dy
    share = 0.0 if length2 == 0.0 else min(1.0, max(0.0, ((x - a[0]) * dx + (y - a[1]) * dy) / length2))
    ex, ey = x - a[0] - share * dx, y - a[1] - share * dy
    return ex * ex + ey * ey <= EDGE_M * EDGE_M


def _crossings(x0: float, y0: float, x1: float, y1: float, a: Corner, b: Corner) -> tuple[float, ...]:
    """Where (0 … 1) the line meets the edge from a to b; both ends of an edge that lies along it."""
    dx, dy, ex, ey = x1 - x0, y1 - y0, b[0] - a[0], b[1] - a[1]
    cross = dx * ey - dy * ex
    if abs(cross) > 1e-12:
        along = ((a[0] - x0) * ey - (a[1] - y0) * ex) / cross
        across = ((a[0] - x0) * dy - (a[1] - y0) * dx) / cross
        return (along,) if 0.0 < along < 1.0 and -1e-12 <= across <= 1.0 + 1e-12 else ()
    length2 = dx * dx + dy * dy
    shares = (((p[0] - x0) * dx + (p[1] - y0) * dy) / length2 for p in (a, b))
    return tuple(share for share in shares if 0.0 < share < 1.0)
