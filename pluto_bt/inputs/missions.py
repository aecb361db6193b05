"""Missions as the commands need them: found, loaded with the user's plugins and inputs, checked."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pluto_bt.files import find_file
from pluto_bt.inputs.option_values import read_ports
from pluto_bt.inputs.plugins import load_plugins
from pluto_bt.source import Faults

if TYPE_CHECKING:
    from pluto_bt.trees.checks import Examined


def examine_file(
    path: Path,
    shown_name: str,
    nodes: Iterable[type] = (),
    tree: str | None = None,
    ports: Mapping[str, str] | None = None,
    models: Sequence[str] = (),
    whole: bool = True,
) -> Examined:
    """Every fault of a mission, as `examine_mission` finds them, with the topics of the robot. Without `ports`, inputs may be missing."""
    from pluto_bt.modules.topic_globals import TopicGlobals
    from pluto_bt.trees.checks import examine_mission

    return examine_mission(path, nodes, tree=tree, ports=ports, topics=TopicGlobals(), file=shown_name, models=models, whole=whole)


def check_mission_file(name: str, tree: str | None, settings: Sequence[str], models: Sequence[str], faults: Faults) -> Examined | None:
    """Find and check a mission; inputs may be missing as long as none is given. None if there is no such file."""
    path = find_file("mission", name, faults)
    ports = read_ports(settings, faults)
    if path is None:
        return None
    examined = examine_file(path, name, tree=tree, ports=ports or None, models=models)
    faults.extend(examined.faults)
    return examined


def load_for_drawing(name: str, tree: str | None, plugins: Sequence[str]) -> Any:
    """A mission without robot or world, for `pluto tree`: inputs may be missing, and entries that nothing writes.

    Raises: InputError with every fault found.
    """
    from pluto_bt.trees import load_mission

    faults = Faults()
    load_plugins(plugins, faults)
    path = find_file("mission", name, faults)
    if path is not None:
        faults.extend(examine_file(path, name, tree=tree, whole=False).faults)
    faults.raise_errors()
    assert path is not None  # else there was a fault
    return load_mission(path, tree=tree, ports=None, file=name)
