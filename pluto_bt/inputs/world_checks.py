"""What a world cannot know alone: whether the robot has room at its start, and whether topics and modules of its script exist."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from pluto_bt.maps.fault_table import SENSORS
from pluto_bt.maps.placement import placed_outline, what_stands_at
from pluto_bt.maps.script import At, FaultAction, SetTopic, When
from pluto_bt.maps.world import World
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.source import Faults, Place, did_you_mean


def check_together(world: World, robot: RobotFile | None, start: tuple[float, float, float] | None, asked: str | None, faults: Faults) -> None:
    """The faults of a world with the robot that starts in it at `start` (None: nobody says where); `asked` is the text of `--start`, if given."""
    if robot is not None and start is not None:
        _check_start(world, robot, start, asked, faults)
    _check_script(world, faults)
    if robot is not None:
        _check_faults(world, robot, faults)


def _check_start(world: World, robot: RobotFile, start: tuple[float, float, float], asked: str | None, faults: Faults) -> None:
    """A fault if something stands at the start (x m, y m, theta rad)."""
    hit = what_stands_at(world, placed_outline(np.array(robot.body.outline_m), start))
    if hit:
        place = Place(f"--start {asked}") if asked is not None else in_file(world.robot.place, world)
        faults.error(place, "start-blocked", f'the robot would start inside "{hit}"', expected="a free place",
                     found=f"{start[0]:g},{start[1]:g},{math.degrees(start[2]):g}", mend="give a free place with --start X,Y,DEG")  # fmt: skip


def _check_script(world: World, faults: Faults) -> None:
    """`<set>` writes only topics whose writer is `world`, with true or false; a fault hits a module that there is."""
    for entry in world.script:
        _check_actions(entry, faults)


def _check_faults(world: World, robot: RobotFile, faults: Faults) -> None:
    """Warn of scripted faults that mean nothing on this robot; it need not be the one that the world was made for."""
    for action in (action for entry in world.script for action in entry.actions):
        if not isinstance(action, FaultAction) or action.device not in SENSORS:
            continue
        names = ("imu", "dmu") if action.device == "imu" else (action.device,)
        if all(getattr(robot.devices, name) is None for name in names):
            what = f'this fault changes nothing: "{robot.name}" has no {action.device}'
            faults.warning(action.place, "no-device", what, expected="a robot that has it", found=robot.name)
        elif action.beams is not None and action.beams[1] >= (count := _rays(robot, action.device)):
            what, found = f"the {action.device} has {count} beams", f"{action.beams[0]}-{action.beams[1]}"
            faults.warning(action.place, "no-beam", what, expected=f"beams from 0 to {count - 1}", found=found)


def _rays(robot: RobotFile, device: str) -> int:
    laser, sonar = robot.devices.laser, robot.devices.sonar
    if device == "laser":
        return laser.beams if laser is not None else 0
    return len(sonar.transducers) if sonar is not None else 0


def in_file(place: Place, world: World) -> Place:
    """A place that has no file is the world's file as a whole."""
    return place if place.file else replace(place, file=world.file)


def _check_actions(entry: At | When, faults: Faults) -> None:
    from pluto_bt.blackboard.messages import Flag
    from pluto_bt.blackboard.topics import TOPICS

    topics = [topic.name for topic in TOPICS if topic.writer == "world" and topic.type is Flag]
    for action in entry.actions:
        if isinstance(action, SetTopic):
            _check_set(action, topics, faults)
        elif isinstance(action, FaultAction) and action.device.startswith("module:"):
            _check_module(action, faults)


def _check_set(action: SetTopic, topics: list[str], faults: Faults) -> None:
    if action.topic not in topics:
        what, mend = f'a world script cannot write "{action.topic}"', did_you_mean(action.topic, topics)
        faults.error(action.place, "read-only", what, expected=f"one of: {', '.join(topics)}", found=action.topic, mend=mend)
    elif action.value not in ("true", "false", "1", "0"):
        what = f'"{action.topic}" is true or false'
        faults.error(action.place, "bad-value", what, expected='value="true" or value="false"', found=action.value)


def _check_module(action: FaultAction, faults: Faults) -> None:
    from pluto_bt.system import MODULES

    names, name = [module.name for module in MODULES], action.device.removeprefix("module:")
    if name not in names:
        what = f'there is no module "{name}"'
        faults.error(action.place, "unknown-module", what, expected=f"one of: {', '.join(names)}", found=name, mend=did_you_mean(name, names))
