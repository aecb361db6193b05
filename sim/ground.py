"""The ground under the robot: slip, slope and magnetism by terrain, and where a sensor is in shadow."""

from __future__ import annotations

import math

from pluto_bt.maps.world import World
from sim.regions import Regions


class Ground:
    """Terrain and shadows of a world. Where terrains overlap, the last one in the file is on top; magnetism adds up."""

    def __init__(self, world: World) -> None:
        self._terrains = world.terrains
        self._regions = Regions([terrain.points for terrain in world.terrains])
        sensors = ("gps", "marker", "compass")
        self._shadows = {sensor: Regions([s.points for s in world.shadows if s.sensor == sensor]) for sensor in sensors}

    def slip(self, x_m: float, y_m: float, backwards: bool = False) -> float:
        """The share of wheel motion that is lost, 0 … 1."""
        inside = self._regions.at(x_m, y_m)
        if not inside:
            return 0.0
        terrain = self._terrains[inside[-1]]
        return terrain.slip if terrain.slip_back is None or not backwards else terrain.slip_back

    def magnetic_rad(self, x_m: float, y_m: float) -> float:
        """How far iron in the ground turns a compass needle."""
        return sum(self._terrains[i].magnetic_rad for i in self._regions.at(x_m, y_m))

    def tilt_rad(self, x_m: float, y_m: float, theta_rad: float) -> tuple[float, float]:
        """(phi, psi): rotation about the robot's y, then x axis. A terrain is a plane turned by its pitch about the map's y axis, then its
        roll about x; so for a robot with theta 0 phi is the pitch and psi the roll, and after a half turn both change their sign."""
        inside = self._regions.at(x_m, y_m)
        if not inside:
            return 0.0, 0.0
        terrain = self._terrains[inside[-1]]
        up_x, up_y = math.sin(terrain.pitch_rad) * math.cos(terrain.roll_rad), -math.sin(terrain.roll_rad)
        up_z = math.cos(terrain.pitch_rad) * math.cos(terrain.roll_rad)
        c, s = math.cos(theta_rad), math.sin(theta_rad)
        return math.atan2(c * up_x + s * up_y, up_z), -math.asin(min(1.0, max(-1.0, c * up_y - s * up_x)))

    def shadows(self, sensor: str, x_m: float, y_m: float) -> tuple[int, ...]:
        """Indices of the shadows of this sensor (in the order of the file) that lie on the point."""
        return self._shadows[sensor].at(x_m, y_m)
