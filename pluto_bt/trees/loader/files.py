"""Reads a mission file and all that it includes; collects trees and models."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path

from pluto_bt.source import Faults, Place, did_you_mean, nearest_word
from pluto_bt.source.xml_reader import XmlAttribute, XmlElement, read_xml, read_xml_file
from pluto_bt.trees.loader.registry import EXPLICIT_TAGS, name_problem
from pluto_bt.trees.loader.version3 import SUBTREE_HINT
from pluto_bt.trees.ports import Direction

MAX_INCLUDES = 50  # levels
ROOT_CHILDREN = ("BehaviorTree", "TreeNodesModel", "include", "Contract")


@dataclass(slots=True)
class TreeSource:
    """One `<BehaviorTree>`."""

    tree_id: str
    element: XmlElement

    @property
    def body(self) -> XmlElement:
        """Its one child."""
        return self.element.children[0]


@dataclass(slots=True)
class ModelPort:
    """One port of a model in TreeNodesModel."""

    name: str
    direction: Direction
    type_name: str
    default: str | None
    description: str
    element: XmlElement


@dataclass(slots=True)
class Model:
    """One node in TreeNodesModel."""

    tag: str
    name: str
    element: XmlElement
    ports: dict[str, ModelPort] = field(default_factory=dict)


@dataclass
class MissionFiles:
    """All that was read."""

    faults: Faults
    trees: dict[str, TreeSource] = field(default_factory=dict)
    all_trees: list[TreeSource] = field(default_factory=list)  # also those that a later one replaced
    subtree_models: dict[str, Model] = field(default_factory=dict)
    node_models: dict[str, Model] = field(default_factory=dict)
    root: XmlElement | None = None
    is_whole: bool = True  # False if an included file could not be read: its trees are not known
    unnamed: int = 0
    contracts: list[XmlElement] = field(default_factory=list)
    paths: list[str] = field(default_factory=list)  # of all files that were read, but those of the library
    _open: list[str] = field(default_factory=list)
    _read: set[str] = field(default_factory=set)

    def read_text(self, text: str, file: str) -> None:
        """Read a mission given as text; includes are relative to `file`, or to the working directory."""
        self.root = read_xml(text, file, self.faults)
        if self.root is not None:
            self._take_document(self.root, file, Path(file).parent if file else Path())

    def read_file(self, path: Path, shown: str) -> None:
        """Read a mission file."""
        self.root = read_xml_file(path, shown, self.faults)
        self.paths.append(str(path))
        if self.root is not None:
            self._open.append(os.path.realpath(path))
            self._take_document(self.root, shown, path.parent)
            self._open.pop()

    def read_models(self, path: Path, shown: str) -> None:
        """Read the models of foreign nodes (`--model FILE`)."""
        root = read_xml_file(path, shown, self.faults)
        if root is not None:
            for element in root.children:
                if element.tag == "TreeNodesModel":
                    self._take_models(element)

    def read_library(self, path: Path, shown: str) -> None:
        """Read a file of the library, unless a tree of the mission has taken one of its names; `root` stays the mission's."""
        root = read_xml_file(path, shown, self.faults)
        own, own_models = dict(self.trees), dict(self.subtree_models)
        if root is not None:
            self._take_document(root, shown, path.parent)
        self.trees |= own
        self.subtree_models |= own_models

    def _take_document(self, root: XmlElement, shown: str, folder: Path) -> None:
        if root.tag != "root":
            self.faults.error(root.place, "bad-root", f"the root element is <{root.tag}>", expected="<root>", found=f"<{root.tag}>")
            return
        if "BTCPP_format" not in root.attributes:
            self.faults.warning(root.place, "no-format", "BTCPP_format is missing", expected='BTCPP_format="4"', found="none", mend=SUBTREE_HINT)
        elif root.get("BTCPP_format") != "4":
            place = root.attributes["BTCPP_format"].value_place
            what, found = "the file says it is of another format", root.get("BTCPP_format")
            self.faults.warning(place, "other-format", what, expected="4", found=found, mend=SUBTREE_HINT)
        for element in root.children:
            if element.tag == "include":
                self._include(element, shown, folder)
        models = [element for element in root.children if element.tag == "TreeNodesModel"]
        for element in models:
            self._take_models(element)
        if len(models) > 1:
            self.faults.error(models[1].place, "second-model", "a second <TreeNodesModel>", expected="at most one", mend="put the models together")
        for element in root.children:
            if element.tag == "BehaviorTree":
                self._take_tree(element, alone=len(root.children) == 1)
            elif element.tag == "Contract":
                self.contracts.append(element)
            elif element.tag not in ROOT_CHILDREN:
                mend = did_you_mean(element.tag, ROOT_CHILDREN)
                what = f"<{element.tag}> means nothing here and is ignored"
                self.faults.warning(element.place, "unknown-element", what, expected="one of: " + ", ".join(ROOT_CHILDREN), mend=mend)

    def _take_tree(self, element: XmlElement, alone: bool) -> None:
        attribute = element.attributes.get("ID")
        if attribute is None:
            if not alone:
                mend = 'add ID="…"'
                self.faults.error(element.place, "missing-id", "this tree has no ID", expected="an ID, as it is not the only element", mend=mend)
            tree_id = f"BehaviorTree_{self.unnamed}"
            self.unnamed += 1
        else:
            tree_id = attribute.value
            problem = name_problem(tree_id)
            if problem:
                what = f"{tree_id!r} cannot be the ID of a tree"
                self.faults.error(attribute.value_place, "bad-id", what, expected="letters, digits, _ and -", found=problem)
        if len(element.children) != 1:
            what = f"tree {tree_id!r} must have exactly one child"
            self.faults.error(element.place, "child-count", what, expected="1", found=str(len(element.children)))
        tree = TreeSource(tree_id, element)
        earlier = self.trees.get(tree_id)
        if earlier is not None and attribute is not None:
            place = earlier.element.place
            what = f"tree {tree_id!r} replaces the one at {place.file or '<text>'}:{place.line}"
            self.faults.warning(attribute.value_place, "duplicate-id", what, expected="an ID of its own", mend="rename one of them")
        self.trees[tree_id] = tree
        self.all_trees.append(tree)

    def _include(self, element: XmlElement, shown: str, folder: Path) -> None:
        self.is_whole = self._read_included(element, shown, folder) and self.is_whole

    def _read_included(self, element: XmlElement, shown: str, folder: Path) -> bool:
        """Read what an `<include>` names; False and a fault if that cannot be."""
        attribute = element.attributes.get("path")
        if attribute is None:
            self.faults.error(element.place, "missing-path", "this include has no path", expected='path="FILE.xml"')
            return False
        path = Path(attribute.value)
        if "ros_pkg" in element.attributes and not path.is_absolute():
            place = element.attributes["ros_pkg"].place
            self.faults.error(place, "ros-package", "there are no ROS packages here", expected="a path relative to this file", mend="drop ros_pkg")
            return False
        if "ros_pkg" in element.attributes:
            self.faults.warning(element.attributes["ros_pkg"].place, "ros-package", "ros_pkg is ignored beside an absolute path", mend="drop ros_pkg")
        return self._read_include(folder / path, os.path.join(os.path.dirname(shown), attribute.value), attribute)

    def _read_include(self, path: Path, shown: str, attribute: XmlAttribute) -> bool:
        real = os.path.realpath(path)
        if real in self._open:
            chain = " → ".join(Path(file).name for file in [*self._open[self._open.index(real) :], real])
            self.faults.error(attribute.value_place, "include-cycle", "the file includes itself", expected="no circle", found=chain)
            return True  # its trees are known
        if len(self._open) >= MAX_INCLUDES:
            what = "files include one another too deeply"
            self.faults.error(attribute.value_place, "too-deep", what, expected=f"at most {MAX_INCLUDES} levels", found="more")
            return False
        if not os.path.isfile(path):
            mend, what = _nearest_neighbour(path), f"there is no file {attribute.value!r}"
            self.faults.error(attribute.value_place, "no-file", what, expected="a mission file", found=shown, mend=mend)
            return False
        if real in self._read:
            return True  # its trees are here already
        self._read.add(real)
        self.paths.append(str(path))
        self._open.append(real)
        root = read_xml_file(path, shown, self.faults)
        if root is not None:
            self._take_document(root, shown, path.parent)
        self._open.pop()
        return root is not None

    def _take_models(self, models: XmlElement) -> None:
        for element in models.children:
            if element.tag not in EXPLICIT_TAGS:
                mend = did_you_mean(element.tag, EXPLICIT_TAGS)
                what = f"<{element.tag}> means nothing in a model and is ignored"
                self.faults.warning(element.place, "unknown-element", what, expected="one of: " + ", ".join(EXPLICIT_TAGS), mend=mend)
            elif not element.get("ID"):
                self.faults.error(element.place, "missing-id", f"this <{element.tag}> model has no ID", expected="an ID")
            else:
                model = self._model(element)
                (self.subtree_models if element.tag == "SubTree" else self.node_models)[model.name] = model

    def _model(self, element: XmlElement) -> Model:
        model = Model(element.tag, element.get("ID"), element)
        tags: dict[str, Direction] = {"input_port": "in", "output_port": "out", "inout_port": "inout"}
        for port in element.children:
            if port.tag in tags and "name" in port.attributes:
                name, default = port.get("name"), port.attributes.get("default")
                text = port.get("description") or port.text.strip()
                value = default.value if default is not None else None
                model.ports[name] = ModelPort(name, tags[port.tag], port.get("type"), value, text, port)
            elif port.tag in tags:
                self.faults.error(port.place, "missing-name", "this port has no name", expected='name="…"')
            elif port.tag not in ("MetadataFields", "description"):
                what = f"<{port.tag}> means nothing in a model and is ignored"
                self.faults.warning(port.place, "unknown-element", what, expected=", ".join(tags), mend=did_you_mean(port.tag, tags))
        return model


def _nearest_neighbour(path: Path) -> str:
    """'did you mean "old.xml"?', by the names without their endings, which would make every file a little like every other."""
    try:
        stems = {entry.stem: entry.name for entry in sorted(path.parent.iterdir()) if entry.suffix == ".xml"}
    except (OSError, ValueError):
        return ""
    near = nearest_word(path.stem, stems)
    return f'did you mean "{stems[near]}"?' if near else ""


def main_place(root: XmlElement) -> Place:
    """Where a fault of the choice of the main tree is shown."""
    attribute = root.attributes.get("main_tree_to_execute")
    return root.place if attribute is None else attribute.value_place
