"""Missions as the commands need them: found, loaded with the user's plugins and inputs, checked."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from pluto_bt.commands.files import find_file
from pluto_bt.commands.option_values import read_ports
from pluto_bt.commands.plugins import load_plugins
from pluto_bt.source import Fault, Faults


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
