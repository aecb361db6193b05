"""CircleObject: round an object, with stops at which the robot turns to it as far as its laser cannot."""

from __future__ import annotations

import math
from typing import Final

from py_trees.common import Status

from pluto_bt.behaviours.find_object import RADIUS, radius_around
from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.behaviours.standstill import Standstill
from pluto_bt.behaviours.surroundings import Surroundings
from pluto_bt.blackboard.codes import CommandType
from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.skills.circling import Looks, Round, circle, facing_rad
from pluto_bt.skills.objects import Thing
from pluto_bt.skills.outline import Planar, outline_of

CIRCLING_MPS: Final = 0.3
POST_S: Final = 0.2
BLOCKED_S: Final = 6.0
WRIST_RAD: Final = math.radians(2.0)
WRIST_DPS, WRIST_DPS2 = 40.0, 80.0
SPARE_RAD: Final = math.radians(3.0)  # of the wrist's range is left when the robot has turned to the object, and so exactly it has turned
LOOK_S, MOST_LOOK_S = 0.5, 10.0  # a look takes two scans; a robot that cannot turn there goes on
TURN_ROOM_M: Final = 0.1  # around a robot that turns
KEEP: Final = {"keep_facing": Port(bool, False, "true: the laser stays on the object at the end", False)}
LOOKS: Final = {"looks": Port(int, False, "so many times a turn the robot stops and turns until its laser faces the object", 8, ge=0)}


class CircleObject(MotionLeaf):
    """Circles the object of FindObject, the laser turned to it as far as the wrist goes; for the rest the robot stops now and then and turns to it.
    Where the circle is blocked it goes the other way round; blocked there too, it fails with `stuck`."""

    INPUT_PORTS = {**RADIUS, **LOOKS, "turns": Port(float, False, "how many times around", 1.0, ge=0.0), **KEEP, **MOTION_INPUTS}
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def begin(self, robot: Robot) -> Status | None:
        """Counter-clockwise first."""
        around = robot.surroundings
        if around.object is None:
            return self.fail("no-object", "there is no object to circle: FindObject comes first")
        self._round, self._side, self._looks = Round(), 1.0, Looks(int(self.get_input("looks")))
        self._sent_s, self._standstill = -math.inf, Standstill(self.now_s())
        self._has_turned_back = False
        self._pointed_rad = math.inf
        return None

    def resume(self, robot: Robot) -> None:
        """The next step posts anyway."""
        self._looks.pause()
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
        told = f"{turns:.2f} turns around an object of {2.0 * seen.thing.radius_m:.1f} m"
        if self._looks.is_due(turns) and self._turns_to_it(robot, around, seen.thing, now_s):
            return self.wait(f"{told}, looking at it")
        self._drive(robot, around, seen.thing, now_s)
        return self.wait(told)

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

    def _turns_to_it(self, robot: Robot, around: Surroundings, thing: Thing, now_s: float) -> bool:
        """Turn on the spot until the laser can face the object, and hold it there for a moment. False once that is done, and where it cannot be."""
        laser = robot.platform.devices.laser
        has_room = around.map.clearance_m(*around.robot[:2]) >= outline_of(robot.platform.body.outline_m).reach_m + TURN_ROOM_M
        if laser is None or (not has_room and not self._looks.is_on):
            return False
        heading_rad = facing_rad(around.robot, thing, laser.x_m, max(0.0, _pan_limit_rad(robot) - SPARE_RAD))
        off_rad = abs(math.remainder(heading_rad - around.robot[2], math.tau))
        off_rad = max(off_rad, abs(_bearing_rad(robot, around.robot, thing) - _pan_rad(robot)) - SPARE_RAD)
        if not self._looks.goes_on(now_s, off_rad < SPARE_RAD, LOOK_S, MOST_LOOK_S):
            self._sent_s, self._standstill = -math.inf, Standstill(now_s)
            return False
        self._standstill = Standstill(now_s)
        if now_s - self._sent_s >= POST_S - 1e-6:
            self._sent_s = now_s
            self.post(robot, CommandType.REGULATOR, (0.0, around.heading_in_map(heading_rad)))
            self._face(robot, around, thing)
        return True

    def _face(self, robot: Robot, around: Surroundings, thing: Thing) -> None:
        """Turn the laser to the object."""
        if robot.platform.devices.wrist is None or robot.platform.devices.laser is None:
            return
        bearing_rad, limit_rad = _bearing_rad(robot, around.robot, thing), _pan_limit_rad(robot)
        pan_rad = max(-limit_rad, min(limit_rad, bearing_rad))
        if abs(pan_rad - self._pointed_rad) > WRIST_RAD:
            self._pointed_rad = pan_rad
            robot.point_wrist(pan_rad, 0.0, math.radians(WRIST_DPS), math.radians(WRIST_DPS2))


def _bearing_rad(robot: Robot, here: Planar, thing: Thing) -> float:
    """Where the object lies for the laser. It stands before the robot's middle, and so the object lies farther back for it."""
    laser, (x, y, theta) = robot.platform.devices.laser, here
    if laser is not None:
        x, y = x + laser.x_m * math.cos(theta) - laser.y_m * math.sin(theta), y + laser.x_m * math.sin(theta) + laser.y_m * math.cos(theta)
    return math.remainder(math.atan2(thing.y_m - y, thing.x_m - x) - theta, math.tau)


def _pan_limit_rad(robot: Robot) -> float:
    """How far the wrist turns to either side; 0 without one."""
    wrist = robot.platform.devices.wrist
    return 0.0 if wrist is None else math.radians(wrist.pan_limit_deg)


def _pan_rad(robot: Robot) -> float:
    """Where the wrist points."""
    state = robot.newest("wrist/state")
    return state.position[0] if isinstance(state, ActuatorState) else 0.0
