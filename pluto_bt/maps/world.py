"""A world as data: what stands where, what moves; what happens is script.py. Metres and radians, map frame. Read by `load_world` from three formats.

DESIGN.md, section 5, is the contract of the XML form. Every item keeps its `place` in the file for later checks.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.script import At, When
from pluto_bt.source.faults import NOWHERE, Place

Points = NDArray[np.float64]  # (n, 2) metres, map frame, read-only


@dataclass(frozen=True, slots=True)
class OccupancyGrid:
    """A static map of cells. Row 0 is the lowest y (image rows are turned over on reading).

    Attributes:
        occupied: (rows, columns) uint8, 1 = obstacle. Unknown cells are free for collisions and rays, and marked in `unknown`.
        unknown: (rows, columns) uint8, 1 = the map does not say.
        resolution_m: side of a cell.
        origin: x m, y m, theta rad of the lower left corner of cell (0, 0) in the map frame.
    """

    occupied: NDArray[np.uint8]
    unknown: NDArray[np.uint8]
    resolution_m: float
    origin: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Shape:
    """A wall (open polyline), polygon (closed), circle (one point and a radius) or hole (polygon in the ground)."""

    id: str
    kind: Literal["wall", "polygon", "circle", "hole"]
    points: Points
    radius_m: float = 0.0
    height_m: float = 2.0
    absent: bool = False
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class Area:
    """A polygon of the map with a meaning; for `one-way` and `restrictive` the ARNL attributes that go with it."""

    id: str
    kind: Literal["named", "map", "forbidden", "restrictive", "one-way", "sector"]
    points: Points
    theta_rad: float = 0.0
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class Line:
    """A forbidden or restrictive line."""

    id: str
    kind: Literal["forbidden", "restrictive"]
    points: Points
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class Goal:
    """A named place; `theta_rad` None = any heading."""

    id: str
    x_m: float
    y_m: float
    theta_rad: float | None = None
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class Marker:
    """A camera marker on the ceiling."""

    id: int
    x_m: float
    y_m: float
    theta_rad: float
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class Shadow:
    """Where a sensor does not work (gps, marker) or lies (compass)."""

    sensor: Literal["gps", "marker", "compass"]
    points: Points
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class Actor:
    """A disc that walks its waypoints at constant speed and yields to nobody."""

    id: str
    radius_m: float
    speed_mps: float
    loop: bool
    waypoints: Points
    height_m: float = 1.8
    absent: bool = False
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class Terrain:
    """Ground that slips, tilts or is magnetic. `slip` 0 … 1: the share of wheel motion that is lost.

    `slip_back`: the same while driving backwards, where it is another (None: it is not): who sits on a trunk gets off the way he came.
    """

    id: str
    points: Points
    slip: float = 0.0
    roll_rad: float = 0.0
    pitch_rad: float = 0.0
    magnetic_rad: float = 0.0
    place: Place = NOWHERE
    slip_back: float | None = None


@dataclass(frozen=True, slots=True)
class RobotStart:
    """Where the robot starts and what it is; pose None = not said by the file."""

    name: str = "robot"
    platform: str = ""
    pose: tuple[float, float, float] | None = None
    ideal: bool = False
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class World:
    """Everything a world file says; `files` are the paths of all that was read for it, itself first."""

    name: str
    file: str = ""
    seed: int = 0
    grid: OccupancyGrid | None = None
    shapes: tuple[Shape, ...] = ()
    areas: tuple[Area, ...] = ()
    lines: tuple[Line, ...] = ()
    goals: tuple[Goal, ...] = ()
    home: Goal | None = None
    markers: tuple[Marker, ...] = ()
    shadows: tuple[Shadow, ...] = ()
    actors: tuple[Actor, ...] = ()
    terrains: tuple[Terrain, ...] = ()
    robot: RobotStart = field(default_factory=RobotStart)
    script: tuple[At | When, ...] = ()
    files: tuple[str, ...] = field(default=(), compare=False, repr=False)

    def bounds_m(self) -> tuple[float, float, float, float]:
        """(x_min, y_min, x_max, y_max) of everything drawn, for pictures and acceleration structures."""
        corners = [shape.points - shape.radius_m for shape in self.shapes] + [shape.points + shape.radius_m for shape in self.shapes]
        corners += [area.points for area in self.areas] + [actor.waypoints for actor in self.actors] + [terrain.points for terrain in self.terrains]
        corners += [np.array([[goal.x_m, goal.y_m]]) for goal in self.goals]
        if self.robot.pose is not None:
            corners.append(np.array([self.robot.pose[:2]]))
        if self.grid is not None:
            rows, columns = self.grid.occupied.shape
            x, y, theta = self.grid.origin
            box = np.array([[0, 0], [columns, 0], [columns, rows], [0, rows]]) * self.grid.resolution_m
            turn = np.array([[np.cos(theta), np.sin(theta)], [-np.sin(theta), np.cos(theta)]])
            corners.append(box @ turn + [x, y])
        if not corners:
            return (-1.0, -1.0, 1.0, 1.0)
        points = np.vstack(corners)
        low, high = points.min(axis=0), points.max(axis=0)
        return (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
