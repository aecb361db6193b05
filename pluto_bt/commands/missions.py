"""Missions as the commands need them: found, loaded with the user's plugins and inputs, checked."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from pluto_bt.commands.files import find_file
from pluto_bt.commands.inputs import Request, read_ports
from pluto_bt.source import Fault, Faults, Place


def check_mission_file(request: Request) -> tuple[Fault, ...]:
    """Every fault of a mission file, also those that BehaviorTree.CPP finds only while ticking.

    Raises: InputError if it cannot even be looked at.
    """
    from pluto_bt.trees import check_mission

    faults = Faults()
    path = find_file("mission", request.mission, faults)
    ports = read_ports(request.port, faults)
    load_plugins(request.plugin, faults)
    faults.raise_errors()
    assert path is not None
    return tuple(check_mission(path, tree=request.tree, ports=ports or None, file=request.mission))


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
    except Exception as error:  # a plugin may raise anything while it is imported
        faults.error(Place(asked_by), "bad-plugin", f"cannot import {name}: {type(error).__name__}: {error}",
                     mend="give the name of a Python module, found from the working folder")  # fmt: skip


def load_for_drawing(request: Request) -> Any:
    """A mission without robot or world, for `pluto tree`. Inputs that have no default may be missing."""
    from pluto_bt.trees import load_mission

    faults = Faults()
    path = find_file("mission", request.mission, faults)
    load_plugins(request.plugin, faults)
    faults.raise_errors()
    assert path is not None
    return load_mission(path, tree=request.tree, ports=None, file=request.mission)
