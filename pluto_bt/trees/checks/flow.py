"""Entries that are read before anything can have written them.

The tree is walked in the order of its first ticks. Where nodes are ticked again and again (Repeat, reactive and parallel nodes, …) a later
node may have written in an earlier round, so only reads that the very first round is certain to come to are held to that order.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Final

from pluto_bt.source import Place, did_you_mean
from pluto_bt.source.xml_reader import XmlAttribute, XmlElement
from pluto_bt.trees.checks.entries import Home, Use, home_of, script_uses, uses_after, uses_before
from pluto_bt.trees.checks.outcomes import GUARDS, Ends, S
from pluto_bt.trees.engine.conditions import CONDITIONS
from pluto_bt.trees.enums import plugin_enums
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.pointers import key_of
from pluto_bt.trees.loader.report import Report
from pluto_bt.trees.scopes import EMPTY, Board, Scope

ONCE: Final = frozenset((
    "Sequence", "AsyncSequence", "SequenceWithMemory", "Fallback", "AsyncFallback", "IfThenElse", "TryCatch", "SubTree", "Inverter", "ForceSuccess",
    "ForceFailure", "Timeout", "Delay", "RunOnce", "Precondition", "SkipUnlessUpdated", "WaitValueUpdate",
))  # fmt: skip


class Flow:
    """One walk through a mission.

    Attributes:
        is_closed: no leaf but ours, which write what their ports tell and nothing else.
        loose: keys that nodes name of which nothing is known.
        uses: by id of a plan, before its children are ticked, and after.
    """

    def __init__(self, board: Board, inputs: Mapping[str, object], ends: Mapping[int, Ends], report: Report) -> None:
        """`inputs` are root entries that the caller gives; `ends` says by id of a plan how it can end."""
        self._board, self._ends, self._report = board, ends, report
        self._inputs = inputs
        self._written: set[Home] = set()
        self._in_rounds: frozenset[Home] = frozenset()  # what the nodes that are ticked again and again may write
        self._writers: dict[Home, Place] = {}
        self.uses: dict[int, tuple[list[Use], list[Use]]] = {}
        self._told = {(fault.file, fault.line, fault.column) for fault in report.faults.in_order() if fault.severity == "error"}
        self.is_closed = True
        self.loose: set[str] = set()
        self._tags: dict[int, XmlElement] = {}  # by id of the scope inside: the SubTree tag

    def run(self, nodes: list[Plan]) -> None:
        """Check; `nodes` is the whole mission in the order of `Plan.walk`."""
        self.is_closed = all(plan.node_type is None or plan.node_type.is_ours for plan in nodes)
        for plan in nodes:
            self.loose.update(_unknown_keys(plan))
            if plan.node_type is None and plan.children:
                self._tags[id(plan.children[0].scope)] = plan.element
            self.uses[id(plan)] = before, after = uses_before(plan), uses_after(plan)
            for use in (*before, *after):
                if use.how == "write":
                    self._writers.setdefault(self._home(plan.scope, use.key), use.place)
        self._visit(nodes[0], certain=True)

    def run_beside(self, scripts: Iterable[XmlAttribute]) -> None:
        """Tell of contracts, which look at the root entries all the time, where they name what is never written: they would never be judged.

        To be called after `run`.
        """
        root = self._board.root
        for use in (use for attribute in scripts for use in script_uses(attribute)):
            home = self._home(root, use.key)
            if home not in self._writers and not self._is_given(root, use.key):
                self._tell(root, use, home, in_contract=True)

    def _visit(self, plan: Plan, certain: bool) -> None:
        certain = certain and not any(name in plan.element.attributes for name in GUARDS)
        before, after = self.uses[id(plan)]
        self._take(plan, before, certain)
        outer = self._in_rounds
        if plan.children and not outer and plan.type_name not in ONCE:
            uses = [(one.scope, use) for one in plan.walk() for some in self.uses[id(one)] for use in some]
            self._in_rounds = frozenset(self._home(scope, use.key) for scope, use in uses if use.how == "write")
            certain = True  # whether a tick comes here or not: the first one that does finds no earlier round
        for child in plan.children:
            self._visit(child, certain)
            certain = certain and self._ends[id(child)] == S
        self._in_rounds = outer
        self._take(plan, after, certain=False)

    def _take(self, plan: Plan, uses: list[Use], certain: bool) -> None:
        for use in uses:
            home = self._home(plan.scope, use.key)
            is_written = home in self._written or (home in self._in_rounds and not certain)
            is_there = use.how == "change" and plan.scope.find(use.key) is not None  # a port has declared it
            if use.how != "write" and not is_written and not is_there and not self._is_given(plan.scope, use.key):
                self._tell(plan.scope, use, home)
            if use.how != "read":
                self._written.add(home)
                self._check_may_write(plan.scope, use)

    def _check_may_write(self, scope: Scope, use: Use) -> None:
        owner, name = home_of(scope, use.key)
        place = use.place
        if owner is not self._board.root or name not in self._board.topic_names or (place.file, place.line, place.column) in self._told:
            return
        self._told.add((place.file, place.line, place.column))
        what, mend = f'"{use.key}" is a topic of the robot, which a mission only reads', "write an entry of your own"
        self._report.late(place, "read-only", what, expected="an entry", found=f"the topic {name}", mend=mend)

    def _home(self, scope: Scope, key: str) -> Home:
        owner, name = home_of(scope, key)
        return id(owner), name

    def _is_given(self, scope: Scope, key: str) -> bool:
        """True for entries that have a value before the first tick, topics, and what cannot be known here."""
        owner, name = home_of(scope, key)
        entry = owner.find(name)
        if (entry is not None and entry.value is not EMPTY) or name in self.loose or name in self._board.topic_names:
            return True
        return owner is self._board.root and (name in self._inputs or (key.startswith("@") and self._board.topics is None))

    def _tell(self, scope: Scope, use: Use, home: Home, *, in_contract: bool = False) -> None:
        place = use.place
        where = place.file, place.line, place.column
        if where in self._told:
            return
        self._told.add(where)
        later = self._writers.get(home)
        owner, name = home_of(scope, use.key)
        is_parents = owner is not scope and not use.key.startswith("@")  # a SubTree tag leads to it
        alias = f' as "{use.key}"' if is_parents and name != use.key else ""
        shown = name if alias else use.key
        code, what, found = "unset-key", f'nothing writes entry "{shown}", which is read here{alias}', "nothing writes it"
        if later is not None:
            what = f'entry "{shown}" is read here{alias} before anything can have written it'
            found = f"it is written at {later.file or '<text>'}:{later.line}:{later.column}"
        elif use.key.startswith("@") and self._board.topics is not None:
            code, what = "unknown-topic", f'there is no topic and no entry "{use.key}"'
        elif use.how == "change":
            what = f'entry "{shown}" does not exist, so nothing can be assigned to it'
        is_sure = self.is_closed or (code == "unknown-topic" and in_contract)  # a leaf of a user's may write entries, but no topics
        report = self._report.late if use.fails and is_sure else self._report.warning
        found += self._tag_that_leads(scope, use.key) if is_parents else ""
        mend = self._mend(owner if is_parents else scope, use, name, later)
        report(place, code, what, expected="an entry that has a value", found=found, mend=mend)

    def _tag_that_leads(self, scope: Scope, key: str) -> str:
        """Where a port of a SubTree tag gives `key` its meaning: the outermost, for there the entry has its own name."""
        told = ""
        while scope.parent is not None and not key.startswith("@"):
            tag, key_outside = self._tags.get(id(scope)), scope.remap.get(key)
            attribute = tag.attributes.get(key) if tag is not None and key_outside is not None else None
            if tag is not None and attribute is not None:
                where, line = attribute.place.file or "<text>", f"{attribute.place.line}:{attribute.place.column}"
                told = f'; {key}="{attribute.value}" of <SubTree ID="{tag.get("ID")}"> at {where}:{line} leads to it'
            elif not scope.autoremap:
                break
            key, scope = key_outside or key, scope.parent
        return told

    def _mend(self, scope: Scope, use: Use, name: str, later: Place | None) -> str:
        """`scope` and `name` are those of the entry, not of the SubTree that reads it."""
        if use.how == "change":
            return "':=' creates the entry"
        if later is not None:
            return "write it earlier, for example with a Script at the beginning"
        bare = name.removeprefix("@")
        if use.key.startswith("@"):
            return did_you_mean(bare, self._board.topic_names).replace('"', '"@', 1)
        parent = scope.parent
        if parent is not None and (self._is_given(parent, bare) or self._home(parent, bare) in self._writers):
            return f'map it on the <SubTree> tag: {bare}="{{{bare}}}"'
        enums, inputs = plugin_enums() if use.in_script else (), self._inputs if parent is None else ()
        near = did_you_mean(bare, [*(name for home, name in self._writers if home == id(scope)), *inputs, *enums])
        if near:
            return near
        if parent is not None:
            return f"the entry is that of the SubTree alone: give the tag a port {bare}"
        quoted = f"a text stands in single quotes: '{bare}'; " if use.in_script else ""
        quoted += "a name for a number comes from ENUMS of a plugin; " if quoted and bare.isupper() else ""
        return f"{quoted}write it first, or declare it as an input in TreeNodesModel"


def _unknown_keys(plan: Plan) -> Iterator[str]:
    """The keys below `plan` in elements that became no node: a node of an unknown type may write them."""
    if len(plan.children) >= len(plan.element.children) or plan.node_type is None:
        return
    known = {id(child.element) for child in plan.children}
    waiting: list[XmlElement] = [child for child in plan.element.children if id(child) not in known]
    while waiting:
        element = waiting.pop()
        waiting += element.children
        for attribute in element.attributes.values():
            key = key_of(attribute.name, attribute.value)
            if key is not None and attribute.name not in CONDITIONS:
                yield key.removeprefix("@")
