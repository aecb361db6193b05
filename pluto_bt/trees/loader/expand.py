"""Expands the main tree: every SubTree instance with its scope, every node with its path and number. Makes no node yet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from pluto_bt.source import Place, did_you_mean
from pluto_bt.source.xml_reader import XmlAttribute, XmlElement
from pluto_bt.trees.loader.files import MissionFiles, TreeSource
from pluto_bt.trees.loader.pointers import key_of
from pluto_bt.trees.loader.registry import EXPLICIT_TAGS, NodeType, is_port_name
from pluto_bt.trees.loader.report import Report
from pluto_bt.trees.scopes import Board, Entry, Scope
from pluto_bt.trees.values import SCRIPT, STRING, PortProblem, declared_value, kind_of_value, parse_bool

MAX_NODES: Final = 50_000
MAX_DEPTH: Final = 256  # nodes inside one another, SubTrees counted


@dataclass(slots=True)
class Plan:
    """One node to be made; `node_type` is None for a SubTree."""

    element: XmlElement
    node_type: NodeType | None
    name: str
    path: str
    uid: int
    depth: int
    scope: Scope
    tree_id: str = ""
    children: list[Plan] = field(default_factory=list)

    @property
    def type_name(self) -> str:
        """As statuses and errors show it."""
        return self.node_type.name if self.node_type is not None else "SubTree"

    def walk(self) -> list[Plan]:
        """This node and all below, depth first."""
        found, waiting = [], [self]
        while waiting:
            plan = waiting.pop()
            found.append(plan)
            waiting.extend(reversed(plan.children))
        return found


class TooManyNodes(Exception):  # noqa: N818  it only ends the expansion; the fault is in the report
    """The limit of nodes is reached."""


class Expansion:
    """One expansion of a mission."""

    def __init__(self, files: MissionFiles, types: Mapping[str, NodeType], board: Board, report: Report) -> None:
        self._files, self._types, self._board, self._report = files, types, board, report
        self._uid = 0
        self._subtree_paths: dict[str, Place] = {}
        self._declared_at: dict[int, Place] = {}
        self._literals: dict[int, XmlAttribute] = {}  # entries whose kind comes from a literal on a SubTree tag
        self._by_models: set[int] = set()  # entries whose kind is only what the model of a foreign node says
        self._entries: list[Entry] = []  # keeps them alive, so that their ids stay theirs
        self.used: dict[str, None] = {}

    def run(self, tree: TreeSource) -> Plan | None:
        """The plan of the main tree, or None if it is too large (or broken, as the report says)."""
        self.used[tree.tree_id] = None
        try:
            return self._node(tree.body, self._board.root, "", 1, (tree.tree_id,)) if tree.element.children else None
        except TooManyNodes:
            return None

    def _node(self, element: XmlElement, scope: Scope, prefix: str, depth: int, open_trees: tuple[str, ...]) -> Plan | None:
        self._uid += 1
        if self._uid > MAX_NODES:
            what = "the mission has too many nodes"
            self._report.error(element.place, "too-many-nodes", what, expected=f"at most {MAX_NODES}", found="more", mend="SubTrees count each time")
            raise TooManyNodes
        if self._report.faults.is_full:
            raise TooManyNodes
        if depth > MAX_DEPTH:
            self._report.error(element.place, "too-deep", "nodes are nested too deeply", expected=f"at most {MAX_DEPTH} levels", found="more")
            raise TooManyNodes
        if element.tag == "SubTree":
            return self._subtree(element, scope, prefix, depth, open_trees)
        node_type = self._types.get(element.get("ID") if element.tag in EXPLICIT_TAGS else element.tag)
        if node_type is None:
            return None  # told by the static check
        uid = self._uid
        name = element.get("name", node_type.name)
        path = prefix + (name if name != node_type.name else f"{name}::{uid}")
        plan = Plan(element, node_type, name, path, uid, depth, scope)
        self._declare_ports(plan)
        for child in element.children:
            made = self._node(child, scope, prefix, depth + 1, open_trees)
            if made is not None:
                plan.children.append(made)
        return plan

    def _subtree(self, element: XmlElement, scope: Scope, prefix: str, depth: int, open_trees: tuple[str, ...]) -> Plan | None:
        attribute = element.attributes.get("ID")
        tree = self._tree_of(attribute, open_trees)
        if attribute is None or tree is None:
            return None
        uid, tree_id = self._uid, attribute.value
        given = element.attributes.get("name")
        inner = prefix + (given.value if given is not None else f"{tree_id}::{uid}")
        earlier = self._subtree_paths.get(inner)
        if earlier is not None:
            place = (given or attribute).value_place
            what = f"two SubTrees have the path {inner!r}; the other is at {_shown(earlier)}"
            self._report.error(place, "duplicate-path", what, expected="a name of its own", found=inner)
        self._subtree_paths[inner] = element.place
        name = element.get("name", tree_id)
        path = prefix + (name if name != tree_id else f"{name}::{uid}")
        plan = Plan(element, None, name, path, uid, depth, scope, tree_id)
        self.used[tree_id] = None
        inside = self._inner_scope(element, tree_id, scope, inner)
        body = self._node(tree.body, inside, inner + "/", depth + 1, (*open_trees, tree_id))
        if body is not None:
            plan.children.append(body)
        return plan

    def _tree_of(self, attribute: XmlAttribute | None, open_trees: tuple[str, ...]) -> TreeSource | None:
        if attribute is None or attribute.value in self._types:
            return None  # told by the static check
        tree = self._files.trees.get(attribute.value)
        if tree is None and not self._files.is_whole:
            return None  # it may be in the file that could not be read
        if tree is None:
            mend, what = did_you_mean(attribute.value, self._files.trees), f"there is no tree {attribute.value!r}"
            known = "one of: " + ", ".join(self._files.trees)
            self._report.error(attribute.value_place, "unknown-tree", what, expected=known, found=attribute.value, mend=mend)
        elif attribute.value in open_trees:
            circle = " → ".join((*open_trees[open_trees.index(attribute.value) :], attribute.value))
            what = f"tree {attribute.value!r} contains itself"
            self._report.error(attribute.value_place, "recursion", what, expected="no circle", found=circle)
            return None
        return tree if tree is not None and tree.element.children else None

    def _inner_scope(self, element: XmlElement, tree_id: str, parent: Scope, name: str) -> Scope:
        """The scope of a SubTree instance: mapped names, literals, defaults of its model."""
        scope = Scope(self._board, parent, name)
        try:
            autoremap = parse_bool(element.get("_autoremap", "false"))
        except ValueError:
            autoremap = False  # told by the static check
        values = {attribute.name: attribute.value for attribute in element.attributes.values() if is_port_name(attribute.name)}
        if not autoremap:
            self._add_defaults(element, tree_id, values)
        model, literals = self._files.subtree_models.get(tree_id), {}
        declared = model.ports if model is not None else {}
        for port, value in values.items():
            key = key_of(port, value) if value != "=" else None
            if key is None:
                literals[port] = declared_value(value, declared[port].type_name if port in declared else "")
            else:
                scope.remap[port] = key
        for port, literal in literals.items():
            scope.write(port, literal)  # before autoremap is switched on: a literal is always local
            if port in element.attributes and (entry := scope.find(port)) is not None:
                self._literals[id(entry)] = element.attributes[port]
        scope.autoremap = autoremap
        return scope

    def _add_defaults(self, element: XmlElement, tree_id: str, values: dict[str, str]) -> None:
        model = self._files.subtree_models.get(tree_id)
        for port in model.ports.values() if model is not None else ():
            if port.name in values:
                continue
            if port.default:
                values[port.name] = port.default
            else:
                what = f'<SubTree ID="{tree_id}"> needs port "{port.name}"'
                self._report.error(element.place, "missing-port", what, expected=f'{port.name}="…": {port.description or "a value"}', found="nothing")

    def _declare_ports(self, plan: Plan) -> None:
        """Typed ports give their entries a kind; a second, different kind is refused unless the first is text."""
        if plan.node_type is None:
            return
        for port in plan.node_type.ports.values():
            attribute = plan.element.attributes.get(port.name)
            key = key_of(port.name, attribute.value) if attribute is not None else None
            if attribute is None or key is None:
                continue
            kind = STRING if port.kind is SCRIPT else port.kind
            entry = plan.scope.find(key)
            if entry is None:
                try:
                    entry = plan.scope.declare(key, kind if kind.typed else None)
                except PortProblem as problem:
                    self._report.error(attribute.value_place, "bad-key", str(problem), expected="a key", found=attribute.value)
                    continue
                self._declared_at[id(entry)] = attribute.value_place
                self._entries.append(entry)
                if plan.node_type.make is None:
                    self._by_models.add(id(entry))
            elif entry.kind is not None and entry.kind.typed and kind.typed and entry.kind is not kind and entry.kind is not STRING:
                self._type_clash(plan.node_type, attribute, port.name, key, entry, kind.name)

    def _type_clash(self, node_type: NodeType, attribute: XmlAttribute, port: str, key: str, entry: Entry, kind: str) -> None:
        holds = entry.kind.name if entry.kind is not None else ""
        first, place = self._declared_at.get(id(entry)), attribute.value_place
        literal = self._literals.get(id(entry)) if first is None else None
        if literal is not None:  # told where it stands, not in the tree that it is given to
            what = f'entry "{key}" holds {holds}, as this literal is read; port "{port}" at {_shown(place)} needs {kind}'
            place = literal.value_place
            mend = _mend_of_literal(literal.value, holds, kind)
        else:
            where = f" since {_shown(first)}" if first is not None else ""
            what = f'entry "{key}" holds {holds}{where}; port "{port}" needs {kind}'
            is_literal = first is None and kind_of_value(entry.value) is not None
            mend = _mend_of_literal(str(entry.value), holds, kind) if is_literal else "use another entry"
        is_sure = node_type.make is not None and id(entry) not in self._by_models  # models are often careless about types
        tell = self._report.error if is_sure else self._report.warning
        tell(place, "type-clash", what, expected=kind, found=holds, mend=mend)


def _shown(place: Place) -> str:
    return f"{place.file or '<text>'}:{place.line}:{place.column}"


def _mend_of_literal(text: str, holds: str, kind: str) -> str:
    """How a value on a SubTree tag, or of `--port`, that was read as `holds` becomes a `kind`."""
    if kind == STRING.name:
        return f'declare the port in TreeNodesModel with type="{kind}": then digits are text'
    if (holds, kind) == ("int", "double"):
        return f'write "{text}.0", or declare the port as {kind} in TreeNodesModel'
    return "write the literal as the port needs it"
