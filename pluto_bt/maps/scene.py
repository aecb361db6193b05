"""What can be seen and hit: the world as it stands now.

A scene has the static map (owner "map"), the shapes of the world that are present, and the actors as discs that move.
Everything solid stands on the ground and ends at its height; solid means solid: a beam that starts inside has range 0, and one that
comes down from above lands on the top. Walls and outlines have no thickness. A scene serves one thread at a time.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pluto_bt.maps.clearance_kernels import nearest_hole, nearest_solid, touching_solids
from pluto_bt.maps.cones import APEX_X, APEX_Y, AXIS_RAD, NEAREST, cones_nearest
from pluto_bt.maps.fan import fan_of
from pluto_bt.maps.geometry import Pose
from pluto_bt.maps.scan import scan_solids
from pluto_bt.maps.solids import DISC_RADIUS, DISC_X, DISC_Y, grid_tables, solids_of, table_of
from pluto_bt.maps.world import Points, World

Array = NDArray[np.float64]

MAP = "map"  # the owner of the cells of the static map
WIDEST_CONE_RAD = math.pi / 2


class Nearest(NamedTuple):
    """The point of a solid thing that is nearest to the robot's outline: distance 0 = in contact; inf and owner "" = nothing there."""

    distance_m: float
    x_m: float
    y_m: float
    owner: str


NOTHING = Nearest(math.inf, math.nan, math.nan, "")


class Scene:
    """Static map and shapes of a world, plus moving discs. Changed only by the first four calls; all others are questions."""

    def __init__(self, world: World) -> None:
        self.owners = (MAP, *(shape.id for shape in world.shapes), *(actor.id for actor in world.actors))
        self._shapes = {shape.id: (owner, shape) for owner, shape in enumerate(world.shapes, start=1)}
        self._stands: dict[str, Points] = {shape.id: shape.points for shape in world.shapes if not shape.absent}
        self._actors = {actor.id: (i, actor) for i, actor in enumerate(world.actors)}
        first = len(world.shapes) + 1
        rows = [(*actor.waypoints[0], -1.0 if actor.absent else actor.radius_m, actor.height_m, first + i) for i, actor in enumerate(world.actors)]
        self._moving = table_of(rows, 5)
        self._free, self._frame = grid_tables(world.grid)
        self._angles = np.zeros(0)
        self._fan, self._ranges = fan_of(self._angles), np.zeros(0)
        self._cone_table = np.zeros((6, 0))
        self._outline = self._cells = np.zeros((0, 2))
        self._found = np.zeros((len(self.owners), 4))
        self._arrange()
        self._scan, self._cones = scan_solids.compiled(), cones_nearest.compiled()
        self._nearest, self._touching, self._nearest_hole = nearest_solid.compiled(), touching_solids.compiled(), nearest_hole.compiled()

    # what changes it

    def remove(self, id: str) -> None:
        """Take a shape or an actor away.

        Raises: KeyError if the world has neither of this id.
        """
        if id in self._actors:
            self.show_disc(id, False)
            return
        _ = self._shapes[id]
        if self._stands.pop(id, None) is not None:
            self._arrange()

    def place(self, id: str, x_m: float | None, y_m: float | None) -> None:
        """Put a shape's centre (the middle of its box), or an actor, at a point and make it present; None = where the file drew it.

        Raises: KeyError if the world has neither of this id.
        """
        if id in self._actors:
            start = self._actors[id][1].waypoints[0]
            self.move_disc(id, float(start[0]) if x_m is None else x_m, float(start[1]) if y_m is None else y_m)
            self.show_disc(id, True)
            return
        points = self._shapes[id][1].points
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        offset = (0.0 if x_m is None else x_m - middle[0], 0.0 if y_m is None else y_m - middle[1])
        self._stands[id] = points + offset
        self._arrange()

    def move_disc(self, id: str, x_m: float, y_m: float) -> None:
        """Move an actor's centre."""
        row = self._discs[self._actors[id][0]]
        row[DISC_X] = x_m
        row[DISC_Y] = y_m

    def show_disc(self, id: str, present: bool) -> None:
        """Make an actor present, or take it away."""
        i, actor = self._actors[id]
        self._discs[i, DISC_RADIUS] = actor.radius_m if present else -1.0

    # what it answers

    def scan(self, pose_map_laser: Pose, z_m: float, tilt_rad: float, angles_rad: Array, max_range_m: float, out_m: Array) -> None:
        """Exact ranges of a plane of laser beams.

        Args:
            pose_map_laser: x m, y m, yaw rad of the laser; yaw includes the wrist's pan.
            z_m: height of the laser above the ground.
            tilt_rad: the plane is turned by this about the laser's lateral axis; > 0 looks down.
            angles_rad: (n,) directions of the beams in the plane, 0 = forward. Give the same read-only array each time: it is then
                known by identity. Equally spaced rising angles are fast, others are served too.
            max_range_m: the range of beams that return nothing.
            out_m: (n,) is filled. A thing is met where the beam is not higher than it; the ground is met by beams that go down, but
                for holes: there the sides and the floor, 1 m down, are met. 0 from inside something solid.
        Raises: ValueError for numbers that are not finite, a height below the ground, or lengths that do not fit.
        """
        x_m, y_m, yaw_rad = pose_map_laser
        if not math.isfinite(x_m + y_m + yaw_rad + tilt_rad) or not z_m >= 0.0 or not max_range_m >= 0.0 or len(out_m) != len(angles_rad):
            raise ValueError(f"no scan from {pose_map_laser} at {z_m} m, tilted {tilt_rad} rad, {len(angles_rad)} beams into {len(out_m)} ranges")
        if angles_rad is not self._angles or angles_rad.flags.writeable:
            self._take_angles(angles_rad)
        self._scan(
            x_m, y_m, yaw_rad, z_m, tilt_rad, max_range_m, self._fan, self._ranges,
            self._segments, self._blocks, self._rings, self._discs, self._free, self._frame,
        )  # fmt: skip
        out_m[:] = self._ranges  # the kernels are compiled for one kind of array, whatever the caller's is

    def cones(
        self, x_m: ArrayLike, y_m: ArrayLike, theta_rad: ArrayLike, z_m: float, opening_rad: float, max_range_m: float, out_m: Array
    ) -> None:
        """Exact distance to the nearest surface within each of k level cones, as sonars measure.

        Args:
            x_m, y_m, theta_rad: (k,) apexes and axes, map frame.
            z_m: height of the cones; what is lower is not seen.
            opening_rad: full opening, up to a quarter turn.
            max_range_m: the range of cones that return nothing.
            out_m: (k,) is filled. 0 from inside something solid.
        Raises: ValueError for numbers that are not finite or an opening that is not within (0, pi/2].
        """
        if self._cone_table.shape[1] != len(out_m):
            self._cone_table = np.zeros((6, len(out_m)))
        table = self._cone_table
        table[APEX_X], table[APEX_Y], table[AXIS_RAD] = x_m, y_m, theta_rad
        if not math.isfinite(table[:3].sum()) or not 0.0 < opening_rad <= WIDEST_CONE_RAD or not z_m >= 0.0 or not max_range_m >= 0.0:
            raise ValueError(f"no cones of {opening_rad} rad at {z_m} m from {table[:3].T.tolist()}")
        self._cones(
            table, z_m, opening_rad / 2.0, max_range_m,
            self._segments, self._blocks, self._rings, self._discs, self._free, self._frame,
        )  # fmt: skip
        out_m[:] = table[NEAREST]

    def clearance(self, outline_m: ArrayLike) -> Nearest:
        """The solid thing nearest to the robot's outline, (n, 2) corners in the map frame; distance 0 = they share a point.

        Raises: ValueError for fewer than three corners or numbers that are not finite.
        """
        return (self._answers(self._nearest, outline_m) or [NOTHING])[0]

    def contacts(self, outline_m: ArrayLike) -> list[Nearest]:
        """Everything that shares a point with the outline, one entry each, with a point in both.

        Raises: ValueError as `clearance`.
        """
        return self._answers(self._touching, outline_m)

    def hole(self, outline_m: ArrayLike) -> Nearest:
        """The nearest hole, and the point of its edge: distance 0 if the outline reaches over it. It is nothing solid: `clearance` does not see it.

        Raises: ValueError as `clearance`.
        """
        outline = self._take_outline(outline_m)
        return (self._told(outline, self._nearest_hole(outline, self._segments, self._rings, self._found)) or [NOTHING])[0]

    # tables

    def _arrange(self) -> None:
        """Rebuild the tables of the shapes that are present; actors come first among the discs."""
        solids = solids_of((*self._shapes[id], points) for id, points in self._in_order())
        self._segments, self._blocks, self._rings = solids.segments, solids.blocks, solids.rings
        self._discs = np.vstack((self._moving, solids.discs))
        self._moving = self._discs[: len(self._actors)]

    def _in_order(self) -> list[tuple[str, Points]]:
        return [(id, self._stands[id]) for id in self._shapes if id in self._stands]

    def _take_angles(self, angles_rad: Array) -> None:
        if not np.array_equal(angles_rad, self._angles):
            self._fan, self._ranges = fan_of(angles_rad), np.zeros(len(angles_rad))
        self._angles = angles_rad if not angles_rad.flags.writeable else angles_rad.copy()

    def _answers(self, question: Callable[..., int], outline_m: ArrayLike) -> list[Nearest]:
        """What a kernel finds around an outline."""
        outline = self._take_outline(outline_m)
        count = question(outline, self._segments, self._blocks, self._rings, self._discs, self._free, self._frame, self._cells, self._found)
        return self._told(outline, count)

    def _told(self, outline: Array, count: int) -> list[Nearest]:
        """The first rows of what was found."""
        if count < 0:
            raise ValueError(f"the corners of an outline are finite, not {outline.tolist()}")
        return [Nearest(distance_m, x_m, y_m, self.owners[int(owner)]) for distance_m, x_m, y_m, owner in self._found[:count].tolist()]

    def _take_outline(self, outline_m: ArrayLike) -> Array:
        """The outline in an array of our own, whatever kind the caller's is: the kernels are compiled for one kind."""
        corners = np.asarray(outline_m, dtype=np.float64)
        if self._outline.shape != corners.shape:
            if corners.ndim != 2 or len(corners) < 3 or corners.shape[1] != 2:
                raise ValueError(f"an outline has three or more corners (x, y), not {corners.tolist()}")
            self._outline, self._cells = np.zeros(corners.shape), np.zeros(corners.shape)
        self._outline[:] = corners
        return self._outline
