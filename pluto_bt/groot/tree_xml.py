"""The XML that a monitor is sent: one tree for each subtree instance, each node with its number, each port with its value."""

from __future__ import annotations

from pluto_bt.groot.snapshot import instances_of
from pluto_bt.trees.dump.groot import attribute_text
from pluto_bt.trees.dump.palette import default_text, model_lines
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.registry import is_port_name, node_types

_TOOLS = ("_uid", "_fullpath", "_description")


def tree_xml(main: str, root: Plan) -> str:
    """The whole document; `main` is the ID of the main tree. `_fullpath` joins a SubTree node with its tree, `_uid` a node with its status."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', '<root BTCPP_format="4">']
    ids = {"": main, **{_inner(plan): plan.tree_id for plan in root.walk() if plan.node_type is None}}
    for path, plans in instances_of(root):
        lines.append(f'  <BehaviorTree ID="{attribute_text(ids[path])}" _fullpath="{attribute_text(path)}">')
        _add(plans[0], 2, lines)
        lines.append("  </BehaviorTree>")
    lines.append("  <TreeNodesModel>")
    for node_type in node_types().values():
        lines += model_lines(node_type, "    ")
    return "\n".join([*lines, "  </TreeNodesModel>", "</root>"]) + "\n"


def _inner(subtree: Plan) -> str:
    """The path of the instance that a SubTree node makes."""
    return subtree.children[0].scope.name if subtree.children else subtree.path


def _add(plan: Plan, level: int, lines: list[str]) -> None:
    tag = plan.node_type.name if plan.node_type is not None else "SubTree"
    indent, head = "  " * level, f'{tag} {" ".join(_attributes(plan))}'
    children = plan.children if plan.node_type is not None else []
    if not children:
        lines.append(f"{indent}<{head}/>")
        return
    lines.append(f"{indent}<{head}>")
    for child in children:
        _add(child, level + 1, lines)
    lines.append(f"{indent}</{tag}>")


def _attributes(plan: Plan) -> list[str]:
    given = {name: one.value for name, one in plan.element.attributes.items() if name not in ("ID", "name", *_TOOLS)}
    if plan.node_type is None:
        shown = {"ID": plan.tree_id, "_fullpath": _inner(plan)}
    else:
        shown = {"name": plan.name}
        shown |= {port.name: default_text(port) for port in plan.node_type.ports.values() if port.default is not None and port.name not in given}
    ports = {name: value for name, value in given.items() if is_port_name(name)}
    conditions = {name: value for name, value in given.items() if not is_port_name(name)}
    everything = {**shown, "_uid": str(plan.uid), **ports, **conditions}
    return [f'{name}="{attribute_text(value)}"' for name, value in everything.items()]
