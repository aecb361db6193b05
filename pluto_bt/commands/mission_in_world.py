"""A mission and a world together: the names they use of one another, and the legs driven in thought."""

from __future__ import annotations

from pluto_bt.commands.legs_in_world import LegCheck, LegTold
from pluto_bt.maps.world import World
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.source import Faults
from pluto_bt.trees.checks.legs import Course
from pluto_bt.trees.checks.world_words import check_world_words
from pluto_bt.trees.loader.expand import Plan


def check_in_world(root: Plan, world: World, robot: RobotFile | None, faults: Faults) -> list[LegTold]:
    """The faults of a mission in a world, and what each of its legs comes to; without a robot (it has faults of its own) no legs."""
    faults.extend(check_world_words(root, world, world))
    if robot is None:
        return []
    x, y, _ = world.robot.pose or (0.0, 0.0, 0.0)
    return LegCheck(world, robot, faults).run(Course(root.walk(), (x, y)).legs)
