"""PlanPath: the best way over the map to a goal."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar, Final

from py_trees.common import Status
from py_trees.ports import NoDataAvailable

from pluto_bt.behaviours.destinations import Destination
from pluto_bt.behaviours.leaf import Leaf, RobotLeaf
from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.behaviours.motion_leaf import MOTION_OUTPUTS
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.reasons import WAITING
from pluto_bt.behaviours.robot import Robot, why_no_pose
from pluto_bt.skills.outline import Planar

GOAL: Final = Port(Destination, True, "where to", unit="m")
TOLERANCE: Final = Port(float, False, "how near counts as reached", 0.3, unit="m", ge=0.05)


def goal_of(leaf: Leaf, port: str = "goal") -> Destination | None:
    """The place that a port gives, or None where it has no value."""
    try:
        place: Destination = leaf.get_input(port)
    except NoDataAvailable:
        return None
    return place


class Planning(RobotLeaf):
    """A leaf that waits for a pose, then answers at once. `WAY`: `pluto check` judges the way that it asks for, as those of motion leaves."""

    WAY: ClassVar = "asked"

    def initialise(self) -> None:
        """Time counts from the first tick."""
        self._start_s = self.now_s()

    @abstractmethod
    def plan(self, robot: Robot) -> Status:
        """Plan; the robot's pose is known."""

    def act(self, robot: Robot) -> Status:
        """Wait for a pose, or plan."""
        if robot.surroundings.look(robot, self.now_s(), only_finely=True):
            return self.plan(robot)
        word, text = why_no_pose(robot)
        return self.fail(word, text) if self.now_s() - self._start_s >= WAITING[word] else self.wait(f"{word}: {text}")

    def found_place(self, port: str, robot: Robot) -> Destination | None:
        """The place that a port names, as it lies on the map; None if the port has none. Raises LookupError for a name the map does not know."""
        place = goal_of(self, port)
        return None if place is None else place.on(robot.map)


class PlanPath(Planning):
    """Plans the best way over the map, around what was seen, and writes it to `path`. Fails with `no-path` where there is none."""

    INPUT_PORTS = {"goal": GOAL, "start": Port(Destination, False, "from where; without it from the robot", unit="m"), "tolerance_m": TOLERANCE}
    OUTPUT_PORTS = {"path": Port(MapPath, False, "the way, for FollowPath"), **MOTION_OUTPUTS}

    def plan(self, robot: Robot) -> Status:
        """One plan."""
        try:
            goal, start = self.found_place("goal", robot), self.found_place("start", robot)
        except LookupError as error:
            return self.fail("no-path", str(error.args[0]))
        if goal is None:
            return self.fail("no-goal", "the port goal has no value")
        here: Planar = robot.surroundings.believed if start is None else (start.x_m, start.y_m, start.theta_rad or 0.0)
        planned = robot.navigation.plan(here, (goal.x_m, goal.y_m), goal.theta_rad, float(self.get_input("tolerance_m")), self.now_s())
        if planned.path is None:
            return self.fail(planned.reason, planned.text)
        self._set_output("path", planned.path)
        return self.succeed(f"a path of {planned.path.length_m:.1f} m")
