"""What there is besides topics, as the gateway describes it: every node with its ports, every parameter, every module."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pluto_bt.gateway.replies import Item
from pluto_bt.modules.live_parameters import NAMES
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.runtime.parameters import Parameter, describe, unit_of

if TYPE_CHECKING:
    from pluto_bt.runtime.supervision import Part
    from pluto_bt.runtime.table import Module
    from pluto_bt.trees.loader.registry import NodeType
    from pluto_bt.trees.ports import PortModel


def catalogue(parts: Sequence[Part]) -> tuple[Item, ...]:
    """All items, by kind, each kind in the order of its table."""
    from pluto_bt.trees.loader.registry import node_types

    nodes = [_node(node) for _, node in sorted(node_types().items())]
    return (*nodes, *map(_param, describe(RobotFile)), *(_module(part.module) for part in parts))


def _node(node: NodeType) -> Item:
    return Item({"kind": "node", "name": node.name, "class": node.kind}, tuple(map(_port, node.ports.values())), node.description)


def _port(port: PortModel) -> dict[str, str]:
    from pluto_bt.trees.dump.palette import default_text

    told = {"name": port.name, "type": port.form, "direction": port.direction, "required": "true" if port.required else "false"}
    unit = unit_of(port.name) if "_" in port.name else ""
    return told | {
        word: text
        for word, text in (("unit", unit), ("default", default_text(port) if port.default is not None else ""), ("doc", port.description))
        if text
    }


def _param(row: Parameter) -> Item:
    live = "true" if row.name in NAMES else "false"
    facts = {"kind": "param", "name": row.name, "type": row.kind, "unit": row.unit, "range": row.range, "default": row.default, "live": live}
    return Item(facts, (), row.doc)


def _module(row: Module) -> Item:
    """A module; `period_s` 0 = it steps only when it is woken."""
    facts = {"kind": "module", "name": row.name, "group": row.group, "period_s": f"{row.period_s:g}", "budget_ms": f"{row.budget_ms:g}",
             "needs": " ".join(row.needs), "wakes": " ".join(row.wakes), "critical": "true" if row.critical else "false"}  # fmt: skip
    doc = (row.load().__doc__ or "").strip().partition("\n")[0]
    return Item(facts, (), doc)
