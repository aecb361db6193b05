"""What the web console draws of a run and what never changes in it: the a-priori map, and the robot's body and senses. SI, radians, map frame."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from typing import Any

import msgspec
import numpy as np

from pluto_bt.blackboard import TOPICS
from pluto_bt.gateway.wire import Scenery
from pluto_bt.maps.platform import Platform
from pluto_bt.maps.world import Goal, OccupancyGrid, Points, World

GRID = "grid.png"
MOST_CELLS = 4096
PALETTE = ((0, 0, 0, 0), (142, 156, 171, 255), (58, 66, 76, 150))
"""Red, green, blue and opacity of what is free, occupied, unknown, on the console's dark ground."""


def scenery(world: World, platform: Platform, robot: str, **more: Any) -> Scenery:
    """The scenery of a robot on a map; `more` goes to the page as it is."""
    shown: dict[str, Any] = {
        "robot": {"name": robot, **_body(platform)},
        "world": _map(world),
        "stale_after_s": {topic.name: topic.stale_after_s for topic in TOPICS},
        **more,
    }
    if world.grid is None:
        return Scenery(msgspec.json.encode(shown))
    grid = coarse(world.grid)
    shown["grid"] = _frame(grid)
    return Scenery(msgspec.json.encode(shown), {GRID: picture(grid)})


def coarse(grid: OccupancyGrid, most_cells: int = MOST_CELLS) -> OccupancyGrid:
    """The grid with at most so many cells a side, as browsers can draw it. A cell is occupied if a part of it is, unknown if all of it is."""
    n = -(-max(grid.occupied.shape) // most_cells)
    if n <= 1:
        return grid
    rows, columns = (np.arange(0, size, n) for size in grid.occupied.shape)
    occupied = np.maximum.reduceat(np.maximum.reduceat(grid.occupied, rows, axis=0), columns, axis=1)
    unknown = np.minimum.reduceat(np.minimum.reduceat(grid.unknown, rows, axis=0), columns, axis=1)
    return OccupancyGrid(occupied, unknown, n * grid.resolution_m, grid.origin)


def picture(grid: OccupancyGrid) -> bytes:
    """The grid as a PNG, the highest y on top."""
    from PIL import Image

    cells = np.where(grid.occupied > 0, 1, np.where(grid.unknown > 0, 2, 0)).astype(np.uint8)[::-1]
    image = Image.fromarray(np.ascontiguousarray(cells), mode="P")
    image.putpalette([level for colour in PALETTE for level in colour[:3]])
    file = io.BytesIO()
    image.save(file, "PNG", transparency=bytes(colour[3] for colour in PALETTE))
    return file.getvalue()


def _frame(grid: OccupancyGrid) -> Mapping[str, Any]:
    rows, columns = grid.occupied.shape
    return {"picture": GRID, "rows": rows, "columns": columns, "cell_m": grid.resolution_m, "origin": grid.origin}


def _map(world: World) -> Mapping[str, Any]:
    """Things that are there from the beginning; who walks about, and what comes later, is for the sensors."""
    return {
        "name": world.name,
        "bounds_m": world.bounds_m(),
        "shapes": [{"id": s.id, "kind": s.kind, "points": _points(s.points), "radius_m": s.radius_m} for s in world.shapes if not s.absent],
        "areas": [{"id": a.id, "kind": a.kind, "points": _points(a.points)} for a in world.areas],
        "lines": [{"id": line.id, "kind": line.kind, "points": _points(line.points)} for line in world.lines],
        "goals": [_goal(goal) for goal in world.goals],
        "home": None if world.home is None else _goal(world.home),
        "markers": [{"id": m.id, "x": m.x_m, "y": m.y_m} for m in world.markers],
    }


def _goal(goal: Goal) -> Mapping[str, Any]:
    return {"id": goal.id, "x": goal.x_m, "y": goal.y_m, "theta": goal.theta_rad}


def _points(points: Points) -> Any:
    return np.round(points, 3).tolist()


def _body(platform: Platform) -> Mapping[str, Any]:
    devices, limits = platform.devices, platform.limits
    sonar = devices.sonar
    return {
        "platform": platform.name,
        "turns_on_the_spot": platform.body.kinematics != "ackermann",
        "outline_m": platform.body.outline_m,
        "max_speed_mps": limits.max_speed_mps,
        "max_turn_radps": math.radians(limits.max_turn_rate_dps),
        "battery_v": [devices.battery.empty_v, devices.battery.full_v],
        "laser_max_m": None if devices.laser is None else devices.laser.max_range_m,
        "sonars": [] if sonar is None else [[t.x_m, t.y_m, math.radians(t.theta_deg)] for t in sonar.transducers],
        "sonar_max_m": 0.0 if sonar is None else sonar.max_range_m,
        "sonar_cone_rad": 0.0 if sonar is None else math.radians(sonar.cone_deg),
    }
