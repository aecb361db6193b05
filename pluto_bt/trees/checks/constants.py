"""Values that are certain at a place of the mission, and do not fit what is done with them there.

The tree is walked in order with the entries whose value is known: literals, inputs, and what scripts make of them. They are reckoned with by
the very functions that run scripts and read ports, so what is told is what the tick would say. What a branch may or may not have written, what
others write in the same round, and what leaves write is not known.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any, Final

from pluto_bt.source import Place
from pluto_bt.source.xml_reader import XmlAttribute
from pluto_bt.trees.checks.entries import Home, Use, home_key, home_of, script_uses
from pluto_bt.trees.checks.flow import ONCE
from pluto_bt.trees.checks.outcomes import PRE_CONDITIONS
from pluto_bt.trees.engine.conditions import POST_CONDITIONS
from pluto_bt.trees.enums import plugin_enums
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.pointers import key_of
from pluto_bt.trees.loader.report import Report
from pluto_bt.trees.ports import PortModel, range_problem
from pluto_bt.trees.scopes import EMPTY, Board, Entry, Scope
from pluto_bt.trees.script import ScriptSyntaxError, parse_script
from pluto_bt.trees.script.names import uses_of
from pluto_bt.trees.script.terms import Env, Term
from pluto_bt.trees.script.values import ScriptError, shown, truth
from pluto_bt.trees.values import SCRIPT, PortProblem

IN_ORDER: Final = ("Sequence", "AsyncSequence", "SequenceWithMemory", "SubTree")  # what comes next finds all that came before done
ASKED: Final = {"ScriptCondition": "code", "Precondition": "if"}  # the script of these ports must come to true or false


Uses = Mapping[int, tuple[list[Use], list[Use]]]  # by id of a plan: before its children are ticked, and after


class Constants:
    """One walk through a mission."""

    def __init__(self, board: Board, uses: Uses, given: Collection[str], report: Report, *, is_closed: bool) -> None:
        """`given`: keys of root entries that others may write; without `is_closed` leaves may write any, and faults are warnings."""
        self._uses = uses
        self._own: dict[int, tuple[Home, ...]] = {}  # what each node itself writes, by id of the plan
        self._board, self._given, self._is_closed, self._report = board, given, is_closed, report
        self._enums = plugin_enums()
        self._shadows = Board()  # owns what stands for the mission's entries here
        self._entries: dict[Home, Entry | None] = {}  # as they are at the node that is looked at; None = not known
        self._since: dict[Home, Place] = {}
        self._shared: frozenset[Home] = frozenset()  # others write them while the nodes that are looked at work
        self._told = {(fault.file, fault.line, fault.column) for fault in report.faults.in_order() if fault.severity == "error"}

    def visit(self, plan: Plan) -> bool:
        """Look at a node and all below it; False if a condition whose value is known keeps what comes after in its Sequence from being reached."""
        conditions = {name: self._script(plan, plan.element.attributes.get(name), is_asked=True) for name, _, _ in PRE_CONDITIONS}
        self._forget_writes(plan, conditions)
        if any(conditions[name] is deciding for name, deciding, _ in PRE_CONDITIONS):
            self._forget(self._written(plan))
            return True
        says = self._ports(plan)
        if says is not False:
            self._children(plan)
        for name in POST_CONDITIONS:
            self._script(plan, plan.element.attributes.get(name), is_asked=False)
        self._forget_writes(plan, POST_CONDITIONS)
        return says is not False or plan.type_name != "ScriptCondition"

    def _children(self, plan: Plan) -> None:
        is_in_order, outer, is_reached = plan.type_name in IN_ORDER, self._shared, True
        if plan.children and plan.type_name not in ONCE:
            written = self._written(plan)
            self._forget(written)  # an earlier round may have written them
            self._shared = outer if len(plan.children) == 1 else outer | written
        for child in plan.children:
            is_reached = is_reached and self.visit(child)
            if not (is_in_order and is_reached) or any(name in child.element.attributes for name, _, _ in PRE_CONDITIONS):
                self._forget(self._written(child))
            is_reached = is_reached or not is_in_order
        self._shared = outer

    def _ports(self, plan: Plan) -> bool | None:
        """What the ports read must fit, what they write is not known; the answer of a condition's script, None if that is not known."""
        says = None
        for port in plan.node_type.ports.values() if plan.node_type is not None else ():
            attribute = plan.element.attributes.get(port.name)
            key = key_of(port.name, attribute.value) if attribute is not None else None
            if port.kind is SCRIPT and key is None:
                said = self._script(plan, attribute, is_asked=ASKED.get(plan.type_name) == port.name)
                says = said if says is None else says
            elif attribute is not None and key is not None and port.direction == "in" and port.kind.typed and not port.kind.raw:
                self._port(plan, port, attribute, key)
        self._forget(home_key(plan, use.key) for use in self._uses[id(plan)][0] if use.how != "read" and not use.in_script)
        if plan.type_name == "UnsetBlackboard":
            self._forget([home_key(plan, plan.element.get("key"))])
        return says

    def _port(self, plan: Plan, port: PortModel, attribute: XmlAttribute, key: str) -> None:
        entry = self._known(plan.scope, key)
        if entry is None or entry.value is EMPTY:
            return
        try:
            problem = range_problem(port, port.kind.convert(entry.value))
        except PortProblem as misfit:
            problem = str(misfit)
        if problem:
            what = f'entry "{key}" is {shown(entry.value)} here, which does not fit port "{port.name}"'
            home = home_key(plan, key)
            is_input = home not in self._since and home[0] == id(self._board.root)
            mend = f"it is an input: give another value with --port {home[1]}=VALUE" if is_input else ""
            self._tell(attribute.value_place, "bad-literal", what, port.form, problem, self._since.get(home), mend)
            self._forget([home])

    def _script(self, plan: Plan, attribute: XmlAttribute | None, *, is_asked: bool) -> bool | None:
        """Run what can be run of a script; what it answers if `is_asked`, None if that is not known."""
        if attribute is None or key_of(attribute.name, attribute.value) is not None:
            return None
        try:
            statements = parse_script(attribute.value).statements
        except ScriptSyntaxError:
            return None  # told by the static check
        says = None
        for number, statement in enumerate(statements, 1):
            says = self._statement(plan, attribute, statement, is_asked=is_asked and number == len(statements))
        return says

    def _statement(self, plan: Plan, attribute: XmlAttribute, statement: Term, *, is_asked: bool) -> bool | None:
        uses = tuple(uses_of(statement))
        homes = [home_key(plan, use.name) for use in uses]
        targets = {home: attribute.place_at(use.position) for home, use in zip(homes, uses, strict=True) if use.how != "read"}
        entries = [self._known(plan.scope, use.name) for use in uses]
        if any(entry is None or (entry.value is EMPTY and use.how != "write") for entry, use in zip(entries, uses, strict=True)):
            self._forget(targets)
            return None
        says = None
        try:
            value = statement.value(Env(_Known(self, plan.scope), self._enums))  # type: ignore[arg-type]  # a script only finds and declares
            says = truth(value, "the condition") if is_asked else None
        except ScriptError as error:
            place = attribute.place_at(uses[0].position) if uses else attribute.value_place
            since = next((self._since[home] for home in homes if home in self._since), None)
            self._tell(place, "script-fails", "this script fails whenever it runs here", "values that go together", str(error), since)
            self._forget(targets)
        else:
            self._since.update(targets)
        return says

    def _known(self, scope: Scope, key: str) -> Entry | None:
        """What stands for an entry, without value if it has none yet; None if it is not known what it has."""
        owner, name = home_of(scope, key)
        home = id(owner), name
        if home not in self._entries:
            self._entries[home] = self._at_first(owner, name)
        return None if home in self._shared else self._entries[home]

    def _at_first(self, owner: Scope, name: str) -> Entry | None:
        """An entry before the first tick."""
        entry = owner.entries.get(name)
        has_value = entry is not None and entry.value is not EMPTY
        is_elsewhere = owner is self._board.root and (name in self._given or name in self._board.topic_names)
        if not has_value and is_elsewhere:
            return None
        shadow = Entry(self._shadows, entry.kind if entry is not None else None)
        shadow.value = entry.value if entry is not None else EMPTY
        return shadow

    def _written(self, plan: Plan) -> frozenset[Home]:
        """What a node and all below it may write."""
        return frozenset(home for one in plan.walk() for home in self._own_writes(one))

    def _own_writes(self, plan: Plan) -> tuple[Home, ...]:
        found = self._own.get(id(plan))
        if found is None:
            found = self._own[id(plan)] = tuple(home_key(plan, use.key) for uses in self._uses[id(plan)] for use in uses if use.how != "read")
        return found

    def _forget(self, homes: Iterable[Home]) -> None:
        for home in homes:
            self._entries[home] = None

    def _forget_writes(self, plan: Plan, names: Iterable[str]) -> None:
        """What conditions write: they may run at each tick, or not at all."""
        attributes = [plan.element.attributes[name] for name in names if name in plan.element.attributes]
        self._forget(home_key(plan, use.key) for attribute in attributes for use in script_uses(attribute) if use.how != "read")

    def _tell(self, place: Place, code: str, what: str, expected: str, found: str, since: Place | None, mend: str = "") -> None:
        if (place.file, place.line, place.column) in self._told:
            return
        self._told.add((place.file, place.line, place.column))
        tell = self._report.late if self._is_closed else self._report.warning
        mend = f"its value comes from {since.file or '<text>'}:{since.line}:{since.column}" if since is not None else mend
        tell(place, code, what, expected=expected, found=found, mend=mend)


class _Known:
    """The scope that scripts run in here."""

    def __init__(self, constants: Constants, scope: Scope) -> None:
        self._constants, self._scope = constants, scope

    def find(self, key: str) -> Any:
        """The entry's stand-in."""
        return self._constants._known(self._scope, key)
