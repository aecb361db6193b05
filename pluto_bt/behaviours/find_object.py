"""FindObject: the nearest thing that can be circled, and where to begin."""

from __future__ import annotations

import math
from typing import Final

from py_trees.common import Status

from pluto_bt.behaviours.leaf import RobotLeaf
from pluto_bt.behaviours.motion_leaf import MOTION_OUTPUTS
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot, why_no_pose
from pluto_bt.behaviours.surroundings import Surroundings
from pluto_bt.blackboard.messages import Pair
from pluto_bt.skills.circling import SeenObject, tightest
from pluto_bt.skills.objects import Thing, things_around
from pluto_bt.skills.outline import outline_of

PLACES: Final = 16  # on the circle, tried as places to begin
GAP_M: Final = 0.2  # kept between a turning robot and the object, whatever radius is asked for
ROOM_M: Final = 0.1  # beside what stands along the circle: the margin of avoidance, and what the map may be off
MOST_TOLD: Final = 3  # objects
RADIUS: Final = {"radius_m": Port(float, True, "distance from the middle of the object", unit="m", ge=0.1)}


def radius_around(robot: Robot, thing: Thing, radius_m: float) -> float:
    """The radius asked for, or the least at which the robot can pass."""
    outline = outline_of(robot.platform.body.outline_m)
    return max(radius_m, thing.radius_m + outline.reach_m + GAP_M)


class FindObject(RobotLeaf):
    """Finds the closest object in what was seen whose circle is open as far as seen, and a place on that circle. Fails with `no-object`, or with
    `outside-rectangle` where only objects are left whose circle leaves the rectangle."""

    INPUT_PORTS = dict(RADIUS)
    OUTPUT_PORTS = {"place": Port(tuple[float, float], False, "where to begin the circle", unit="m"), **MOTION_OUTPUTS}

    def act(self, robot: Robot) -> Status:
        """Answers at once."""
        around = robot.surroundings
        if not around.look(robot, self.now_s()):
            return self.fail(*why_no_pose(robot))
        things = things_around(around.map, around.robot)
        inside = [thing for thing in things if self._fits(robot, around, thing)]
        lacks = [self._lack(robot, around, thing) for thing in inside]
        for thing, lack in zip(inside, lacks, strict=True):
            place = None if lack else self._place(robot, around, thing)
            if place is not None:
                around.object = SeenObject(thing, around.parameters.largest_object_m)
                self._set_output("place", around.to_map(place))
                return self.succeed(f"an object of about {2.0 * thing.radius_m:.1f} m, {math.dist(thing[:2], around.robot[:2]):.1f} m away")
        if things and not inside:
            return self.fail("outside-rectangle", "no object can be circled inside the rectangle")
        words = [lack or f"{_named(around, thing)}: no way leads to its circle" for thing, lack in zip(inside, lacks, strict=True)]
        return self.fail("no-object", "; ".join(words[:MOST_TOLD]) if words else "nothing stands alone within reach")

    def _fits(self, robot: Robot, around: Surroundings, thing: Thing) -> bool:
        """True if the circle stays inside the rectangle."""
        rectangle = around.rectangle_here
        radius_m = radius_around(robot, thing, float(self.get_input("radius_m")))
        return rectangle is None or rectangle.depth_m(thing.x_m, thing.y_m) >= radius_m

    def _lack(self, robot: Robot, around: Surroundings, thing: Thing) -> str:
        """What is missing on the circle, in words; "" if it is open as far as seen."""
        radius_m = radius_around(robot, thing, float(self.get_input("radius_m")))
        need_m = outline_of(robot.platform.body.outline_m).round_a_circle_m(radius_m) + ROOM_M
        x_m, y_m, room_m = tightest(around.map, thing, radius_m)
        if room_m >= need_m:
            return ""
        x_m, y_m = around.to_map((x_m, y_m))
        missing = f"{need_m - room_m:.1f} m of room are missing" if room_m > 0.0 else "something stands"
        return f"{_named(around, thing)}: on its circle of {radius_m:.1f} m {missing} at {x_m:.1f};{y_m:.1f}"

    def _place(self, robot: Robot, around: Surroundings, thing: Thing) -> Pair | None:
        """The nearest place on the circle that can be reached."""
        radius_m = radius_around(robot, thing, float(self.get_input("radius_m")))
        nearest_rad = math.atan2(around.robot[1] - thing.y_m, around.robot[0] - thing.x_m)
        for k in sorted(range(PLACES), key=lambda k: min(k, PLACES - k)):
            angle_rad = nearest_rad + k * math.tau / PLACES
            place = (thing.x_m + radius_m * math.cos(angle_rad), thing.y_m + radius_m * math.sin(angle_rad))
            is_free = around.map.clearance_m(*place) >= around.ways.passes_m
            if is_free and around.ways.to_goal(around.robot, place, around.rectangle_here) is not None:
                return place
        return None


def _named(around: Surroundings, thing: Thing) -> str:
    """An object in words."""
    x_m, y_m = around.to_map((thing.x_m, thing.y_m))
    return f"the object of about {2.0 * thing.radius_m:.1f} m at {x_m:.1f};{y_m:.1f}"
