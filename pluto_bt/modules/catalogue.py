"""What there is besides topics, as the gateway describes it: every node with its ports, every parameter, every module, the goals of the map."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from pluto_bt.behaviours.destinations import HOME
from pluto_bt.gateway.replies import Item
from pluto_bt.modules.live_parameters import NAMES
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.runtime.parameters import Parameter, describe, unit_of

if TYPE_CHECKING:
    from pluto_bt.maps.world import World
    from pluto_bt.runtime.supervision import Part
    from pluto_bt.runtime.table import Module
    from pluto_bt.trees.loader.registry import NodeType
    from pluto_bt.trees.ports import PortModel


def catalogue(parts: Sequence[Part], places: World | None = None) -> tuple[Item, ...]:
    """All items, by kind, each kind in the order of its table."""
    from pluto_bt.trees.loader.registry import node_types

    nodes = [_node(node) for _, node in sorted(node_types().items())]
    return (*nodes, *map(_param, describe(RobotFile)), *(_module(part.module) for part in parts), *_goals(places))


def _goals(places: World | None) -> Iterator[Item]:
    """The places that missions may name, and where the robot lives."""
    if places is None:
        return
    for goal in (*places.goals, *(() if places.home is None else (replace(places.home, id=HOME),))):
        heading = "" if goal.theta_rad is None else f", theta {math.degrees(goal.theta_rad):g}°"
        yield Item({"kind": "goal", "name": goal.id}, (), f"x {goal.x_m:g} m, y {goal.y_m:g} m{heading}")


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
