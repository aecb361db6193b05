"""Every node type with its ports, as a table for people and as the palette for Groot2; both are made from the classes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from xml.sax.saxutils import escape, quoteattr

from pluto_bt.behaviours.ports import text_of
from pluto_bt.trees.engine.status import NAME_OF_STATUS
from pluto_bt.trees.loader.registry import NodeType, node_types
from pluto_bt.trees.ports import PortModel

TAGS = {"in": "input_port", "out": "output_port", "inout": "inout_port"}
TYPE_NAMES = {"string": "std::string", "script": "std::string", "any": "BT::AnyTypeAllowed"}
ARROWS = {"in": "→", "out": "←", "inout": "↔"}


def nodes_table(types: Mapping[str, NodeType] | None = None) -> str:
    """One block a node: name, kind, what it does, and one line a port; of all that is registered if no types are given."""
    lines: list[str] = []
    for node_type in _sorted((types or node_types()).values()):
        lines.append(f"{node_type.name:<26} {node_type.kind:<10} {node_type.description}".rstrip())
        for port in node_type.ports.values():
            facts = [port.form, f"default {default_text(port)}" if port.default is not None else "", "optional" if _optional(port) else ""]
            about = "; ".join(fact for fact in facts if fact)
            lines.append(f"    {ARROWS[port.direction]} {port.name:<22} {about}{' – ' + port.description if port.description else ''}")
    return "\n".join(lines) + "\n"


def nodes_xml(types: Mapping[str, NodeType] | None = None, *, builtin: bool = False) -> str:
    """A file with a TreeNodesModel that Groot2 imports as a palette; Groot2 knows the built-in nodes itself."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', '<root BTCPP_format="4">', "  <TreeNodesModel>"]
    for node_type in _sorted((types or node_types()).values()):
        if builtin or not node_type.builtin:
            lines += model_lines(node_type, "    ")
    return "\n".join([*lines, "  </TreeNodesModel>", "</root>"]) + "\n"


def model_lines(node_type: NodeType, indent: str) -> list[str]:
    """The model of one node type; what it does stands in its metadata, where BehaviorTree.CPP keeps such words."""
    name = quoteattr(node_type.name)
    if not node_type.ports and not node_type.description:
        return [f"{indent}<{node_type.kind} ID={name}/>"]
    lines = [f"{indent}<{node_type.kind} ID={name}>"]
    for port in node_type.ports.values():
        tag, kind = TAGS[port.direction], TYPE_NAMES.get(port.kind.name, port.kind.name)
        default = f" default={quoteattr(default_text(port))}" if port.default is not None else ""
        text = escape(f"{port.description} ({port.form})" if port.description else port.form)
        lines.append(f'{indent}  <{tag} name="{port.name}" type={quoteattr(kind)}{default}>{text}</{tag}>')
    if node_type.description:
        metadata = f"<Metadata description={quoteattr(node_type.description)}/>"
        lines.append(f"{indent}  <MetadataFields>{metadata}</MetadataFields>")
    return [*lines, f"{indent}</{node_type.kind}>"]


def default_text(port: PortModel) -> str:
    """The default as a mission file would hold it."""
    name = NAME_OF_STATUS.get(port.default) if port.kind.name == "NodeStatus" and not isinstance(port.default, str) else None
    return name or text_of(port.default)


def _optional(port: PortModel) -> bool:
    return port.direction != "out" and not port.required and port.default is None


def _sorted(types: Iterable[NodeType]) -> list[NodeType]:
    order = ("Control", "Decorator", "Condition", "Action")
    return sorted(types, key=lambda one: (one.builtin, order.index(one.kind) if one.kind in order else len(order), one.name))
