"""What one node does with entries of the blackboard: which it reads before it works, which it may write."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator
from typing import Final, NamedTuple

from pluto_bt.source import Place
from pluto_bt.source.xml_reader import XmlAttribute
from pluto_bt.trees.engine.conditions import POST_CONDITIONS, PRE_CONDITIONS
from pluto_bt.trees.enums import plugin_enums
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.pointers import key_of
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.scopes import EMPTY, Scope
from pluto_bt.trees.script import ScriptSyntaxError
from pluto_bt.trees.script.names import How, names_used
from pluto_bt.trees.values import SCRIPT

Home = tuple[int, str]  # the scope that owns an entry, and its key there
# Ports of built-in nodes that take an entry without value for an answer: no update, an empty queue, the default branch, FAILURE
PATIENT: Final = frozenset(("entry", "queue", "variable"))


class Use(NamedTuple):
    """One use of an entry.

    Attributes:
        attribute: where it stands; `position` counts characters in its value.
        how: `change` is an assignment to an entry that must be there.
        fails: a read of an entry without value ends the mission, or the node.
        in_script: named in a script, not in braces.
    """

    key: str
    attribute: XmlAttribute
    position: int
    how: How
    fails: bool
    in_script: bool

    @property
    def place(self) -> Place:
        """Where the name stands."""
        return self.attribute.place_at(self.position) if self.in_script else self.attribute.value_place


def home_of(scope: Scope, key: str) -> tuple[Scope, str]:
    """The scope and key that own what `key` means in `scope`, whether there is an entry yet or not (`Scope.find`)."""
    if key.startswith("@"):
        return home_of(scope.board.root, key[1:])
    if key in scope.entries or scope.parent is None:
        return scope, key
    if key in scope.remap:
        return home_of(scope.parent, scope.remap[key])
    return home_of(scope.parent, key) if scope.autoremap and not key.startswith("_") else (scope, key)


def home_key(plan: Plan, key: str) -> Home:
    """What `key` means at a node, as a key of a table."""
    owner, name = home_of(plan.scope, key)
    return id(owner), name


def written_homes(nodes: Iterable[Plan]) -> set[Home]:
    """The entries that some node writes while the mission runs."""
    return {home_key(one, use.key) for one in nodes for use in (*uses_before(one), *uses_after(one)) if use.how != "read"}


def known_text(plan: Plan, port: str, written: Container[Home]) -> str | None:
    """The text that a port has whenever it is read: a literal, or an entry that has a value before the first tick and that nothing writes."""
    attribute = plan.element.attributes.get(port)
    if attribute is None:
        return None
    key = key_of(port, attribute.value)
    if key is None:
        return attribute.value
    entry = plan.scope.find(key)
    if entry is None or entry.value is EMPTY or home_key(plan, key) in written:
        return None
    return str(entry.value)


def uses_before(plan: Plan) -> list[Use]:
    """What a node reads and writes before its children are ticked: pre-conditions, inputs, its own script."""
    found = _conditions(plan, PRE_CONDITIONS)
    if plan.node_type is not None:
        for port in plan.node_type.ports.values():
            attribute = plan.element.attributes.get(port.name)
            if attribute is not None:
                found += _port_uses(plan, port, attribute)
    return found


def uses_after(plan: Plan) -> list[Use]:
    """The scripts that run when it has ended."""
    return _conditions(plan, POST_CONDITIONS)


def _conditions(plan: Plan, names: tuple[str, ...]) -> list[Use]:
    attributes = plan.element.attributes
    return [use for name in names if name in attributes for use in script_uses(attributes[name])]


def script_uses(attribute: XmlAttribute) -> Iterator[Use]:
    """What a script reads and writes; the names of enums are numbers, not entries."""
    enums = plugin_enums()
    try:
        uses = names_used(attribute.value)
    except ScriptSyntaxError:
        return  # told by the static check
    for use in uses:
        if use.how == "read" and use.name in enums:
            continue
        yield Use(use.name, attribute, use.position, use.how, True, True)


def _port_uses(plan: Plan, port: PortModel, attribute: XmlAttribute) -> list[Use]:
    assert plan.node_type is not None  # the caller looked
    key = key_of(port.name, attribute.value)
    if port.kind is SCRIPT and key is None:
        return list(script_uses(attribute))
    is_setter = plan.node_type.builtin and port.name == "output_key"
    if is_setter and key is None:
        return [Use(attribute.value, attribute, 0, "write", False, False)]
    if key is None and port.name == "entry" and plan.node_type.builtin:
        return [Use(attribute.value, attribute, 0, "read", False, False)]
    if key is None:
        return []
    found = []
    if port.direction != "out":
        found.append(Use(key, attribute, 0, "read", _fails(plan, port), False))
    if port.direction != "in" and not is_setter:
        found.append(Use(key, attribute, 0, "write", False, False))
    return found


def _fails(plan: Plan, port: PortModel) -> bool:
    """True if the node cannot work without a value at `port`."""
    assert plan.node_type is not None  # the caller looked
    if plan.node_type.builtin:
        return port.name not in PATIENT and not (plan.node_type.name == "SetBlackboard" and port.name == "value")
    return port.direction == "in" and port.required and port.default is None
