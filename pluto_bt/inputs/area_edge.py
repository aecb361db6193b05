"""Does the edge of the mapped area lie too near to what stands? A robot without range sensors is held by that area alone, as a point."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pluto_bt.maps.world import Area, OccupancyGrid, Shape, World
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.source import Faults

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

OUT_OF_REACH_M = 1e-6  # of the outline's rim: touching is no overlap


def check_area_edge(world: World, robot: RobotFile, faults: Faults) -> None:
    """Warn of each mapped area from whose edge the robot's outline reaches something solid that it cannot see."""
    devices = robot.devices
    areas = [area for area in world.areas if area.kind == "map"]
    if not areas or devices.laser is not None or devices.sonar is not None:
        return
    from shapely import Polygon, union_all

    whole = union_all([Polygon(area.points).buffer(0.0) for area in areas]).buffer(-robot.filter.area_margin_m, join_style="mitre")
    reach_m = max(math.hypot(x, y) for x, y in robot.body.outline_m)
    for area in areas:
        near = _near(whole.intersection(Polygon(area.points).buffer(0.0)), world, reach_m)
        if near:
            _warn(area, near, reach_m, faults)


def _warn(area: Area, near: list[tuple[float, str]], reach_m: float, faults: Faults) -> None:
    distance_m, name = min(near)
    more = f", and so do {len(near) - 1} others" if len(near) > 1 else ""
    what = f'a robot in area "{area.id}" can touch "{name}"{more}: it sees nothing, and the area holds its middle alone'
    faults.warning(area.place, "area-near-wall", what, expected=f"{reach_m:.2f} m, as far as the outline reaches, from the area to what stands",
                   found=f"{distance_m:.2f} m", mend=f"draw the area smaller, or set filter.area_margin_m to {reach_m:.2f} or more")  # fmt: skip


def _near(region: BaseGeometry, world: World, reach_m: float) -> list[tuple[float, str]]:
    """(distance m, name) of what stands nearer to where the middle may be than the outline reaches."""
    if region.is_empty:
        return []
    found = [(float(region.distance(_as_geometry(shape))), shape.id or shape.kind) for shape in world.shapes if not shape.absent]
    if world.grid is not None:
        found.append((_grid_distance_m(region, world.grid, reach_m), "the map"))
    return [one for one in found if one[0] < reach_m - OUT_OF_REACH_M]


def _as_geometry(shape: Shape) -> BaseGeometry:
    from shapely import LineString, Point, Polygon

    if shape.kind == "circle":
        return Point(shape.points[0]).buffer(shape.radius_m)
    return LineString(shape.points) if shape.kind == "wall" else Polygon(shape.points).buffer(0.0)


def _grid_distance_m(region: BaseGeometry, grid: OccupancyGrid, reach_m: float) -> float:
    """To the nearest occupied cell, infinite beyond `reach_m`; a cell counts as its inner circle."""
    import shapely

    rows, columns = np.nonzero(grid.occupied)
    along, across = (columns + 0.5) * grid.resolution_m, (rows + 0.5) * grid.resolution_m
    x, y, theta = grid.origin
    points = np.column_stack([x + along * math.cos(theta) - across * math.sin(theta), y + along * math.sin(theta) + across * math.cos(theta)])
    zone = region.buffer(reach_m + 0.5 * grid.resolution_m)
    shapely.prepare(zone)
    near = points[shapely.contains_xy(zone, points)]
    return max(0.0, float(shapely.distance(region, shapely.points(near)).min()) - 0.5 * grid.resolution_m) if len(near) else math.inf
