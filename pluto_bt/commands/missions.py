"""Missions as the commands need them: found, loaded with the user's plugins and inputs, checked."""

from __future__ import annotations

from typing import Any

from pluto_bt.commands.files import find_file
from pluto_bt.commands.inputs import Request, read_ports
from pluto_bt.commands.plugins import load_plugins
from pluto_bt.source import Fault, Faults


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


def load_for_drawing(request: Request) -> Any:
    """A mission without robot or world, for `pluto tree`. Inputs that have no default may be missing."""
    from pluto_bt.trees import load_mission

    faults = Faults()
    path = find_file("mission", request.mission, faults)
    load_plugins(request.plugin, faults)
    faults.raise_errors()
    assert path is not None
    return load_mission(path, tree=request.tree, ports=None, file=request.mission)
