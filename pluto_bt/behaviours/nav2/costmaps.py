"""Nav2's services on costmaps, for what our robot remembers of what it has seen."""

from __future__ import annotations

from abc import abstractmethod

from py_trees.common import Status

from pluto_bt.behaviours.destinations import Destination
from pluto_bt.behaviours.leaf import NO_PORTS, RobotLeaf
from pluto_bt.behaviours.nav2.planning import value_of
from pluto_bt.behaviours.nav2.ports import SERVICE
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot, pose_of

LOCAL_M = 3.0  # side of the square that a "local" costmap has
PLUGINS = {"plugins": Port(list[str], False, "of Nav2; means nothing here")}
DISTANCE = {"reset_distance": Port(float, False, "side of the square", 1.0, unit="m", ge=0.0)}


class ClearCostmap(RobotLeaf):
    """Forgets something that was seen; SUCCESS at once."""

    @abstractmethod
    def forget(self, robot: Robot) -> None:
        """Do it."""

    def act(self, robot: Robot) -> Status:
        """Forget."""
        self.forget(robot)
        return self.succeed()


class ClearEntireCostmap(ClearCostmap):
    """Forgets all that was seen in the way; where `service_name` speaks of a local costmap, what was seen within 1.5 m."""

    INPUT_PORTS = {**PLUGINS, **SERVICE}
    OUTPUT_PORTS = NO_PORTS

    def forget(self, robot: Robot) -> None:
        """All, or near the robot."""
        name, pose = value_of(self, "service_name", ""), pose_of(robot)
        if "local_costmap" in name and pose is not None:
            robot.navigation.forget_square(pose[:2], LOCAL_M, inside=True)
        else:
            robot.navigation.forget()


class ClearCostmapExceptRegion(ClearCostmap):
    """Forgets what was seen outside a square round the robot."""

    INPUT_PORTS = {**DISTANCE, **PLUGINS, **SERVICE}
    OUTPUT_PORTS = NO_PORTS

    def forget(self, robot: Robot) -> None:
        """Outside."""
        pose = pose_of(robot)
        if pose is not None:
            robot.navigation.forget_square(pose[:2], float(self.get_input("reset_distance")), inside=False)


class ClearCostmapAroundRobot(ClearCostmap):
    """Forgets what was seen in a square round the robot."""

    INPUT_PORTS = {**DISTANCE, **PLUGINS, **SERVICE}
    OUTPUT_PORTS = NO_PORTS

    def forget(self, robot: Robot) -> None:
        """Inside."""
        pose = pose_of(robot)
        if pose is not None:
            robot.navigation.forget_square(pose[:2], float(self.get_input("reset_distance")), inside=True)


class ClearCostmapAroundPose(ClearCostmap):
    """Forgets what was seen in a square round a pose."""

    INPUT_PORTS = {"pose": Port(Destination, True, "the middle"), **DISTANCE, **PLUGINS, **SERVICE}
    OUTPUT_PORTS = NO_PORTS

    def forget(self, robot: Robot) -> None:
        """Inside."""
        place: Destination = self.get_input("pose").on(robot.map)
        robot.navigation.forget_square((place.x_m, place.y_m), float(self.get_input("reset_distance")), inside=True)
