"""What stands and walks around the robot at the present moment: the scene, with the actors where they are now."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.geometry import Pose
from pluto_bt.maps.scene import Nearest, Scene
from pluto_bt.maps.world import World
from sim.actors import Walker, fastest_mps
from sim.simtime import SimTime

Array = NDArray[np.float64]


class Surroundings:
    """The scene as sensors and body meet it. Actors are brought to where they are only when somebody looks."""

    def __init__(self, world: World, time: SimTime) -> None:
        self._scene = Scene(world)
        self._time = time
        self._walkers = {actor.id: Walker(actor) for actor in world.actors}
        self._has_holes = any(shape.kind == "hole" for shape in world.shapes)
        self._actors_at_ns = -1
        self.fastest_mps = fastest_mps(self._walkers.values())

    def scan(self, pose_map_laser: Pose, z_m: float, tilt_rad: float, angles_rad: Array, max_range_m: float, out_m: Array) -> None:
        """`Scene.scan` now."""
        self._bring_actors()
        self._scene.scan(pose_map_laser, z_m, tilt_rad, angles_rad, max_range_m, out_m)

    def cones(self, x_m: Array, y_m: Array, theta_rad: Array, z_m: float, opening_rad: float, max_range_m: float, out_m: Array) -> None:
        """`Scene.cones` now."""
        self._bring_actors()
        self._scene.cones(x_m, y_m, theta_rad, z_m, opening_rad, max_range_m, out_m)

    def solid_gap_m(self, outline_m: Array) -> float:
        """Distance from the outline to everything solid; 0 in contact."""
        self._bring_actors()
        return self._scene.clearance(outline_m).distance_m

    def gap_m(self, outline_m: Array) -> float:
        """Distance from the outline to everything solid, and to the edge of a hole; 0 in contact, or reaching over a hole: that is contact too."""
        solid_m = self.solid_gap_m(outline_m)
        return min(solid_m, self._scene.hole(outline_m).distance_m) if self._has_holes else solid_m

    def contacts(self, outline_m: Array) -> list[Nearest]:
        """Everything solid that the outline overlaps, and a hole that it reaches over."""
        self._bring_actors()
        found = self._scene.contacts(outline_m)
        if self._has_holes and (hole := self._scene.hole(outline_m)).distance_m <= 0.0:
            found.append(hole)
        return found

    def actors(self) -> dict[str, tuple[float, float, float]]:
        """Those present: id → (x m, y m, radius m)."""
        now_s = self._time.now_s
        return {id: (*walker.position_at(now_s), walker.radius_m) for id, walker in self._walkers.items() if walker.present}

    def remove(self, id: str) -> None:
        """Take a shape or an actor away."""
        if walker := self._walkers.get(id):
            walker.take_away()
            self._scene.show_disc(id, False)
            self.fastest_mps = fastest_mps(self._walkers.values())
        else:
            self._scene.remove(id)

    def place(self, id: str, x_m: float | None, y_m: float | None) -> None:
        """Move the centre of a shape or actor here and make it present; None = where the file drew it."""
        if walker := self._walkers.get(id):
            walker.put(x_m, y_m, self._time.now_s)
            self._scene.show_disc(id, True)
            self.fastest_mps = fastest_mps(self._walkers.values())
            self._actors_at_ns = -1
            return
        self._scene.place(id, x_m, y_m)

    def _bring_actors(self) -> None:
        """Move the discs of the scene to where the actors are now."""
        now_ns = self._time.now_ns
        if self._actors_at_ns == now_ns or not self._walkers:
            return
        self._actors_at_ns = now_ns
        for id, walker in self._walkers.items():
            if walker.present:
                self._scene.move_disc(id, *walker.position_at(self._time.now_s))
