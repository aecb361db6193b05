"""What FollowPath and NavigateTo share: the robot on a path, by goto points ahead on it, and the heading at its end."""

from __future__ import annotations

import math
from typing import Final

from py_trees.common import Status

from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.behaviours.motion_leaf import MotionLeaf
from pluto_bt.behaviours.robot import NO_POINTS, Robot
from pluto_bt.blackboard.codes import CommandType, GotoStatus, LinkStatus
from pluto_bt.blackboard.messages import FVectorState
from pluto_bt.skills.outline import Planar
from pluto_bt.skills.path_following import PathFollowing

NEW_POINT_M: Final = 0.4  # a point ahead that has moved less is not worth a new command
POINT_TOLERANCE_M: Final = 0.3
TURNED_RAD: Final = math.radians(5.0)
TURN_LIMIT_S: Final = 20.0
REFRESH_S: Final = 2.0  # drive would time out


class PathDriver(MotionLeaf):
    """A motion leaf that drives along paths. `tolerance_m` is that of the path's end."""

    tolerance_m = 0.3

    def take(self, robot: Robot, path: MapPath, here: Planar) -> None:
        """Drive along this path from now on."""
        navigation = robot.navigation
        self._path = path
        self._following = PathFollowing(path.points, navigation.rooms_m(), navigation.least_m, navigation.parameters)
        self._following.begin(here, self._last_s)
        self._point: tuple[float, float] | None = None
        self._turning_since_s: float | None = None
        robot.show_path(path.points)

    def terminate(self, new_status: Status) -> None:
        """The path is driven no more."""
        if self.robot is not None and hasattr(self, "_path"):
            self.robot.show_path(NO_POINTS)
            del self._path
        super().terminate(new_status)

    def resume(self, robot: Robot) -> None:
        """The next step commands anyway."""
        self._point, self._ticket = None, None
        self._was_accepted, self._posted_s = False, self._last_s
        if self._turning_since_s is not None:
            self._turning_since_s = self._turn_sent_s = self._last_s - REFRESH_S
        if hasattr(self, "_following"):
            self._following.wait(self._last_s)

    def here(self, robot: Robot) -> Planar | Status:
        """Where the robot is; RUNNING while that is not known, FAILURE if it stays so."""
        around = robot.surroundings
        if around.look(robot, self.now_s(), only_finely=True):
            return around.believed
        if self._moves:
            self.post(robot, CommandType.VELOCITY)
            self._point = None
        return self.placeless(robot)

    def drive(self, robot: Robot, here: Planar) -> Status:
        """One step along the path: SUCCESS at its end, FAILURE `stuck` where it cannot get on."""
        status = self.chain_status(robot)
        trouble = self.chain_trouble(robot, status)
        if trouble is not None:
            return trouble
        if self._turning_since_s is not None:
            return self._turn(robot, here, self._turning_since_s)
        if self._waits.word or robot.surroundings.await_passers_by(self._last_s):
            self._following.wait(self._last_s)
        is_at_point = status is not None and status.element[1] == GotoStatus.REACHED
        if is_at_point and self._point == self._following.end:
            return self._arrived(robot, here)
        if (why := self._stuck(status)) is not None:
            return why
        self._go(robot, here, is_at_point)
        return self.wait(f"{self._following.left_m:.1f} m of the path to go")

    def _stuck(self, status: FVectorState | None) -> Status | None:
        most_s = self.robot.navigation.parameters.stuck_after_s if self.robot is not None else 0.0
        if status is not None and status.element[1] == GotoStatus.STUCK:
            return self.fail("bumper" if status.element[0] in (LinkStatus.FRONT_BUMPER, LinkStatus.BACK_BUMPER) else "stuck", status.text)
        if self._following.stuck_s(self._last_s) > most_s:
            return self.fail("stuck", f"no headway on the path for {most_s:g} s, {self._following.left_m:.1f} m to go")
        return None

    def _go(self, robot: Robot, here: Planar, is_at_point: bool) -> None:
        """A goto to a point on the path, renewed when the point has moved on."""
        point = self._following.step(here, self._last_s)
        is_end = point == self._following.end
        if self._point is None or is_at_point or math.dist(point, self._point) > NEW_POINT_M or (is_end and self._point != point):
            self._point = point
            turn_radps = math.radians(robot.platform.limits.max_turn_rate_dps)
            tolerance_m = self.tolerance_m if is_end else POINT_TOLERANCE_M
            self.post(robot, CommandType.GOTO, point, (self.max_speed_mps(robot), turn_radps), tolerance_m, on_the_way=not is_end)

    def _arrived(self, robot: Robot, here: Planar) -> Status:
        can_turn = robot.platform.body.kinematics != "ackermann"
        if not (self._path.ends_turned and can_turn):
            return self.succeed(f"{math.dist(here[:2], self._following.end):.2f} m from the end of the path")
        self._turning_since_s, self._turn_sent_s = self._last_s, self._last_s - REFRESH_S
        return self._turn(robot, here, self._last_s)

    def _turn(self, robot: Robot, here: Planar, since_s: float) -> Status:
        heading_rad = float(self._path.poses[-1, 2])
        off_rad = math.remainder(heading_rad - here[2], math.tau)
        if abs(off_rad) <= TURNED_RAD:
            return self.succeed(f"at the end of the path, {abs(math.degrees(off_rad)):.0f} deg off")
        if self._last_s - since_s >= TURN_LIMIT_S:
            return self.fail("stuck", f"cannot turn to the heading at the goal, {abs(math.degrees(off_rad)):.0f} deg off")
        if self._last_s - self._turn_sent_s >= REFRESH_S:
            self._turn_sent_s = self._last_s
            self.post(robot, CommandType.REGULATOR, (0.0, heading_rad))
        return self.wait(f"turning, {abs(math.degrees(off_rad)):.0f} deg to go")
