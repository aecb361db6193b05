"""Leaves and enums from outside: `--plugin MODULE`, and installed packages with the entry-point group `pluto_bt.nodes`."""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Sequence
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType

from py_trees.ports import PortsMixin, get_ports_registry, register_ports_class

from pluto_bt.source import Faults, Place
from pluto_bt.trees.enums import ATTRIBUTE, learn_enums
from pluto_bt.trees.loader.registry import NodeType, node_types

GROUP = "pluto_bt.nodes"
PORTS = ("INPUT_PORTS", "OUTPUT_PORTS")


def load_plugins(modules: Sequence[str], faults: Faults) -> None:
    """Import the modules, which registers their leaves; they are also looked for in the working folder."""
    if modules and str(Path.cwd()) not in sys.path:
        sys.path.insert(0, str(Path.cwd()))
    for name in modules:
        _import(name.removesuffix(".py"), Place(f"--plugin {name}"), faults)
    for point in entry_points(group=GROUP):
        _import(point.value.partition(":")[0], Place(f"entry point {point.name}"), faults)


def _import(name: str, asked_at: Place, faults: Faults) -> None:
    known = node_types()
    before = set(get_ports_registry().values())
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Ports class tag")  # told below
            module = importlib.import_module(name)
    except (Exception, SystemExit) as error:  # a plugin may raise anything while it is imported
        faults.error(asked_at, "bad-plugin", f"cannot import {name}: {type(error).__name__}: {error}",
                     mend="give the name of a Python module, found from the working folder")  # fmt: skip
        return
    leaves = _leaves_of(module)
    leaves += [leaf for leaf in get_ports_registry().values() if leaf not in before and leaf not in leaves]  # of the modules that it imports
    for leaf in leaves:
        _tell_missing_ports(leaf, asked_at, faults)
        _keep_name(leaf, known, asked_at, faults)
    for problem in learn_enums(module):
        faults.error(asked_at, "bad-enum", problem, mend=f'write {ATTRIBUTE} = {{"RED": 0, "GREEN": 1}}, each name with one number')
    if not leaves and not getattr(module, ATTRIBUTE, None):
        faults.warning(asked_at, "no-nodes", f"the module {name} has no nodes and no {ATTRIBUTE}")


def _leaves_of(module: ModuleType) -> list[type[PortsMixin]]:
    """The leaves that a module defines itself."""
    values = vars(module).values()
    return [value for value in values if isinstance(value, type) and issubclass(value, PortsMixin) and value.__module__ == module.__name__]


def _tell_missing_ports(leaf: type[PortsMixin], asked_at: Place, faults: Faults) -> None:
    missing = [name for name in PORTS if not hasattr(leaf, name)]
    if missing:
        what = f"leaf {leaf.__name__} does not declare {' and '.join(missing)}, so it is no node yet"
        mend = " and ".join(f"{name} = {{}}" for name in missing)
        faults.error(asked_at, "leaf-without-ports", what, mend=f"add {mend} to the class, or the ports it has")


def _keep_name(leaf: type[PortsMixin], known: dict[str, NodeType], asked_at: Place, faults: Faults) -> None:
    """Refuse a leaf with the name of a node that there is already, and give the name back to that one."""
    tag = next((tag for tag, cls in get_ports_registry().items() if cls is leaf), leaf.__name__)
    node = known.get(tag)
    if node is None or node.make is None or node.make is leaf:
        return  # a node that our robots lack is known by name alone: who brings it is welcome
    owner = "pluto_bt" if node.is_ours else node.make.__module__
    what = f"leaf {leaf.__name__} of {leaf.__module__} has the name of a node of {owner}"
    faults.error(asked_at, "taken-name", what, expected="a name of its own", found=tag, mend=f"rename the class, for example My{tag}")
    if isinstance(node.make, type) and issubclass(node.make, PortsMixin):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            register_ports_class(tag, node.make)
