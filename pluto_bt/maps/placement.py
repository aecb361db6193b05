"""Is there room for the robot here? Plain numpy, so that a start inside a wall is refused before anything heavy is imported."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.world import OccupancyGrid, Shape, World

Points = NDArray[np.float64]


def placed_outline(outline_m: Points, pose: tuple[float, float, float]) -> Points:
    """The outline (n, 2) in the map frame for a robot at pose (x m, y m, theta rad)."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    return np.asarray(outline_m @ np.array([[cos, sin], [-sin, cos]]) + np.array(pose[:2]))


def what_stands_at(world: World, outline_m: Points) -> str:
    """The id of the first solid thing, hole or actor that overlaps the outline (n, 2) in the map frame, or "" if the place is free."""
    for shape in _near([shape for shape in world.shapes if not shape.absent], outline_m):
        if _overlaps(shape, outline_m):
            return shape.id or shape.kind
    for actor in world.actors:
        if not actor.absent and _in_circle(outline_m, actor.waypoints[:1], actor.radius_m):
            return actor.id
    if world.grid is not None and _covers_occupied_cell(world.grid, outline_m):
        return "the map"
    return ""


def _near(shapes: Sequence[Shape], outline_m: Points) -> Iterator[Shape]:
    """The shapes whose box meets that of the outline; a world may have 50 000, so their boxes are compared all at once."""
    if not shapes:
        return
    starts = np.cumsum([0, *(len(shape.points) for shape in shapes[:-1])])
    points, reach_m = np.concatenate([shape.points for shape in shapes]), np.array([[shape.radius_m] for shape in shapes])
    low, high = np.minimum.reduceat(points, starts, axis=0) - reach_m, np.maximum.reduceat(points, starts, axis=0) + reach_m
    meets = np.all((low <= outline_m.max(axis=0)) & (high >= outline_m.min(axis=0)), axis=1)
    for i in np.flatnonzero(meets):
        yield shapes[int(i)]


def _overlaps(shape: Shape, outline_m: Points) -> bool:
    if shape.kind == "circle":
        return _in_circle(outline_m, shape.points[:1], shape.radius_m)
    closed = shape.kind in ("polygon", "hole")
    if _edges_cross(_edges(shape.points, closed), _edges(outline_m, True)):
        return True
    return bool(_inside(outline_m, shape.points[:1])[0] or (closed and _inside(shape.points, outline_m[:1])[0]))


def _in_circle(outline_m: Points, centre_m: Points, radius_m: float) -> bool:
    return bool(_distance_to_edges(outline_m, centre_m)[0] < radius_m or _inside(outline_m, centre_m)[0])


def _edges(points: Points, closed: bool) -> Points:
    """(n, 4) x1 y1 x2 y2."""
    ends = np.roll(points, -1, axis=0)
    edges = np.hstack([points, ends])
    return edges if closed else edges[:-1]


def _edges_cross(a: Points, b: Points) -> bool:
    """True if any edge of a crosses or touches any edge of b."""
    p, r = a[:, None, :2], a[:, None, 2:] - a[:, None, :2]
    q, s = b[None, :, :2], b[None, :, 2:] - b[None, :, :2]
    cross = r[..., 0] * s[..., 1] - r[..., 1] * s[..., 0]
    gap = q - p
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (gap[..., 0] * s[..., 1] - gap[..., 1] * s[..., 0]) / cross
        u = (gap[..., 0] * r[..., 1] - gap[..., 1] * r[..., 0]) / cross
    return bool(np.any((cross != 0) & (t >= 0) & (t <= 1) & (u >= 0) & (u <= 1)))


def _inside(polygon: Points, points: Points) -> NDArray[np.bool_]:
    """For each point (m, 2) whether it lies inside the closed polygon (n, 2)."""
    x, y = points[:, None, 0], points[:, None, 1]
    edges = _edges(polygon, True)
    x1, y1, x2, y2 = edges.T
    spans = (y1 > y) != (y2 > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing_x = x1 + (y - y1) * (x2 - x1) / (y2 - y1)
    return np.asarray(np.sum(spans & (x < crossing_x), axis=1) % 2 == 1)


def _distance_to_edges(polygon: Points, points: Points) -> Points:
    """Distance of each point (m, 2) to the border of the closed polygon."""
    edges = _edges(polygon, True)
    start, along = edges[:, :2], edges[:, 2:] - edges[:, :2]
    to_point = points[:, None, :] - start[None]
    length2 = np.maximum(np.sum(along**2, axis=1), 1e-18)
    share = np.clip(np.sum(to_point * along, axis=2) / length2, 0.0, 1.0)
    return np.asarray(np.min(np.linalg.norm(to_point - share[..., None] * along, axis=2), axis=1))


def _covers_occupied_cell(grid: OccupancyGrid, outline_m: Points) -> bool:
    """True if an occupied cell's centre lies under the outline, or a corner of the outline in an occupied cell."""
    x0, y0, theta = grid.origin
    cos, sin = np.cos(theta), np.sin(theta)
    local = (outline_m - [x0, y0]) @ np.array([[cos, -sin], [sin, cos]]) / grid.resolution_m
    low = np.maximum(np.floor(local.min(axis=0)).astype(int), 0)
    rows, columns = grid.occupied.shape
    high = np.minimum(np.floor(local.max(axis=0)).astype(int) + 1, [columns, rows])
    if np.any(high <= low):
        return False
    window = grid.occupied[low[1] : high[1], low[0] : high[0]]
    row, column = np.nonzero(window)
    if row.size == 0:
        return False
    centres = np.column_stack([column + low[0] + 0.5, row + low[1] + 0.5])
    corners = np.floor(local).astype(int)
    is_corner = {(int(c[0]), int(c[1])) for c in corners}
    return bool(np.any(_inside(local, centres))) or any((int(c) + low[0], int(r) + low[1]) in is_corner for r, c in zip(row, column, strict=True))
