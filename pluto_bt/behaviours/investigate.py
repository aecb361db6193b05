"""FindObject and CircleObject: what investigate is made of beside ray following."""

from __future__ import annotations

import math
from typing import Final

from py_trees.common import Status

from pluto_bt.behaviours.leaf import RobotLeaf
from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot, why_no_pose
from pluto_bt.behaviours.standstill import Standstill
from pluto_bt.behaviours.surroundings import Surroundings
from pluto_bt.blackboard.codes import CommandType
from pluto_bt.blackboard.messages import Pair
from pluto_bt.skills.circling import Round, SeenObject, circle
from pluto_bt.skills.objects import Thing, things_around
from pluto_bt.skills.outline import outline_of

PLACES: Final = 16  # on the circle, tried as places to begin
GAP_M: Final = 0.2  # kept between a turning robot and the object, whatever radius is asked for
CIRCLING_MPS: Final = 0.3
POST_S: Final = 0.2
BLOCKED_S: Final = 6.0
WRIST_RAD: Final = math.radians(2.0)
WRIST_DPS, WRIST_DPS2 = 40.0, 80.0
KEEP: Final = {"keep_facing": Port(bool, False, "true: the laser stays on the object at the end", False)}
RADIUS: Final = {"radius_m": Port(float, True, "distance from the middle of the object", unit="m", ge=0.1)}


def radius_around(robot: Robot, thing: Thing, radius_m: float) -> float:
    """The radius asked for, or the least at which the robot can pass."""
    outline = outline_of(robot.platform.body.outline_m)
    return max(radius_m, thing.radius_m + outline.reach_m + GAP_M)


class FindObject(RobotLeaf):
    """Finds the closest object in what was seen, and a place on the circle around it. Fails with `no-object`, or with
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
        for thing in inside:
            place = self._place(robot, around, thing)
            if place is not None:
                around.object = SeenObject(thing, around.parameters.largest_object_m)
                self._set_output("place", around.to_map(place))
                return self.succeed(f"an object of about {2.0 * thing.radius_m:.1f} m, {math.dist(thing[:2], around.robot[:2]):.1f} m away")
        if things and not inside:
            return self.fail("outside-rectangle", "no object can be circled inside the rectangle")
        return self.fail("no-object", "no object that can be circled is in sight" if things else "nothing stands alone within reach")

    def _fits(self, robot: Robot, around: Surroundings, thing: Thing) -> bool:
        """True if the circle stays inside the rectangle."""
        rectangle = around.rectangle_here
        radius_m = radius_around(robot, thing, float(self.get_input("radius_m")))
        return rectangle is None or rectangle.depth_m(thing.x_m, thing.y_m) >= radius_m

    def _place(self, robot: Robot, around: Surroundings, thing: Thing) -> Pair | None:
        """The nearest place on the circle that can be reached."""
        radius_m = radius_around(robot, thing, float(self.get_input("radius_m")))
        nearest_rad = math.atan2(around.robot[1] - thing.y_m, around.robot[0] - thing.x_m)
        for k in sorted(range(PLACES), key=lambda k: min(k, PLACES - k)):
            angle_rad = nearest_rad + k * math.tau / PLACES
            place = (thing.x_m + radius_m * math.cos(angle_rad), thing.y_m + radius_m * math.sin(angle_rad))
            is_free = around.map.clearance_m(*place) >= around.ways.least_m
            if is_free and around.ways.to_goal(around.robot, place, around.rectangle_here) is not None:
                return place
        return None


class CircleObject(MotionLeaf):
    """Circles the object of FindObject, the laser turned to it as far as the wrist goes. Where the circle is blocked it goes the other
    way round; blocked there too, it fails with `stuck`."""

    INPUT_PORTS = {**RADIUS, "turns": Port(float, False, "how many times around", 1.0, ge=0.0), **KEEP, **MOTION_INPUTS}
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def begin(self, robot: Robot) -> Status | None:
        """Counter-clockwise first."""
        around = robot.surroundings
        if around.object is None:
            return self.fail("no-object", "there is no object to circle: FindObject comes first")
        self._round, self._side = Round(), 1.0
        self._sent_s, self._standstill = -math.inf, Standstill(self.now_s())
        self._has_turned_back = False
        self._pointed_rad = math.inf
        return None

    def resume(self, robot: Robot) -> None:
        """The next step posts anyway."""
        self._sent_s, self._standstill = -math.inf, Standstill(self.now_s())

    def follow(self, robot: Robot) -> Status:
        """One step along the circle."""
        around, now_s = robot.surroundings, self.now_s()
        seen, status = around.object, self.chain_status(robot)
        trouble = self.chain_trouble(robot, status)
        if trouble is not None or seen is None:
            return trouble or self.fail("no-object", "the object is forgotten")
        if not around.look(robot, now_s):
            self.post(robot, CommandType.VELOCITY)
            self._sent_s, self._standstill = -math.inf, Standstill(now_s)
            return self.placeless(robot)
        for view in around.views:
            seen.see(view)
        turns = self._round.go(around.robot, seen.thing)
        if turns >= float(self.get_input("turns")):
            return self.succeed(f"{turns:.2f} turns")
        if self._standstill.step(robot, now_s, is_held=bool(self._waits.word)) > BLOCKED_S:
            if self._has_turned_back:
                return self.fail("stuck", "the circle is blocked on both sides")
            self._side, self._has_turned_back, self._standstill = -self._side, True, Standstill(now_s)
        self._drive(robot, around, seen.thing, now_s)
        return self.wait(f"{turns:.2f} turns around an object of {2.0 * seen.thing.radius_m:.1f} m")

    def terminate(self, new_status: Status) -> None:
        """Stand, and look ahead again."""
        super().terminate(new_status)
        robot = self.robot
        stays = new_status == Status.SUCCESS and self.get_input("keep_facing")
        if robot is not None and not stays and getattr(self, "_pointed_rad", math.inf) != math.inf:
            robot.point_wrist(0.0, 0.0, math.radians(WRIST_DPS), math.radians(WRIST_DPS2))

    def _drive(self, robot: Robot, around: Surroundings, thing: Thing, now_s: float) -> None:
        if now_s - self._sent_s < POST_S - 1e-6:
            return
        self._sent_s = now_s
        radius_m = radius_around(robot, thing, float(self.get_input("radius_m")))
        speed_mps = min(CIRCLING_MPS, self.max_speed_mps(robot))
        self.post(robot, CommandType.VELOCITY, velocity=circle(around.robot, thing, radius_m, speed_mps, self._side))
        self._face(robot, around, thing)

    def _face(self, robot: Robot, around: Surroundings, thing: Thing) -> None:
        """Turn the laser to the object. It stands before the robot's middle, and so the object lies farther back for it."""
        wrist, laser = robot.platform.devices.wrist, robot.platform.devices.laser
        if wrist is None or laser is None:
            return
        x, y, theta = around.robot
        x, y = x + laser.x_m * math.cos(theta) - laser.y_m * math.sin(theta), y + laser.x_m * math.sin(theta) + laser.y_m * math.cos(theta)
        bearing_rad = math.remainder(math.atan2(thing.y_m - y, thing.x_m - x) - theta, math.tau)
        limit_rad = math.radians(wrist.pan_limit_deg)
        pan_rad = max(-limit_rad, min(limit_rad, bearing_rad))
        if abs(pan_rad - self._pointed_rad) > WRIST_RAD:
            self._pointed_rad = pan_rad
            robot.point_wrist(pan_rad, 0.0, math.radians(WRIST_DPS), math.radians(WRIST_DPS2))
