"""What a monitor may see of one mission: its nodes in the order of the protocol, their status bytes, their changes, its blackboards."""

from __future__ import annotations

import struct
from collections import deque
from typing import Any, Final

from pluto_bt.behaviours.ports import text_of
from pluto_bt.trees import Mission
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.scopes import EMPTY, Scope, TopicEntry

CODES: Final[dict[Result, int]] = {IDLE: 0, RUNNING: 1, SUCCESS: 2, FAILURE: 3, SKIPPED: 4}
WENT_IDLE: Final = 10  # added to the status that a node had before it became IDLE
KEPT_CHANGES: Final = 1000
LONGEST_TEXT: Final = 1000  # characters of a value that is no number
STATUS: Final = struct.Struct("<HB")
_AS_IS: Final = (bool, int, float, str)


class Shown:
    """One mission. `after_tick` is called by the thread that ticks, all else by the one that serves; bytes and deques are handed over whole."""

    def __init__(self, mission: Mission, tree_id: bytes) -> None:
        self.mission, self.tree_id = mission, tree_id
        self.instances = instances_of(mission.nodes()[0].plan)
        by_plan = {id(one.plan): one for one in mission.nodes()}
        self._nodes = [by_plan[id(plan)].node for _, plans in self.instances for plan in plans]
        self._uids = [plan.uid for _, plans in self.instances for plan in plans]
        self._codes = bytes(len(self._nodes))
        self._changes: deque[bytes] | None = None
        self._since_ns = 0

    def after_tick(self, now_ns: int) -> None:
        """Take the statuses, and note what changed if a client records."""
        codes = bytes([_code(node) for node in self._nodes])
        changes, before = self._changes, self._codes
        if changes is not None and codes != before:
            stamp = max((now_ns - self._since_ns) // 1000, 0).to_bytes(6, "little")
            for uid, old, new in zip(self._uids, before, codes, strict=True):
                if old != new:
                    changes.extend(stamp + STATUS.pack(uid, step) for step in steps_between(old, new))
        self._codes = codes

    def statuses(self) -> bytes:
        """Three bytes a node: its number and its status."""
        return b"".join([STATUS.pack(uid, code) for uid, code in zip(self._uids, self._codes, strict=True)])

    def record(self, now_ns: int) -> None:
        """Note changes from now on."""
        self._since_ns, self._changes = now_ns, deque(maxlen=KEPT_CHANGES)

    def stop_recording(self) -> None:
        """Note no more."""
        self._changes = None

    def take_changes(self) -> bytes:
        """Nine bytes a change, oldest first, and forget them."""
        changes = self._changes
        return b"".join([changes.popleft() for _ in range(len(changes))]) if changes else b""

    def boards(self, names: list[str]) -> dict[str, dict[str, Any] | None]:
        """The entries of the subtree instances of these names; below the main tree also its own, under the name ROOT. Unknown names are left out."""
        scopes = {path: plans[0].scope for path, plans in self.instances}
        scopes[self.mission.name] = scopes.pop("")
        found = {name: _entries(scopes[name]) for name in names if name in scopes}
        below = [name for name in found if name != self.mission.name]
        return {**found, "ROOT": _entries(scopes[self.mission.name])} if below else found


def instances_of(root: Plan) -> list[tuple[str, list[Plan]]]:
    """Every subtree instance in the order in which it is made: (path, its nodes depth first). A SubTree node belongs to the tree it stands in."""
    found: list[tuple[str, list[Plan]]] = []

    def add(plan: Plan, nodes: list[Plan]) -> None:
        nodes.append(plan)
        for child in plan.children:
            if plan.node_type is not None:
                add(child, nodes)
            else:
                begin(child)

    def begin(plan: Plan) -> None:
        nodes: list[Plan] = []
        found.append((plan.scope.name, nodes))
        add(plan, nodes)

    begin(root)
    return found


def steps_between(old: int, new: int) -> list[int]:
    """The statuses that a node took on its way from one byte to the other: what a tick began, ended and wiped away is told as well."""
    if new < WENT_IDLE:
        return [new]
    ended = new - WENT_IDLE
    return [0] if ended == old else [ended, 0]


def _code(node: Any) -> int:
    if node.status is not IDLE:
        return CODES[node.status]
    return 0 if node.last is IDLE or node.last is SKIPPED else WENT_IDLE + CODES[node.last]


def _entries(scope: Scope) -> dict[str, Any] | None:
    """A copy; the mission may write while it is made. None if there is nothing."""
    entries = [(key, entry.value) for key, entry in list(scope.entries.items()) if not isinstance(entry, TopicEntry)]
    return {key: _plain(value) for key, value in entries if value is not EMPTY} or None


def _plain(value: Any) -> Any:
    if type(value) in _AS_IS:
        return value if type(value) is not int or -(2**63) <= value < 2**64 else str(value)
    try:
        return text_of(value)[:LONGEST_TEXT]
    except RuntimeError:  # a queue that the mission changes meanwhile
        return None
