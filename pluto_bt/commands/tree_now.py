"""The tree at one moment, to be drawn: of a run in this process, of a black box, of a robot behind a gateway."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING

import msgspec

from pluto_bt.blackboard.messages import NodeState, TreeState
from pluto_bt.trees.dump import Drawn, hang_below, nested
from pluto_bt.trees.loader.registry import is_port_name, node_types

if TYPE_CHECKING:
    from pluto_bt.record.box import Box, Now, TreeNow
    from pluto_bt.system import System


def form_of_terminal() -> str:
    """How trees are drawn where the output goes: `unicode` where it can show that, else `ascii`."""
    encoding = getattr(sys.stdout, "encoding", None) or "ascii"
    return "unicode" if encoding.lower().startswith("utf") else "ascii"


def of_system(system: System) -> Drawn | None:
    """The tree at work as the topic `tree` tells it; what the nodes say is newer than that. None before the first tick."""
    sample = system.board.newest("tree")
    if sample is None or not isinstance(sample.value, TreeState):
        return None
    core, now_s = system.executive.core, system.clock.now_s()
    at_work = [activity.mission for activity in (core.active, core.job) if activity is not None]
    known = {one.path: one for mission in at_work for one in mission.nodes()}
    flat = []
    for state in sample.value.nodes:
        tracked = known.get(state.path)
        if tracked is None:  # the topic still tells of a tree that has gone
            return None
        kind = tracked.plan.node_type.kind if tracked.plan.node_type is not None else "SubTree"
        flat.append((state.depth, _of_state(state, kind, tracked.node.feedback_message, now_s)))
    return _joined(flat)


def of_gateway(address: str) -> Drawn | None:
    """The tree of a running robot. None if nothing was ticked yet. Raises: GatewayError, InputError."""
    from pluto_bt.commands.gateway_call import reach
    from pluto_bt.gateway.client import GatewayError

    with reach(address) as client:
        try:
            value = client.request("get", topic="tree")
        except GatewayError as error:
            if error.code == "no-value":
                return None
            raise
    now_s = float(value.get("stamp", "0")) + float(value.get("age", "0"))
    states = [msgspec.convert(one.attrib, NodeState, strict=False) for one in value.iter("node")]
    kinds = {node_type.name: node_type.kind for node_type in node_types().values()} | {"SubTree": "SubTree"}
    return _joined((state.depth, _of_state(state, kinds.get(state.kind, "Action"), state.feedback, now_s)) for state in states)


def of_box(box: Box, number: int) -> Drawn | None:
    """The tree in a tick of a black box; leaves that ended in it show how. None if nothing was at work."""
    now = box.now(number)
    trees = [nested(_of_rows(tree, now)) for tree in now.at_work() if tree.tree.nodes]
    return _hung(trees)


def last_at_work(box: Box) -> int:
    """The last tick in which a node was RUNNING; after its end a tree has forgotten how its nodes stood. -1 if there is none."""
    for number in range(len(box) - 1, -1, -1):
        if any("R" in branch.nodes for branch in box.tick(number).trees):
            return number
    return len(box) - 1


def _of_state(state: NodeState, kind: str, feedback: str, now_s: float) -> Drawn:
    return Drawn(kind, state.kind, state.name, [], [], state.status, feedback, now_s - state.since_s)


def _of_rows(tree: TreeNow, now: Now) -> Iterable[tuple[int, Drawn]]:
    from pluto_bt.record.entries import STATUS_OF_LETTER

    ended = {i: STATUS_OF_LETTER[letter] for branch in now.tick.trees if branch.run == tree.tree.run for i, letter in branch.finished}
    for i, (row, status, feedback, since_ns) in enumerate(tree.rows()):
        ports = [(name, value) for name, value in row.ports.items() if is_port_name(name)]
        conditions = [(name, value) for name, value in row.ports.items() if name.startswith("_")]
        shown = ended.get(i, status) if status == "IDLE" else status
        for_s = (now.tick.t_ns - since_ns) / 1e9 if shown == status else 0.0
        yield row.depth, Drawn(row.sort, row.kind, row.name, ports, conditions, shown, feedback, for_s)


def _joined(flat: Iterable[tuple[int, Drawn]]) -> Drawn | None:
    """The trees of a list, in which each begins with depth 1, as one: that of a job below the leaf that waits for it."""
    lists: list[list[tuple[int, Drawn]]] = []
    for depth, node in flat:
        if depth == 1:
            lists.append([])
        lists[-1].append((depth, node))
    return _hung([nested(one) for one in lists])


def _hung(trees: list[Drawn]) -> Drawn | None:
    for job in trees[1:]:
        hang_below(trees[0], job)
    return trees[0] if trees else None
