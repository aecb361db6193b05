"""Leaves from outside: `--plugin MODULE`, and installed packages with the entry-point group `pluto_bt.nodes`."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence
from importlib.metadata import entry_points
from pathlib import Path

from py_trees.ports import PortsMixin, get_ports_registry

from pluto_bt.source import Faults, Place

GROUP = "pluto_bt.nodes"


def load_plugins(modules: Sequence[str], faults: Faults) -> None:
    """Import the modules, which registers their leaves; they are also looked for in the working folder."""
    if modules and str(Path.cwd()) not in sys.path:
        sys.path.insert(0, str(Path.cwd()))
    for name in modules:
        _import(name.removesuffix(".py"), f"--plugin {name}", faults)
    for point in entry_points(group=GROUP):
        _import(point.value.partition(":")[0], f"entry point {point.name}", faults)


def _import(name: str, asked_by: str, faults: Faults) -> None:
    known = set(get_ports_registry().values())
    try:
        module = importlib.import_module(name)
    except (Exception, SystemExit) as error:  # a plugin may raise anything while it is imported
        faults.error(Place(asked_by), "bad-plugin", f"cannot import {name}: {type(error).__name__}: {error}",
                     mend="give the name of a Python module, found from the working folder")  # fmt: skip
        return
    leaves = [value for value in vars(module).values() if isinstance(value, type) and issubclass(value, PortsMixin) and value.__module__ == name]
    for leaf in leaves:
        if not (hasattr(leaf, "INPUT_PORTS") and hasattr(leaf, "OUTPUT_PORTS")):
            faults.error(Place(asked_by), "leaf-without-ports", f"leaf {leaf.__name__} does not declare its ports, so it is no node yet",
                         mend="add INPUT_PORTS = {} and OUTPUT_PORTS = {} to the class")  # fmt: skip
    if not leaves and set(get_ports_registry().values()) == known:
        faults.warning(Place(asked_by), "no-nodes", f"the module {name} has no nodes")
