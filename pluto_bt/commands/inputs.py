"""Reads everything a run needs and tells all faults of all files at once, before anything heavy is imported."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from pluto_bt.commands.files import find_file
from pluto_bt.commands.plugins import load_plugins
from pluto_bt.maps.load import load_world
from pluto_bt.maps.placement import placed_outline, what_stands_at
from pluto_bt.maps.world import SetTopic, World
from pluto_bt.modules.robot_file import RobotFile, load_robot_file
from pluto_bt.source import Faults, InputError, Place, did_you_mean

Pose = tuple[float, float, float]
DEFAULT_WORLD, DEFAULT_PLATFORM = "yard.xml", "atrv2"


@dataclass(frozen=True)
class Request:
    """What the user asked for, in his words (the options of `pluto run`)."""

    mission: str
    world: str | None = None
    map: str | None = None
    start: str | None = None
    platform: str | None = None
    tree: str | None = None
    port: Sequence[str] = ()
    seed: str | None = None
    set: Sequence[str] = ()
    plugin: Sequence[str] = ()

    @classmethod
    def of(cls, args: argparse.Namespace) -> Request:
        """The request that a parsed command line makes."""
        return cls(**{field.name: getattr(args, field.name) for field in fields(cls)})


@dataclass
class Inputs:
    """What a run is made of, checked."""

    mission_path: Path
    world: World
    map: World | None
    robot: RobotFile
    start: Pose
    seed: int
    ports: dict[str, str]
    tree: str | None


def add_input_options(parser: argparse.ArgumentParser) -> None:
    """The options that say what is run where."""
    parser.add_argument("mission", metavar="MISSION.xml", help="a mission file, or the name of a shipped one")
    parser.add_argument("--world", metavar="W", help=f"world: our XML, a ROS map.yaml or an ARNL .map (default {DEFAULT_WORLD})")
    parser.add_argument("--map", metavar="M", help="a-priori map for localisation and planning (default: the world's own)")
    parser.add_argument("--start", metavar="X,Y,DEG", help="start pose (default: the world's)")
    parser.add_argument("--platform", metavar="P", help=f"atrv2, car, jbot, pioneer or a .toml file (default: the world's, else {DEFAULT_PLATFORM})")
    parser.add_argument("--tree", metavar="ID", help="the tree to run, if not the main one")
    parser.add_argument("--port", metavar="NAME=VALUE", action="append", default=[], help="an input of the main tree; may be repeated")
    parser.add_argument("--seed", metavar="N", help="seed of all randomness (default: the world's, else 0)")
    parser.add_argument("--set", metavar="PARAM=VALUE", action="append", default=[], help="a parameter of the platform file; may be repeated")
    parser.add_argument("--plugin", metavar="MODULE", action="append", default=[], help="a Python module whose nodes may be used; may be repeated")


def read_inputs(request: Request, beside: Path | None = None) -> Inputs:
    """Read and check all inputs but the mission itself.

    Raises: InputError with every fault found.
    """
    faults = Faults()
    mission_path = find_file("mission", request.mission, faults, beside)
    world = _world(request.world or DEFAULT_WORLD, faults, beside)
    a_priori = _world(request.map, faults, beside) if request.map else None
    robot = _robot(request.platform or (world.robot.platform if world else "") or DEFAULT_PLATFORM, request.set, faults, beside)
    start = _start(request.start, faults)
    seed = _seed(request.seed, faults)
    ports = read_ports(request.port, faults)
    load_plugins(request.plugin, faults)
    if world is not None and robot is not None:
        start = start or world.robot.pose or (0.0, 0.0, 0.0)
        _check_place(world, robot, start, Place(f"--start {request.start}") if request.start else world.robot.place, faults)
        _check_topics(world, faults)
    faults.raise_errors()
    assert mission_path is not None and world is not None and robot is not None and start is not None  # each None came with a fault
    return Inputs(mission_path, world, a_priori, robot, start, world.seed if seed is None else seed, ports, request.tree)


def _world(name: str, faults: Faults, beside: Path | None) -> World | None:
    path = find_file("world", name, faults, beside)
    if path is None:
        return None
    try:
        return load_world(path, name)
    except InputError as error:
        faults.extend(error.faults)
        return None


def _robot(name: str, settings: Sequence[str], faults: Faults, beside: Path | None) -> RobotFile | None:
    local = beside / name if beside is not None else None
    try:
        return load_robot_file(str(local) if local is not None and local.is_file() else name, settings)
    except InputError as error:
        faults.extend(error.faults)
        return None


def _start(text: str | None, faults: Faults) -> Pose | None:
    if text is None:
        return None
    try:
        x, y, deg = (float(word) for word in text.split(","))
        if not all(map(math.isfinite, (x, y, deg))):
            raise ValueError
    except ValueError:
        faults.error(Place(f"--start {text}"), "bad-value", "a start pose is three numbers", expected="X,Y,DEG, for example 0.5,12,90", found=text)
        return None
    return (x, y, math.remainder(math.radians(deg), math.tau))


def _seed(text: str | None, faults: Faults) -> int | None:
    if text is None:
        return None
    if not text.isdecimal() or int(text) >= 1 << 63:
        faults.error(Place(f"--seed {text}"), "bad-value", "a seed is a whole number from 0 to 2^63 - 1", found=text)
        return None
    return int(text)


def read_ports(settings: Sequence[str], faults: Faults) -> dict[str, str]:
    """`--port NAME=VALUE` settings as a table."""
    ports: dict[str, str] = {}
    for setting in settings:
        name, equals, value = setting.partition("=")
        if not equals or not name:
            faults.error(Place(f"--port {setting}"), "bad-port", "an input has the form NAME=VALUE", found=setting)
        ports[name] = value
    return ports


def check_world(name: str, platform: str | None) -> None:
    """Check a world alone: its file, its robot's place, the topics that its script sets.

    Raises: InputError with every fault found.
    """
    faults = Faults()
    world = _world(name, faults, None)
    if world is not None:
        robot = _robot(platform or world.robot.platform or DEFAULT_PLATFORM, (), faults, None)
        if robot is not None and world.robot.pose is not None:
            _check_place(world, robot, world.robot.pose, world.robot.place, faults)
        _check_topics(world, faults)
    faults.raise_errors()


def _check_place(world: World, robot: RobotFile, start: Pose, place: Place, faults: Faults) -> None:
    hit = what_stands_at(world, placed_outline(np.array(robot.body.outline_m), start))
    if hit:
        faults.error(place, "start-blocked", f'the robot would start inside "{hit}"', found=f"{start[0]:g},{start[1]:g},{math.degrees(start[2]):g}",
                     mend="give a free place with --start X,Y,DEG")  # fmt: skip


def _check_topics(world: World, faults: Faults) -> None:
    """`<set>` writes only topics whose writer is `world`."""
    from pluto_bt.blackboard.messages import Flag
    from pluto_bt.blackboard.topics import TOPICS

    known = [topic.name for topic in TOPICS if topic.writer == "world" and topic.type is Flag]
    for event in world.script:
        for action in event.actions:
            if isinstance(action, SetTopic) and action.topic not in known:
                faults.error(action.place, "read-only", f'a world script cannot write "{action.topic}"', expected=f"one of: {', '.join(known)}",
                             found=action.topic, mend=did_you_mean(action.topic, known))  # fmt: skip


def as_faults(error: InputError) -> list[dict[str, str | int]]:
    """The faults as `--json` shows them."""
    return [fault.as_json() for fault in error.faults]


__all__ = ["Inputs", "Request", "add_input_options", "as_faults", "check_world", "read_inputs", "read_ports"]
