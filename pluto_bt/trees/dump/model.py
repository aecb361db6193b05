"""What all pictures are drawn from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

from pluto_bt.blackboard.messages import NodeState
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.registry import is_port_name

# fill and line colours by status; "" is a tree that is not running
COLOURS: Final = {
    "": ("#f6f8fa", "#57606a"),
    "IDLE": ("#f6f8fa", "#8c959f"),
    "RUNNING": ("#fff3c4", "#9a6700"),
    "SUCCESS": ("#d2f4d9", "#1a7f37"),
    "FAILURE": ("#ffd7d5", "#cf222e"),
    "SKIPPED": ("#dbe9ff", "#0969da"),
}
SIGNS: Final = {"Control": ("{c}", "▣"), "Decorator": ("{d}", "◇"), "SubTree": ("{t}", "▤"), "Action": ("[a]", "▶"), "Condition": ("(c)", "?")}


@dataclass(slots=True)
class Drawn:
    """One node of a picture. `ports` and `conditions` are the attributes as written."""

    kind: str
    type: str
    name: str
    ports: list[tuple[str, str]]
    conditions: list[tuple[str, str]]
    status: str = ""
    feedback: str = ""
    children: list[Drawn] = field(default_factory=list)

    @property
    def title(self) -> str:
        """`Type` or `Type "name"`."""
        return self.type if self.name == self.type else f"{self.type} “{self.name}”"

    def walk(self) -> Iterator[Drawn]:
        """This node and all below, depth first."""
        yield self
        for child in self.children:
            yield from child.walk()


def drawn(plan: Plan, states: Mapping[int, NodeState] | None) -> Drawn:
    """The picture's tree of a plan; `states` by number of the node."""
    state = (states or {}).get(plan.uid)
    attributes = [(one.name, one.value) for one in plan.element.attributes.values()]
    node = Drawn(
        kind=plan.node_type.kind if plan.node_type is not None else "SubTree",
        type=plan.node_type.name if plan.node_type is not None else plan.tree_id,
        name=plan.name,
        ports=[(name, value) for name, value in attributes if is_port_name(name)],
        conditions=[(name, value) for name, value in attributes if name.startswith("_") and name not in ("_description", "_uid", "_fullpath")],
        status=state.status if state is not None else "",
        feedback=state.feedback if state is not None else "",
    )
    node.children = [drawn(child, states) for child in plan.children]
    return node
