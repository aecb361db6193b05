"""Makes the nodes of a plan: builds them, connects their ports, gives them their conditions, sets them up."""

from __future__ import annotations

import uuid
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from typing import Any

from py_trees import ports

from pluto_bt.trees.board_view import BoardView
from pluto_bt.trees.decorators.subtree import SubTree
from pluto_bt.trees.decorators.updated import UpdateWatch
from pluto_bt.trees.engine.conditions import CONDITIONS, guard
from pluto_bt.trees.engine.context import Context
from pluto_bt.trees.engine.leaf import bind_leaf, told
from pluto_bt.trees.engine.node import Node
from pluto_bt.trees.engine.status import SKIPPED, Result
from pluto_bt.trees.errors import RAISED
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.pointers import key_of
from pluto_bt.trees.loader.report import Report
from pluto_bt.trees.loader.steady_parts import remember_steady_parts
from pluto_bt.trees.loader.wiring import Readers, wire, wire_leaf
from pluto_bt.trees.script import ScriptRunner
from pluto_bt.trees.tracked import Tracked


@contextmanager
def _classes_looked_at_once() -> Iterator[None]:
    """py_trees looks at every attribute of a class whenever one is made of it, four fifths of its time; inside, it looks once a class."""
    look = getattr(ports, "_ports_class_is_abstract", None)  # its own affair: another version may do without
    if look is None or hasattr(look, "cache_info"):  # the latter: another mission is being built
        yield
        return
    ports._ports_class_is_abstract = cache(look)
    try:
        yield
    finally:
        ports._ports_class_is_abstract = look


class Construction:
    """Builds one mission."""

    def __init__(self, context: Context, enums: Mapping[str, int], report: Report) -> None:
        self._context, self._enums, self._report = context, enums, report
        self.tracked: list[Tracked] = []

    def run(self, plan: Plan) -> Any:
        """The root node; `tracked` then holds every node, depth first."""
        with _classes_looked_at_once():
            root = self._make(plan, None)
        if not self._report.stops_loading:
            self._set_up()
            remember_steady_parts(self.tracked, plan.scope.board, self._context)
        return root

    def _make(self, plan: Plan, parent: Any) -> Any:
        node = self._build(plan)
        if node is None:
            return None
        if isinstance(node, Node):
            node.number = plan.uid
        else:
            node.id = uuid.UUID(int=plan.uid)
        self.tracked.append(Tracked(node, plan))
        if parent is not None:
            parent.add_child(node)
        for child in plan.children:
            self._make(child, node)
        self._add_conditions(node, plan)
        return node

    def _build(self, plan: Plan) -> Any:
        node_type = plan.node_type
        if node_type is None:
            return self._joined(SubTree(plan.name, tree_id=plan.tree_id))
        try:
            node = node_type.make(name=plan.name)
        except RAISED as error:
            what = f"<{node_type.name}> could not be built: {told(error)}"
            self._report.error(plan.element.place, "leaf-failed", what, expected=f"{node_type.name}(name=…) to work", found=type(error).__name__)
            return None
        readers, writers = wire(plan, node_type.ports)
        if isinstance(node, Node):
            node.readers, node.writers = readers, writers
            self._joined(node)
            self._connect_own(node, plan, readers)
        else:
            wire_leaf(node, node_type.ports, readers, writers)
        return node

    def _joined(self, node: Node) -> Node:
        node.context = self._context
        return node

    def _connect_own(self, node: Any, plan: Plan, readers: Readers) -> None:
        """What some built-in nodes need besides their ports."""
        if hasattr(node, "enums"):
            node.enums = dict(self._enums)
        if hasattr(node, "scope"):
            node.scope = plan.scope
        if hasattr(node, "source_key"):
            node.source_key = key_of("value", plan.element.get("value"))
            node.scope = plan.scope if "value" in plan.element.attributes else None
        if hasattr(node, "watch"):
            text = plan.element.get("entry")
            node.watch = UpdateWatch(plan.scope, key_of("entry", text) or text)
        if hasattr(node, "script"):
            port = "if" if "if" in node.PORTS else "code"
            text = plan.element.get(port)
            is_entry = key_of(port, text) is not None
            node.script = ScriptRunner(plan.scope, self._enums, readers[port] if is_entry else text)

    def _add_conditions(self, node: Any, plan: Plan) -> None:
        attributes = plan.element.attributes
        found = {name: ScriptRunner(plan.scope, self._enums, attributes[name].value, name) for name in CONDITIONS if name in attributes}
        if not isinstance(node, Node):
            bind_leaf(node, self._context)
        if found:
            guard(node, found, self._skip)

    def _skip(self, node: Any) -> Result:
        node.last = SKIPPED
        self._context.skipped.append(node)
        return SKIPPED

    def _set_up(self) -> None:
        """Leaves meet the clock and the blackboard only now: a tree can be drawn with no robot."""
        for tracked in self.tracked:
            if isinstance(tracked.node, Node):
                continue
            try:
                tracked.node.setup(clock=self._context.clock, blackboard=BoardView(tracked.plan.scope))
            except RAISED as error:
                what = f"<{tracked.plan.type_name}> could not be set up: {told(error)}"
                self._report.error(tracked.plan.element.place, "setup-failed", what, expected="setup() to work", found=type(error).__name__)
