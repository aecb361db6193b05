"""A mission and a world together: the names they use of one another, and the legs driven in thought."""

from __future__ import annotations

from pluto_bt.inputs.legs_in_world import LegCheck, LegTold
from pluto_bt.inputs.option_values import Pose
from pluto_bt.maps.world import World
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.source import Faults
from pluto_bt.trees.checks.devices import check_devices
from pluto_bt.trees.checks.legs import Course
from pluto_bt.trees.checks.world_words import check_world_words, goals_of
from pluto_bt.trees.loader.expand import Plan


def check_on_robot(root: Plan, world: World | None, robot: RobotFile | None, start: Pose | None, faults: Faults) -> list[LegTold]:
    """The faults of a mission on a robot and in a world, and what each of its legs comes to; none without both (or where they are at fault).

    `start`: as `--start` has it, else the world's; where neither says one, nothing is known of the first leg but its goal.
    """
    if robot is not None:
        faults.extend(check_devices(root, robot.devices, robot.name))
    if world is not None:
        faults.extend(check_world_words(root, world, world))
    if robot is None or world is None:
        return []
    pose = start or world.robot.pose
    return LegCheck(world, robot, faults).run(Course(root.walk(), pose[:2] if pose is not None else None, goals_of(world)).legs)
