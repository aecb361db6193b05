"""The node types that a mission may use: those built in, every py_trees leaf with ports, and models of foreign ones."""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Final

from py_trees.ports import get_ports_registry

import pluto_bt.behaviours.catalogue  # noqa: F401  # the library's own leaves enter py_trees' registry by being imported
from pluto_bt.behaviours.missing import MISSING, MISSING_CONDITIONS
from pluto_bt.trees.controls import CONTROLS
from pluto_bt.trees.decorators import DECORATORS
from pluto_bt.trees.engine.node import DecoratorNode, Node
from pluto_bt.trees.enums import learn_enums
from pluto_bt.trees.leaves import LEAVES
from pluto_bt.trees.nav2 import NAV2_NODES
from pluto_bt.trees.ports import Direction, PortModel, models_of_class

EXPLICIT_TAGS: Final = ("Action", "Condition", "Control", "Decorator", "SubTree")
_FORBIDDEN = re.compile(r"""[<>&"'/\\:*?|. \t\r\n\x00-\x1f\x7f]""")


@dataclass(frozen=True)
class NodeType:
    """One type of node.

    Attributes:
        kind: Action, Condition, Control or Decorator.
        make: the class; None for a model without implementation, and for what our robots lack.
        children: fewest and most children while ticking (None: no limit).
        missing: what our robots lack for it, of a node that is known by name alone; "" for all others.
        builtin: True for the nodes of BehaviorTree.CPP itself.
    """

    name: str
    kind: str
    ports: dict[str, PortModel] = field(default_factory=dict)
    make: Any = None
    children: tuple[int, int | None] = (0, 0)
    builtin: bool = False
    description: str = ""
    missing: str = ""

    @property
    def is_ours(self) -> bool:
        """True for what pluto_bt itself brings to missions; a user's leaf may do what its ports do not tell."""
        return self.builtin or bool(self.missing) or getattr(self.make, "__module__", "").startswith(("pluto_bt.behaviours.", "pluto_bt.trees."))


def name_problem(name: str) -> str:
    """Why `name` cannot be the ID of a tree or a node type, or ""."""
    if not name:
        return "it is empty"
    if name in ("Root", "root"):
        return f"'{name}' is reserved"
    found = _FORBIDDEN.search(name)
    return f"character {found[0]!r} is not allowed" if found else ""


def is_port_name(name: str) -> bool:
    """True if an attribute of this name is a port; others are `name`, `ID`, conditions and private ones."""
    return bool(name) and name[0].isalpha() and name not in ("name", "ID")


def builtin_types() -> dict[str, NodeType]:
    """The nodes of BehaviorTree.CPP."""
    found = {}
    for name, kind in [*CONTROLS.items(), *DECORATORS.items(), *LEAVES.items()]:
        found[name] = _own_type(name, kind, builtin=True)
    return found


def node_types(nodes: Iterable[Any] = (), plugins: Iterable[str] = ()) -> dict[str, NodeType]:
    """Every type by name: registered py_trees leaves, Nav2's controls, then `nodes`, then the built-in ones, later ones hiding earlier.

    Args:
        nodes: classes of leaves (py_trees' `BehaviourWithPorts`), or of our own ControlNode and DecoratorNode.
        plugins: modules to import first; what they define is registered by that.
    Raises: ImportError; ValueError for `ENUMS` of a plugin that cannot be.
    """
    for plugin in plugins:
        problems = learn_enums(importlib.import_module(plugin))
        if problems:
            raise ValueError(f"{plugin}: {'; '.join(problems)}")
    registry = get_ports_registry()
    tags = {cls: tag for tag, cls in registry.items()}
    types = {name: _missing_type(name, *row) for name, row in MISSING.items()}
    types |= {tag: _leaf_type(tag, cls) for tag, cls in registry.items()}
    types |= {name: _own_type(name, cls, builtin=False) for name, cls in NAV2_NODES.items()}
    for cls in nodes:
        name = tags.get(cls, cls.__name__)
        types[name] = _own_type(name, cls, builtin=False) if issubclass(cls, Node) else _leaf_type(name, cls)
    return types | builtin_types()


def _own_type(name: str, cls: type[Node], *, builtin: bool) -> NodeType:
    children: tuple[int, int | None] = (1, 1) if issubclass(cls, DecoratorNode) else getattr(cls, "CHILDREN", (0, 0))
    return NodeType(name, cls.KIND, cls.PORTS, cls, children, builtin, _about(cls))


@cache
def _leaf_type(tag: str, cls: Any) -> NodeType:
    """Made once for each class: a job of motion loads its tree while the robot drives."""
    kind = "Condition" if getattr(cls, "KIND", "Action") == "Condition" else "Action"
    return NodeType(tag, kind, models_of_class(cls), cls, (0, 0), builtin=False, description=_about(cls))


def _missing_type(name: str, why: str, inputs: str, outputs: str) -> NodeType:
    """A node that is known by name, so that its ports are not told as faults beside it; without a class."""
    sides: tuple[tuple[Direction, str], ...] = (("in", inputs), ("out", outputs))
    ports = {port: PortModel(port, side, required=False) for side, names in sides for port in names.split()}
    kind = "Condition" if name in MISSING_CONDITIONS else "Action"
    return NodeType(name, kind, ports, description=f"Not there yet: {why}.", missing=why)


def _about(cls: Any) -> str:
    """The first paragraph of its docstring, on one line."""
    paragraph = (cls.__dict__.get("__doc__") or "").strip().partition("\n\n")[0]
    return " ".join(paragraph.split())
