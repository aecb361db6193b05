"""Missions as the commands need them: found, loaded with the user's plugins and inputs, checked."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from pluto_bt.commands.files import find_file
from pluto_bt.commands.option_values import read_ports
from pluto_bt.source import Fault, Faults, Place


def mission_faults(
    path: Path, shown_name: str, nodes: Iterable[type] = (), tree: str | None = None, ports: Mapping[str, str] | None = None
) -> tuple[Fault, ...]:
    """Every fault of a mission, also those that BehaviorTree.CPP finds only while ticking. Without `ports`, inputs may be missing."""
    from pluto_bt.modules.topic_globals import TopicGlobals
    from pluto_bt.trees import check_mission

    return check_mission(path, nodes, tree=tree, ports=ports, topics=TopicGlobals(), file=shown_name)


def check_mission_file(name: str, tree: str | None, settings: Sequence[str], faults: Faults) -> Path | None:
    """Find and check a mission; inputs may be missing as long as none is given. None if there is no such file."""
    path = find_file("mission", name, faults)
    ports = read_ports(settings, faults)
    if path is not None:
        faults.extend(mission_faults(path, name, tree=tree, ports=ports or None))
    return path


def load_plugins(modules: Sequence[str], faults: Faults) -> None:
    """Import `--plugin` modules (also from the working folder) and installed entry points of the group `pluto_bt.nodes`."""
    if modules and str(Path.cwd()) not in sys.path:
        sys.path.insert(0, str(Path.cwd()))
    for name in modules:
        _import(name.removesuffix(".py"), f"--plugin {name}", faults)
    for point in entry_points(group="pluto_bt.nodes"):
        _import(point.value.partition(":")[0], f"entry point {point.name}", faults)


def _import(name: str, asked_by: str, faults: Faults) -> None:
    try:
        importlib.import_module(name)
    except (Exception, SystemExit) as error:  # a plugin may raise anything while it is imported
        faults.error(Place(asked_by), "bad-plugin", f"cannot import {name}: {type(error).__name__}: {error}",
                     mend="give the name of a Python module, found from the working folder")  # fmt: skip


def load_for_drawing(name: str, tree: str | None, plugins: Sequence[str]) -> Any:
    """A mission without robot or world, for `pluto tree`. Inputs that have no default may be missing.

    Raises: InputError with every fault found.
    """
    from pluto_bt.trees import load_mission

    faults = Faults()
    load_plugins(plugins, faults)
    path = check_mission_file(name, tree, (), faults)
    faults.raise_errors()
    assert path is not None
    return load_mission(path, tree=tree, ports=None, file=name)
