"""The parts of a world file while it is read, and the world they make together with the map that the file includes."""

from __future__ import annotations

from dataclasses import dataclass, field

from pluto_bt.maps.script import At, When
from pluto_bt.maps.world import Actor, Area, Goal, Line, Marker, RobotStart, Shadow, Shape, Terrain, World


@dataclass
class WorldParts:
    """What was read so far; `map` is the included one."""

    shapes: list[Shape] = field(default_factory=list)
    areas: list[Area] = field(default_factory=list)
    lines: list[Line] = field(default_factory=list)
    goals: list[Goal] = field(default_factory=list)
    markers: list[Marker] = field(default_factory=list)
    shadows: list[Shadow] = field(default_factory=list)
    actors: list[Actor] = field(default_factory=list)
    terrains: list[Terrain] = field(default_factory=list)
    home: Goal | None = None
    robot: RobotStart | None = None
    map: World | None = None
    script: list[At | When] = field(default_factory=list)

    def world(self, name: str, file: str, seed: int, path: str) -> World:
        """The whole; what the file says of home and robot goes before what its map says."""
        base = self.map or World(name="")
        return World(
            name=name, file=file, seed=seed, grid=base.grid, shapes=(*base.shapes, *self.shapes), areas=(*base.areas, *self.areas),
            lines=(*base.lines, *self.lines), goals=(*base.goals, *self.goals), home=self.home or base.home, markers=tuple(self.markers),
            shadows=tuple(self.shadows), actors=tuple(self.actors), terrains=tuple(self.terrains), robot=self.robot or base.robot,
            script=tuple(self.script), files=(path, *base.files),
        )  # fmt: skip
