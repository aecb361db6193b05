"""FindPath and FollowRay: the two steps of ray following, of which the library trees make moveto and explore."""

from __future__ import annotations

import math
from typing import Final

from py_trees.common import Status
from py_trees.ports import NoDataAvailable

from pluto_bt.behaviours.free_itself import FreeItself
from pluto_bt.behaviours.leaf import Leaf, RobotLeaf
from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.reasons import WAITING
from pluto_bt.behaviours.robot import Robot, why_no_pose
from pluto_bt.behaviours.surroundings import MOST_BLOCKED, Surroundings
from pluto_bt.blackboard.codes import CommandType, GotoStatus
from pluto_bt.blackboard.messages import FVectorState, Pair
from pluto_bt.skills import ray_following as ray
from pluto_bt.skills.ray_following import RayFollowing
from pluto_bt.skills.rays import is_open
from pluto_bt.skills.ways import Way

SIDES: Final = ("none", "left", "right", "both")
NEW_POINT_M: Final = 0.6  # a goto point that moves less is not worth a new command
POINT_TOLERANCE_M: Final = 0.4
NEW_HEADING_RAD: Final = math.radians(8.0)
REFRESH_S: Final = 2.0
AGAIN_S: Final = 1.0  # while somebody is in the way, a path is looked for so often
PATIENCE_S: Final = 5.0  # then the robot goes nearer, and sees them better
PEOPLE: Final = "every way is blocked, and somebody is about who will walk on: waiting"
GOAL: Final = {"goal": Port(tuple[float, float], False, "where to; without it: to the nearest ground that is not explored yet", unit="m")}


def goal_of(leaf: Leaf) -> Pair | None:
    """The goal, or None where the leaf was given none."""
    try:
        goal: Pair = leaf.get_input("goal")
    except NoDataAvailable:
        return None
    return goal


def is_near(around: Surroundings, goal: Pair) -> bool:
    """True if the goal is so near, and the straight way there so free, that a simple goto does."""
    p, here = around.parameters, around.to_dead_reckoning(goal)
    distance_m = math.dist(here, around.robot[:2])
    if distance_m > p.near_goal_m:
        return False
    return distance_m < p.tolerance_m or is_open(around.map, around.robot[:2], here, 0.8 * around.ways.passes_m, 0.5)


class FindPath(RobotLeaf):
    """Looks for the best open path to `goal`, and fails with `no-path` where there is none; or to ground that is not explored yet, and
    says whether it has `found` any. Where only somebody who walks is in the way to a goal it waits, and takes now and then the path up to him."""

    INPUT_PORTS = dict(GOAL)
    OUTPUT_PORTS = {
        "near": Port(bool, False, "true: the goal is in straight reach of a simple goto"),
        "found": Port(bool, False, "true: there is a path"),
        **MOTION_OUTPUTS,
    }

    def initialise(self) -> None:
        """Time counts from the first tick."""
        self._start_s = self._placed_s = self.now_s()
        self._next_s = -math.inf

    def act(self, robot: Robot) -> Status:
        """Answers at once, unless it has to wait: for a pose, or for somebody who is in the way."""
        around, now_s, goal = robot.surroundings, self.now_s(), goal_of(self)
        if not around.look(robot, now_s):
            return self._wait_for_a_pose(robot, now_s)
        self._placed_s = now_s
        if now_s < self._next_s:
            return self.wait(PEOPLE)
        if self._next_s == -math.inf:
            around.openings.turn()
        if goal is not None and is_near(around, goal):
            self._set_output("near", True)
            return self.succeed("the goal is near")
        self._set_output("near", False)
        around.way = around.find(goal)
        if around.way is None and goal is not None and self._awaits_somebody(around, goal, now_s):
            return self.wait(PEOPLE)
        if around.way is None:
            around.way = around.find_once_more(goal)
        if around.way is not None and not around.sees_walkers(now_s) and not around.headway.decide(around.robot[:2]):
            if goal is not None:
                return self.fail("stuck", "one path after the other ends here")
            x_m, y_m = around.way.points[-1].tolist()
            around.map.give_up(x_m, y_m, ray.END_M)
            around.way = around.find(goal)
        return self._tell(around, goal)

    def _wait_for_a_pose(self, robot: Robot, now_s: float) -> Status:
        reason, text = why_no_pose(robot)
        return self.fail(reason, text) if now_s - self._placed_s >= WAITING[reason] else self.wait(f"{reason}: {text}")

    def _awaits_somebody(self, around: Surroundings, goal: Pair, now_s: float) -> bool:
        """Where no way is left: True while somebody in it may walk on. After `PATIENCE_S` the robot takes the way up to him, if there is one."""
        behind = around.find_behind_walkers(goal, now_s)
        if around.await_passers_by(now_s) if behind is None else now_s - self._start_s < PATIENCE_S:
            self._next_s = now_s + AGAIN_S
            return True
        around.way = behind
        return False

    def _tell(self, around: Surroundings, goal: Pair | None) -> Status:
        """What was found."""
        way = around.way
        self._set_output("found", way is not None)
        if way is None:
            return self.succeed("all that can be reached is explored") if goal is None else self.fail("no-path", around.why_no_way(goal))
        if goal is not None and way.leads_there and ray.is_done(way, around.robot, around.map.cell_m):
            self._set_output("near", True)
            return self.succeed("no path leads nearer to the goal")
        return self.succeed(f"a path of {way.length_m:.1f} m")


class FollowRay(MotionLeaf):
    """Follows the path found by FindPath in the middle of the street. SUCCESS where there is something new to decide: at its end, at an
    opening, where it is blocked, or where the goal is near. Fails with `stuck` when it is blocked again and again."""

    INPUT_PORTS = {**GOAL, **MOTION_INPUTS}
    OUTPUT_PORTS = {
        "near": Port(bool, False, "true: the goal is in straight reach of a simple goto"),
        "side": Port(str, False, "where to look before deciding", choices=SIDES),
        **MOTION_OUTPUTS,
    }

    def begin(self, robot: Robot) -> Status | None:
        """Take the path."""
        around, now_s = robot.surroundings, self.now_s()
        if not around.look(robot, now_s) or around.way is None:
            return self.fail("no-path", "there is no path to follow: FindPath comes first")
        self._goal = goal_of(self)
        self._following = RayFollowing(around.map, around.ways.passes_m, around.ways.room_m, around.openings)
        self._following.begin(around.way, self._find, now_s, around.robot)
        self._point: Pair | None = None
        self._heading_rad: float | None = None
        self._turn_sent_s = now_s
        self._freeing: FreeItself | None = None
        return self.follow(robot)

    def resume(self, robot: Robot) -> None:
        """The next step commands anyway."""
        self._point = self._heading_rad = None
        self._following.pause(self.now_s())

    def follow(self, robot: Robot) -> Status:
        """One step along the ray."""
        around, now_s = robot.surroundings, self.now_s()
        status = self.chain_status(robot)
        trouble = self.chain_trouble(robot, status)
        if trouble is not None:
            return trouble
        if not around.look(robot, now_s):
            if self._freeing is not None:
                self.post(robot, CommandType.VELOCITY)  # it backs by its velocity, which no link holds back for want of a pose
            return self.placeless(robot)
        if self._freeing is not None:
            return self._free(robot, around, self._freeing)
        if self._goal is not None and is_near(around, self._goal):
            around.blocked = 0
            return self._decide("none", "the goal is near", near=True)
        if status is not None and (self._waits.word or around.await_passers_by(now_s)):  # he goes on: the place is not blocked
            self._following.pause(now_s)
        speed_mps = status.data[0] if status is not None else 0.0
        advice = self._following.step(now_s, around.robot, speed_mps, around.rectangle_here)
        if advice.kind == ray.GO and status is not None and status.element[1] == GotoStatus.STUCK:
            advice = ray.Advice(ray.BLOCKED, advice.point, text=status.text)
        return self._carry_out(robot, around, advice, status)

    def _carry_out(self, robot: Robot, around: Surroundings, advice: ray.Advice, status: FVectorState | None) -> Status:
        if advice.kind == ray.GO:
            return self._go(robot, around, advice.point, status)
        if advice.kind == ray.TURN:
            return self._turn(robot, around, advice.heading_rad)
        if advice.kind == ray.BLOCKED:
            return self._blocked(robot, around, advice)
        around.blocked = 0
        return self._decide(advice.side or "none", advice.text)

    def _find(self) -> Way | None:
        assert self.robot is not None  # follow() has looked
        return self.robot.surroundings.find(self._goal)

    def _go(self, robot: Robot, around: Surroundings, point: Pair, status: FVectorState | None) -> Status:
        """A goto to a point on the ray, renewed when the point has moved on."""
        is_there = status is not None and status.element[1] == GotoStatus.REACHED
        if self._point is None or math.dist(point, self._point) > NEW_POINT_M or is_there:
            self._point, self._heading_rad = point, None
            turn_radps = math.radians(robot.platform.limits.max_turn_rate_dps)
            self.post(robot, CommandType.GOTO, around.to_map(point), (self.max_speed_mps(robot), turn_radps), POINT_TOLERANCE_M)
        return self.wait("following the path")

    def _turn(self, robot: Robot, around: Surroundings, heading_rad: float) -> Status:
        """Turn on the spot to a heading."""
        heading_rad = around.heading_in_map(heading_rad)
        is_new = self._heading_rad is None or abs(math.remainder(heading_rad - self._heading_rad, math.tau)) > NEW_HEADING_RAD
        if is_new or self._last_s - self._turn_sent_s > REFRESH_S:  # drive would time out
            self._heading_rad, self._point, self._turn_sent_s = heading_rad, None, self._last_s
            self.post(robot, CommandType.REGULATOR, (0.0, heading_rad))
        return self.wait("turning to the path")

    def _blocked(self, robot: Robot, around: Surroundings, advice: ray.Advice) -> Status:
        """Remember the place, and come away from it before anything is decided."""
        around.shut_ahead(self.now_s(), advice.point)
        around.blocked += 1
        if around.blocked >= MOST_BLOCKED:
            room_m, least_m = self._following.room_ahead_m, 2.0 * around.ways.least_m
            return self.fail("stuck", f"{advice.text}; the way ahead is about {room_m:.1f} m wide, and the robot takes one of {least_m:.2f} m")
        self._freeing = FreeItself(around, self.now_s())
        return self._free(robot, around, self._freeing)

    def _free(self, robot: Robot, around: Surroundings, freeing: FreeItself) -> Status:
        speed_mps = freeing.speed_mps(around, self.now_s())
        if speed_mps == 0.0:
            return self._decide("both", "the path was blocked")
        if self._ticket is None or self._ticket.command.velocity != (speed_mps, 0.0):
            self.post(robot, CommandType.VELOCITY, velocity=(speed_mps, 0.0))
        return self.wait("coming away from where it was blocked")

    def _decide(self, side: str, text: str, near: bool = False) -> Status:
        self._set_output("near", near)
        self._set_output("side", side)
        return self.succeed(text)
