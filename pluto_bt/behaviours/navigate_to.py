"""NavigateTo: to a goal of the map, planning again where the way is blocked."""

from __future__ import annotations

import math
from typing import ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.destinations import Destination
from pluto_bt.behaviours.free_itself import FreeItself
from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS
from pluto_bt.behaviours.path_driver import REFRESH_S, PathDriver
from pluto_bt.behaviours.plan_path import GOAL, TOLERANCE, goal_of
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.codes import CommandType
from pluto_bt.skills.outline import Planar

WATCHED_M: Final = 5.0  # so far ahead the path is looked at
LOOK_EVERY_S: Final = 0.5
AGAIN_S: Final = 1.0  # a new way is looked for so often where the old one is blocked
PATIENCE_S: Final = 10.0  # so long it waits where every way is blocked by something that may go away
MOST_STUCK: Final = 3


class NavigateTo(PathDriver):
    """Plans the best way over the map to `goal` and drives it; plans anew where the sensors see that it is blocked.

    Fails with `no-path` if there is no way, or none any more; with `stuck` if it does not get on though there is one.
    """

    WAY: ClassVar = "planned"
    INPUT_PORTS = {"goal": GOAL, "tolerance_m": TOLERANCE, **MOTION_INPUTS}
    OUTPUT_PORTS = {"path": Port(MapPath, False, "the way it follows"), **MOTION_OUTPUTS}

    def begin(self, robot: Robot) -> Status | None:
        """Look up the goal; the rest needs a pose."""
        wanted = self.wanted()
        if wanted is None:
            return self.fail("no-goal", "there is no goal to navigate to")
        try:
            self._goal = wanted.on(robot.map)
        except LookupError as error:
            return self.fail("no-path", str(error.args[0]))
        self.tolerance_m = float(self.get_input("tolerance_m"))
        self._has_path, self._stuck_count = False, 0
        self._looked_s = self._planned_s = self._last_s
        self._blocked_since_s: float | None = None
        self._freeing: FreeItself | None = None
        self._freed_s = -math.inf
        return self.follow(robot)

    def wanted(self) -> Destination | None:
        """The goal that the mission gives."""
        return goal_of(self)

    def follow(self, robot: Robot) -> Status:
        """Plan where there is no way yet or not any more, else drive."""
        here = self.here(robot)
        if isinstance(here, Status):
            return here
        if self._freeing is not None:
            return self._free(robot, self._freeing)
        if not self._has_path:
            return self._plan(robot, here)
        if self._last_s - self._looked_s >= LOOK_EVERY_S:
            self._looked_s = self._last_s
            is_blocked = robot.navigation.is_blocked(self._following.stretch(WATCHED_M))
            if is_blocked and self._last_s - self._planned_s >= AGAIN_S:
                return self._plan(robot, here)
        status = self.drive(robot, here)
        if status is Status.FAILURE and self.reason == "stuck" and self._stuck_count < MOST_STUCK:
            return self._try_again(robot)
        return status

    def _plan(self, robot: Robot, here: Planar) -> Status:
        goal, self._planned_s = self._goal, self._last_s
        planned = robot.navigation.plan(here, (goal.x_m, goal.y_m), goal.theta_rad, self.tolerance_m, self.now_s())
        if planned.path is not None:
            self._has_path, self._blocked_since_s = True, None
            self._set_output("path", planned.path)
            self.take(robot, planned.path, here)
            return self.drive(robot, here) if self._ticket is not None else self._start(robot, here)
        return self._no_way(robot, planned.reason, planned.text)

    def _start(self, robot: Robot, here: Planar) -> Status:
        self._go(robot, here, is_at_point=False)
        return self.wait(f"a path of {self._path.length_m:.1f} m")

    def _no_way(self, robot: Robot, reason: str, text: str) -> Status:
        """Stand and wait: what blocks the way may be somebody who walks on. Nothing was seen in the way: then waiting does not help."""
        if self._blocked_since_s is None or robot.surroundings.await_passers_by(self._last_s):
            self._blocked_since_s = self._last_s
        is_for_ever = not len(robot.navigation.blocking())
        if is_for_ever or self._last_s - self._blocked_since_s >= PATIENCE_S:
            return self.fail(reason, text if is_for_ever else f"every way is blocked by something that the map does not show: {text}")
        self._has_path = False
        if self._moves:
            self.post(robot, CommandType.VELOCITY)
        return self.wait("every way is blocked: waiting")

    def _try_again(self, robot: Robot) -> Status:
        """Come away from where it is stuck, then look for a way anew."""
        self._stuck_count += 1
        self._has_path, self.reason = False, ""
        self._freeing = FreeItself(robot.surroundings, self._last_s)
        return self._free(robot, self._freeing)

    def _free(self, robot: Robot, freeing: FreeItself) -> Status:
        speed_mps = freeing.speed_mps(robot.surroundings, self._last_s)
        if speed_mps == 0.0:
            self._freeing, self._ticket = None, None
            return self.wait("looking for a way anew")
        if self._ticket is None or self._ticket.command.velocity != (speed_mps, 0.0) or self._last_s - self._freed_s >= REFRESH_S:
            self._freed_s = self._last_s
            self.post(robot, CommandType.VELOCITY, velocity=(speed_mps, 0.0))
        return self.wait("coming away from where it was stuck")
