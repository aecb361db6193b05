"""Reads everything a run needs and tells all faults of all files at once, before anything heavy is imported."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from pluto_bt.files import find_file
from pluto_bt.inputs.area_edge import check_area_edge
from pluto_bt.inputs.missions import examine_file
from pluto_bt.inputs.option_values import Pose, read_ports, read_seed, read_start
from pluto_bt.inputs.plugins import load_plugins
from pluto_bt.inputs.world_checks import check_together, in_file
from pluto_bt.maps.load import read_world
from pluto_bt.maps.world import World
from pluto_bt.modules.live_parameters import value_of
from pluto_bt.modules.robot_file import RobotFile, load_robot_file, overlay_names
from pluto_bt.runtime.parameters import shown
from pluto_bt.source import Fault, Faults, InputError, Place
from pluto_bt.trees.checks.devices import check_devices
from pluto_bt.trees.checks.world_words import check_world_words

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
    params: str | None = None
    plugin: Sequence[str] = ()


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
    warnings: tuple[Fault, ...] = ()
    platform: str = DEFAULT_PLATFORM
    settings: tuple[str, ...] = ()
    plugins: tuple[str, ...] = ()
    params: Path | None = None


def read_inputs(request: Request, beside: Path | None = None, nodes: Iterable[type] = (), faults: Faults | None = None) -> Inputs:
    """Read and check mission, world, map, platform and options.

    Args:
        beside: a folder where files are looked for too.
        nodes: classes of leaves that the mission may use.
        faults: what was found wrong so far, told together with all else.
    Raises: InputError with every fault found.
    """
    faults = faults if faults is not None else Faults()
    load_plugins(request.plugin, faults)
    ports = read_ports(request.port, faults)
    mission_path = find_file("mission", request.mission, faults, beside)
    examined = examine_file(mission_path, request.mission, nodes, request.tree, ports) if mission_path is not None else None
    if examined is not None:
        faults.extend(examined.faults)
    world = _world(DEFAULT_WORLD if request.world is None else request.world, faults, beside)
    a_priori = None if request.map is None else _world(request.map, faults, beside)
    platform = _platform_name(request.platform, world, beside)
    params = None if request.params is None else Path(request.params)
    robot = _robot(request.platform, world, request.set, faults, beside, params)
    start, seed = read_start(request.start, faults), read_seed(request.seed, faults)
    if world is not None:
        if start is None and request.start is None:
            start = world.robot.pose or (0.0, 0.0, 0.0)
        check_together(world, robot, start, request.start, faults)
        if examined is not None and examined.plan is not None:
            faults.extend(check_world_words(examined.plan, world, a_priori or world, may_fail=True))
    if robot is not None and examined is not None and examined.plan is not None:
        faults.extend(check_devices(examined.plan, robot.devices, robot.name, may_fail=True))
    faults.raise_errors()
    assert mission_path is not None and world is not None and robot is not None and start is not None  # each None came with a fault
    seed = world.seed if seed is None else seed
    laid_over = sorted(overlay_names(params)) if params is not None else []
    settings = (*(f"{name}={shown(value_of(robot, name))}" for name in laid_over), *request.set)  # so that a black box knows them
    return Inputs(mission_path, world, a_priori, robot, start, seed, ports, request.tree, faults.in_order(), platform, settings,
                  tuple(request.plugin), params)  # fmt: skip


def check_world(
    name: str, platform: str | None, faults: Faults, start: Pose | None = None, asked: str | None = None
) -> tuple[World | None, RobotFile | None]:
    """Check a world alone: its file, its robot and that one's place (`start`, as `asked` with `--start`, before the world's own), the topics and
    modules of its script. Returns what could be read."""
    world = _world(name, faults, None)
    robot = _robot(platform, world, (), faults, None)
    if world is not None:
        check_together(world, robot, start or world.robot.pose, asked, faults)
        if robot is not None:
            check_area_edge(world, robot, faults)
    return world, robot


def read_robot(platform: str, faults: Faults) -> RobotFile | None:
    """A platform alone; None with its faults."""
    return _robot(platform, None, (), faults, None)


def _world(name: str, faults: Faults, beside: Path | None) -> World | None:
    path = find_file("world", name, faults, beside)
    if path is None:
        return None
    return read_world(path, name if path == Path(name) else str(path), faults)


def _robot(
    asked: str | None, world: World | None, settings: Sequence[str], faults: Faults, beside: Path | None, params: Path | None = None
) -> RobotFile | None:
    """The robot asked for, else the world's, else the default; a path in a world file is taken from its folder, too."""
    named = world.robot.platform if world is not None and asked is None else ""
    name = _platform_name(asked, world, beside)
    try:
        named_at = in_file(world.robot.place, world) if named and world is not None else Place(name or 'platform ""')
        return load_robot_file(name, settings, named_at, params)
    except InputError as error:
        faults.extend(error.faults)
        return None


def _platform_name(asked: str | None, world: World | None, beside: Path | None) -> str:
    """The name or path of the robot file that is meant."""
    named = world.robot.platform if world is not None and asked is None else ""
    name = asked if asked is not None else named or DEFAULT_PLATFORM
    folders = [beside] if beside is not None else []
    if named and world is not None:
        folders.append(Path(world.file).parent)
    return next((str(folder / name) for folder in folders if name.endswith(".toml") and (folder / name).is_file()), name)


__all__ = ["Inputs", "Request", "check_world", "read_inputs", "read_robot"]
