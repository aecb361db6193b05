"""What differs between two missions, in terms of trees, nodes and ports; order of attributes, layout and comments do not count.

The children of two nodes are paired so that equal subtrees stay together and nodes of one type and name are seen as changed, not as new.
A subtree that is gone in one place and stands in another, or inside a new node, has moved.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

from pluto_bt.source import Place
from pluto_bt.source.xml_reader import XmlElement
from pluto_bt.trees.loader.files import MissionFiles, Model
from pluto_bt.trees.loader.registry import EXPLICIT_TAGS
from pluto_bt.trees.pairing import Weighed, paired

SIGNS: Final = {"added": "+", "removed": "-", "changed": "~", "moved": ">"}


@dataclass(frozen=True)
class Change:
    """One difference.

    Attributes:
        what: added, removed, changed or moved.
        where: the tree, or the model.
        node: the node and the nodes above it.
        details: one line a port: name, what it was, what it is.
    """

    what: str
    where: str
    node: str = ""
    before: Place | None = None
    after: Place | None = None
    details: tuple[str, ...] = ()

    def as_text(self) -> str:
        """One line, and one for each port."""
        places = " → ".join(f"{place.file or '<text>'}:{place.line}:{place.column}" for place in (self.before, self.after) if place is not None)
        head = f"{SIGNS[self.what]} {self.where}{': ' + self.node if self.node else ''}{'  ' + places if places else ''}"
        return "\n".join([head, *(f"    {line}" for line in self.details)])


@dataclass
class _Side:
    """A node of one of the two missions, with the nodes below; `size` counts them all, `signature` is equal for equal subtrees."""

    element: XmlElement
    type: str
    above: str
    signature: int = 0
    size: int = 1
    children: list[_Side] = field(default_factory=list)

    @property
    def label(self) -> str:
        name = self.element.get("name")
        return f'{self.type} "{name}"' if name else self.type

    @property
    def path(self) -> str:
        return f"{self.above} / {self.label}" if self.above else self.label

    def walk(self) -> Iterator[_Side]:
        """This node and all below."""
        waiting = [self]
        while waiting:
            side = waiting.pop()
            yield side
            waiting.extend(side.children)


class Comparison:
    """The changes from one mission to another, tree by tree."""

    def __init__(self, old: MissionFiles, new: MissionFiles) -> None:
        self.changes: list[Change] = []
        self._signatures: dict[tuple[object, ...], int] = {}
        self._gone: list[tuple[str, _Side]] = []
        self._come: list[tuple[str, _Side]] = []
        self._paired: set[int] = set()  # ids of sides that have moved
        self._compare_roots(old, new)
        self._compare_trees(old, new)
        self._tell_gone_and_come()
        self._compare_models({**old.node_models, **old.subtree_models}, {**new.node_models, **new.subtree_models})

    def _compare_roots(self, old: MissionFiles, new: MissionFiles) -> None:
        name = "main_tree_to_execute"
        mains = [files.root.get(name) if files.root is not None else "" for files in (old, new)]
        if mains[0] != mains[1]:
            self.changes.append(Change("changed", "main tree", details=(_port_change(name, mains[0] or None, mains[1] or None),)))

    def _compare_trees(self, old: MissionFiles, new: MissionFiles) -> None:
        sides = [{name: self._side(tree.body) for name, tree in files.trees.items() if tree.element.children} for files in (old, new)]
        gone = {name: side for name, side in sides[0].items() if name not in sides[1]}
        come = {name: side for name, side in sides[1].items() if name not in sides[0]}
        for name, side in gone.items():
            same = next((other for other, one in come.items() if one.signature == side.signature), None)
            before = old.trees[name].element.place
            if same is None:
                self.changes.append(Change("removed", f'tree "{name}"', before=before))
            else:
                del come[same]
                what = f'tree "{name}" is now "{same}"'
                self.changes.append(Change("moved", what, before=before, after=new.trees[same].element.place))
        self.changes += [Change("added", f'tree "{name}"', after=new.trees[name].element.place) for name in come]
        for name, side in sides[0].items():
            if name in sides[1]:
                self._compare(f'tree "{name}"', side, sides[1][name])

    def _side(self, element: XmlElement, above: str = "") -> _Side:
        """The nodes below an element, with their signatures."""
        side = _Side(element, _type_of(element), above)
        side.children = [self._side(child, side.path) for child in element.children]
        side.size = 1 + sum(child.size for child in side.children)
        key = (side.type, tuple(sorted(_ports(element).items())), *(child.signature for child in side.children))
        side.signature = self._signatures.setdefault(key, len(self._signatures))
        return side

    def _compare(self, where: str, old: _Side, new: _Side) -> None:
        if old.signature == new.signature:
            return
        if old.type != new.type:
            self._gone.append((where, old))
            self._come.append((where, new))
            return
        details = _differences(_ports(old.element), _ports(new.element))
        if details:
            self.changes.append(Change("changed", where, new.path, old.element.place, new.element.place, details))
        pairs, gone, come = paired([_weighed(side) for side in old.children], [_weighed(side) for side in new.children])
        for i, j in pairs:
            self._compare(where, old.children[i], new.children[j])
        self._gone += [(where, old.children[i]) for i in gone]
        self._come += [(where, new.children[j]) for j in come]

    def _tell_gone_and_come(self) -> None:
        """What is gone in one place and new in another has moved; the rest is removed or added."""
        self._tell_moved(lambda side: side.signature, with_all_below=True)
        self._tell_moved(lambda side: (side.type, side.element.get("name")) if side.element.get("name") else None, with_all_below=False)
        for where, side in self._gone:
            for top in self._left(side):
                self.changes.append(Change("removed", where, top.path + self._and_below(top), before=top.element.place))
        for where, side in self._come:
            for top in self._left(side):
                details = tuple(f'{name}="{value}"' for name, value in _ports(top.element).items() if name != "name")
                self.changes.append(Change("added", where, top.path + self._and_below(top), after=top.element.place, details=details))

    def _tell_moved(self, key_of: Callable[[_Side], Hashable], *, with_all_below: bool) -> None:
        """Pair by a key (None: has none), the largest subtrees first."""
        come: dict[Hashable, list[tuple[str, _Side]]] = {}
        for where, new in self._come:
            for side in new.walk():
                come.setdefault(key_of(side), []).append((where, side))
        for where, old in sorted(self._gone, key=lambda pair: -pair[1].size):
            for side in old.walk():
                key = key_of(side)
                free = [one for one in come.get(key, ()) if id(one[1]) not in self._paired] if key is not None else []
                if free and id(side) not in self._paired:
                    self._pair(where, side, *free[0], with_all_below=with_all_below)

    def _pair(self, where: str, old: _Side, at: str, new: _Side, *, with_all_below: bool) -> None:
        for side in (old, new):
            self._paired.update(id(one) for one in (side.walk() if with_all_below else (side,)))
        node = f"{old.label}: {old.above or where} → {new.above or at}"
        details = _differences(_ports(old.element), _ports(new.element))
        self.changes.append(Change("moved", at, node, old.element.place, new.element.place, details))

    def _left(self, top: _Side) -> Iterator[_Side]:
        """The nodes of a subtree that have no partner, but for those below another such node."""
        waiting = [(top, True)]
        while waiting:
            side, above_is_paired = waiting.pop()
            is_paired = id(side) in self._paired
            if not is_paired and above_is_paired:
                yield side
            waiting.extend((child, is_paired) for child in reversed(side.children))

    def _and_below(self, side: _Side) -> str:
        count = sum(id(one) not in self._paired for one in side.walk()) - 1
        return f" and {count} below" if count else ""

    def _compare_models(self, old: Mapping[str, Model], new: Mapping[str, Model]) -> None:
        for name in dict.fromkeys([*old, *new]):
            where = f"model of {name}"
            if name not in new:
                self.changes.append(Change("removed", where, before=old[name].element.place))
            elif name not in old:
                self.changes.append(Change("added", where, after=new[name].element.place))
            else:
                details = _differences(_model_ports(old[name]), _model_ports(new[name]))
                if details:
                    self.changes.append(Change("changed", where, "", old[name].element.place, new[name].element.place, details))


def _type_of(element: XmlElement) -> str:
    """The node type in either form; of a SubTree with the tree it stands for."""
    if element.tag == "SubTree":
        return f"SubTree {element.get('ID')}"
    return element.get("ID") if element.tag in EXPLICIT_TAGS else element.tag


def _ports(element: XmlElement) -> dict[str, str]:
    """All attributes but the ID, which belongs to the type."""
    return {name: attribute.value for name, attribute in element.attributes.items() if name != "ID"}


def _model_ports(model: Model) -> dict[str, str]:
    found = {"kind": model.tag}
    for port in model.ports.values():
        facts = [port.direction, port.type_name, f"= {port.default}" if port.default is not None else "", port.description]
        found[port.name] = ", ".join(fact for fact in facts if fact)
    return found


def _weighed(side: _Side) -> Weighed:
    return Weighed(side.signature, side.type, side.element.get("name"), frozenset(_ports(side.element).items()))


def _differences(old: Mapping[str, str], new: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(_port_change(name, old.get(name), new.get(name)) for name in dict.fromkeys([*old, *new]) if old.get(name) != new.get(name))


def _port_change(name: str, old: str | None, new: str | None) -> str:
    shown = [f'"{value}"' if value is not None else "not given" for value in (old, new)]
    return f"{name}: {shown[0]} → {shown[1]}"
