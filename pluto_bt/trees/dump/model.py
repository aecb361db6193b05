"""What all pictures are drawn from."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
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


SHORTEST_SHOWN_S: Final = 0.05  # what is shorter is "just now"


@dataclass(slots=True)
class Drawn:
    """One node of a picture. `ports` and `conditions` are the attributes as written; `for_s` is how long it has been in its status."""

    kind: str
    type: str
    name: str
    ports: list[tuple[str, str]]
    conditions: list[tuple[str, str]]
    status: str = ""
    feedback: str = ""
    for_s: float = 0.0
    children: list[Drawn] = field(default_factory=list)

    @property
    def title(self) -> str:
        """`Type` or `Type "name"`."""
        return self.type if self.name == self.type else f"{self.type} “{self.name}”"

    @property
    def state(self) -> str:
        """Its status and how long it has had it: `RUNNING 3.2 s`; "" for a tree that is not running."""
        return f"{self.status} {self.for_s:.1f} s" if self.for_s >= SHORTEST_SHOWN_S and self.status != "IDLE" else self.status

    def walk(self) -> Iterator[Drawn]:
        """This node and all below, depth first."""
        yield self
        for child in self.children:
            yield from child.walk()


def nested(flat: Iterable[tuple[int, Drawn]]) -> Drawn:
    """The tree of nodes that stand in a list, depth first, each with its depth from 1. The list must not be empty."""
    open_nodes: list[Drawn] = []
    for depth, node in flat:
        del open_nodes[depth - 1 :]
        if open_nodes:
            open_nodes[-1].children.append(node)
        open_nodes.append(node)
    return open_nodes[0]


def hang_below(root: Drawn, job: Drawn) -> None:
    """Show the tree of a job below the leaf that waits for it: the deepest one that is RUNNING, the first where several are."""
    waiting = [node for node in root.walk() if node.status == "RUNNING" and not any(child.status == "RUNNING" for child in node.children)]
    if waiting:
        waiting[0].children.append(job)


def folded(root: Drawn, most: int) -> Drawn:
    """The tree in so many nodes if it can be had: what lies below a node that is not RUNNING is left out, and counted in its feedback."""
    if sum(1 for _ in root.walk()) <= most:
        return root
    inner = sum(1 for _ in root.walk()) - 1
    if root.status != "RUNNING" and inner:
        words = f"{root.feedback}, " if root.feedback else ""
        return replace(root, feedback=f"{words}{inner} nodes below", children=[])
    return replace(root, children=[folded(child, 1) for child in root.children])


def drawn(plan: Plan, states: Mapping[int, NodeState] | None, now_s: float = 0.0) -> Drawn:
    """The picture's tree of a plan; `states` by number of the node, at the time `now_s` of the run."""
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
        for_s=now_s - state.since_s if state is not None else 0.0,
    )
    node.children = [drawn(child, states, now_s) for child in plan.children]
    return node
