"""Node types that are known from a model in TreeNodesModel alone: checked as far as the model says, never run."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Final

from pluto_bt.source.xml_reader import XmlElement
from pluto_bt.trees.loader.files import Model, ModelPort
from pluto_bt.trees.loader.registry import NodeType
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.python_types import kind_of_type
from pluto_bt.trees.values import ANYTHING, BOOL, DOUBLE, INT, INT64, SCRIPT, STATUS, STRING, UINT, Kind

# C++ type names as BehaviorTree.CPP, Groot and Nav2 write them; others mean nothing here and are not checked
KINDS: Final[dict[str, Kind]] = {
    "int": INT, "int32_t": INT, "int16_t": INT, "int8_t": INT, "short": INT, "int64_t": INT64, "long": INT64, "long long": INT64,
    "unsigned": UINT, "unsigned int": UINT, "uint": UINT, "uint8_t": UINT, "uint16_t": UINT, "uint32_t": UINT, "size_t": UINT,
    "double": DOUBLE, "float": DOUBLE, "bool": BOOL, "std::string": STRING, "string": STRING, "BT::NodeStatus": STATUS, "NodeStatus": STATUS,
    "script": SCRIPT, "BT::Script": SCRIPT,
    "vector<int>": kind_of_type(list[int]), "vector<double>": kind_of_type(list[float]), "vector<float>": kind_of_type(list[float]),
    "vector<bool>": kind_of_type(list[bool]), "vector<string>": kind_of_type(list[str]),
}  # fmt: skip
_CHILDREN: Final[dict[str, tuple[int, int | None]]] = {"Control": (1, None), "Decorator": (1, 1)}


def add_models(types: dict[str, NodeType], models: Iterable[Model]) -> None:
    """Make modelled nodes known. A leaf of ours gives way where the model has ports that it has not: the file means another node of that name."""
    for model in models:
        ours = types.get(model.name)
        if ours is None or not (ours.builtin or model.ports.keys() <= ours.ports.keys()):
            types[model.name] = foreign_type(model)


def foreign_type(model: Model) -> NodeType:
    """The node type that a model describes. Which inputs are needed a model does not tell, so none is."""
    ports = {name: _port(port) for name, port in model.ports.items()}
    return NodeType(model.name, model.tag, ports, None, _CHILDREN.get(model.tag, (0, 0)), description=_about(model.element))


def kind_of_cpp(type_name: str) -> Kind:
    """The kind of a C++ type name; `ANYTHING` for those that mean nothing here."""
    plain = re.sub(r"\bstd::|\bconst\b|[&\s]+$|__cxx11::|,\s*std::allocator<.*", "", type_name.strip()).strip()
    plain = plain.replace("basic_string<char", "string").replace(" >", ">")
    return KINDS.get(type_name.strip()) or KINDS.get(plain) or ANYTHING


def _port(port: ModelPort) -> PortModel:
    default = port.default
    if default is not None and len(default) >= 2 and default[0] == default[-1] == '"':
        default = default[1:-1]  # Nav2's palette writes texts with quotes inside the attribute
    return PortModel(port.name, port.direction, kind_of_cpp(port.type_name), default, required=False, description=port.description)


def _about(element: XmlElement) -> str:
    return next((child.text.strip() for child in element.children if child.tag == "description"), "")
