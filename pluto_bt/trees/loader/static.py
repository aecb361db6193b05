"""Checks every tree as it is written, used or not: tags, children, attributes, literals, scripts."""

from __future__ import annotations

import re
from collections.abc import Mapping

from pluto_bt.source import did_you_mean, nearest_word
from pluto_bt.source.xml_reader import XmlAttribute, XmlElement
from pluto_bt.trees.controls.parallel import absolute_count
from pluto_bt.trees.controls.switch import same_value
from pluto_bt.trees.engine.conditions import CONDITIONS
from pluto_bt.trees.loader.files import MissionFiles, TreeSource
from pluto_bt.trees.loader.literal_check import check_literal, check_script
from pluto_bt.trees.loader.pointers import is_checked_as_literal, key_of
from pluto_bt.trees.loader.registry import EXPLICIT_TAGS, NodeType, is_port_name
from pluto_bt.trees.loader.report import Report
from pluto_bt.trees.loader.version3 import new_attribute, new_name_of_node, new_name_of_port
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.values import BOOL, INT, SCRIPT, STRING

MAX_VALUE = 100_000  # characters of one attribute
TOOL_ATTRIBUTES = ("_description", "_uid", "_fullpath", "_autoremap")


class StaticCheck:
    """One pass over all trees of all files."""

    def __init__(self, files: MissionFiles, types: Mapping[str, NodeType], report: Report) -> None:
        self._files, self._types, self._report = files, types, report

    def run(self) -> None:
        """Check everything; faults go to the report."""
        for tree in self._files.all_trees:
            self._check_tree(tree)

    def _check_tree(self, tree: TreeSource) -> None:
        attribute = tree.element.attributes.get("ID")
        if attribute is not None and tree.tree_id in self._types:
            what = f"tree {tree.tree_id!r} has the name of a node type"
            self._report.error(attribute.value_place, "id-is-node", what, expected="another ID", found=tree.tree_id)
        waiting = list(reversed(tree.element.children))
        while waiting and not self._report.faults.is_full:
            element = waiting.pop()
            if self._is_readable(element):
                self._check_element(element)
            waiting.extend(reversed(element.children))

    def _is_readable(self, element: XmlElement) -> bool:
        """False, and a fault, if a value is so long that looking into it would take seconds."""
        for attribute in element.attributes.values():
            if len(attribute.value) > MAX_VALUE:
                what = f'the value of "{attribute.name}" is too long'
                most, found = f"at most {MAX_VALUE} characters", str(len(attribute.value))
                self._report.error(attribute.value_place, "too-long", what, expected=most, found=found)
                return False
        return True

    def _check_element(self, element: XmlElement) -> None:
        self._check_conditions(element)
        if element.tag == "SubTree":
            self._check_subtree(element)
            return
        node_type = self.type_of(element)
        if node_type is None:
            self._unknown_node(element)
            return
        self._check_children(element, node_type)
        self._check_ports(element, node_type)
        if node_type.name in ("Parallel", "ParallelAll"):
            self._check_thresholds(element)

    def type_of(self, element: XmlElement) -> NodeType | None:
        """The type of an element, in compact or explicit form."""
        return self._types.get(element.get("ID") if element.tag in EXPLICIT_TAGS else element.tag)

    def _unknown_node(self, element: XmlElement) -> None:
        explicit = element.tag in EXPLICIT_TAGS
        name = element.get("ID") if explicit else element.tag
        if explicit and not name:
            self._report.error(element.place, "missing-id", f"<{element.tag}> needs an ID", expected="the name of a node type")
            return
        place = element.attributes["ID"].value_place if explicit else element.place
        mend = did_you_mean(name, self._types)
        if new := new_name_of_node(name):
            what, expected = f"<{name}> is a name of version 3 of the format", f"<{new}>"
            self._report.error(place, "old-format", what, expected=expected, found=name, mend=f"version 4 has <{new}>")
            return
        if name in self._files.trees:
            mend = f'write <SubTree ID="{name}"/>'
        elif name in self._files.node_models:
            mend = "the file has a model of it, but no implementation is loaded: give one with --plugin"
        self._report.error(place, "unknown-node", f"unknown node <{name}>", expected="a node type; `pluto nodes` lists them", found=name, mend=mend)

    def _check_subtree(self, element: XmlElement) -> None:
        attribute = element.attributes.get("ID")
        if attribute is None or not attribute.value:
            self._report.error(element.place, "missing-id", "<SubTree> needs an ID", expected="the ID of a tree")
        elif attribute.value in self._types:
            what = f"{attribute.value!r} is a node type, not a tree"
            self._report.error(attribute.value_place, "id-is-node", what, expected="the ID of a tree", mend=f"write <{attribute.value}/>")
        if element.children:
            what = "a <SubTree> has no children"
            self._report.error(element.children[0].place, "child-count", what, expected="0", found=str(len(element.children)))
        autoremap = element.attributes.get("_autoremap")
        if autoremap is not None:
            check_literal(autoremap, PortModel("_autoremap", kind=BOOL), self._report, builtin=True)
        else:
            self._check_subtree_ports(element)
        self._check_private(element)

    def _check_subtree_ports(self, element: XmlElement) -> None:
        """A port that neither the model nor the tree itself knows; BehaviorTree.CPP takes any."""
        tree, model = self._files.trees.get(element.get("ID")), self._files.subtree_models.get(element.get("ID"))
        if tree is None or model is None:
            return
        for attribute in element.attributes.values():
            if is_port_name(attribute.name) and attribute.name not in model.ports and not _names(tree.element, attribute.name):
                known, mend = ", ".join(model.ports) or "none", did_you_mean(attribute.name, model.ports)
                what = f'tree "{tree.tree_id}" has no port "{attribute.name}", nor does anything in it read one'
                self._report.warning(attribute.place, "unknown-port", what, expected=f"one of: {known}", found=attribute.name, mend=mend)

    def _check_children(self, element: XmlElement, node_type: NodeType) -> None:
        count = len(element.children)
        fewest, most = node_type.children
        if node_type.kind in ("Action", "Condition") and count:
            what, place = f"<{node_type.name}> has no children", element.children[0].place
            self._report.error(place, "child-count", what, expected="0", found=str(count))
        elif node_type.kind == "Decorator" and count != 1:
            what = f"decorator <{node_type.name}> must have exactly one child"
            mend = "put them in a <Sequence>" if count else ""
            self._report.error(element.place, "child-count", what, expected="1", found=str(count), mend=mend)
        elif node_type.kind == "Control" and count == 0:
            what = f"<{node_type.name}> must have a child"
            self._report.error(element.place, "child-count", what, expected="1 or more", found="0")
        elif node_type.name == "TryCatch" and count < fewest:
            what = "<TryCatch> needs something to try and a clean-up"
            self._report.error(element.place, "child-count", what, expected="2 or more", found=str(count))
        elif node_type.kind == "Control" and not fewest <= count <= (most or count):
            expected = str(fewest) if fewest == most else f"{fewest} to {most}"
            what = f"<{node_type.name}> has the wrong number of children"
            self._report.late(element.place, "child-count", what, expected=expected, found=str(count))
        if node_type.name == "ReactiveSequence":
            self._check_reactive(element)

    def _check_reactive(self, element: XmlElement) -> None:
        """Two quirks of BehaviorTree.CPP's loader."""
        for child in element.children:
            if child.tag in EXPLICIT_TAGS and child.tag != "SubTree" and child.get("ID"):
                what = "BehaviorTree.CPP refuses the explicit form directly under <ReactiveSequence>"
                self._report.error(child.place, "explicit-form", what, expected=f"<{child.get('ID')} …>", found=f"<{child.tag} ID=…>")
        several = [child for child in element.children if child.tag == "AsyncSequence"]
        if len(several) > 1:
            what = "<ReactiveSequence> can have only one <AsyncSequence> child"
            self._report.error(several[1].place, "several-async", what, expected="1", found=str(len(several)))

    def _check_ports(self, element: XmlElement, node_type: NodeType) -> None:
        if element.tag not in EXPLICIT_TAGS and "ID" in element.attributes:
            place = element.attributes["ID"].place
            what = f"<{element.tag}> takes no ID"
            self._report.error(place, "id-in-compact-form", what, expected="no ID", mend='name="…" gives it a name of its own')
        for attribute in element.attributes.values():
            if is_port_name(attribute.name) and not self._report.faults.is_full:
                self._check_port(attribute, node_type)
        self._check_private(element)
        unknown = [name for name in element.attributes if is_port_name(name) and name not in node_type.ports]
        meant = {nearest_word(name, node_type.ports) for name in unknown}  # misspelt, which is told already
        for port in node_type.ports.values():
            if port.required and port.default is None and port.name not in element.attributes and port.name not in meant:
                report = self._report.error if port.at_load else self._report.late
                what = f'port "{port.name}" of <{node_type.name}> is missing'
                report(element.place, "missing-port", what, expected=f'{port.name}="…": {port.form}', found="nothing")
        if node_type.builtin and node_type.name.startswith("Switch"):
            self._check_switch(element)

    def _check_switch(self, element: XmlElement) -> None:
        """A choice without a question, and cases that an earlier one always takes."""
        if "variable" not in element.attributes:
            what = f"<{element.tag}> without variable always takes its last child"
            self._report.warning(element.place, "missing-port", what, expected='variable="{key}"', found="nothing")
        seen: list[XmlAttribute] = []
        cases = [one for one in element.attributes.values() if one.name.startswith("case_") and key_of(one.name, one.value) is None]
        for case in sorted(cases, key=lambda one: one.name):
            earlier = next((one for one in seen if same_value(one.value, case.value, {})), None)
            if earlier is not None:
                what = f"{case.name} is never chosen: {earlier.name} takes the same value"
                self._report.warning(case.value_place, "unreachable", what, expected="a value of its own", found=case.value)
            seen.append(case)

    def _check_port(self, attribute: XmlAttribute, node_type: NodeType) -> None:
        port = node_type.ports.get(attribute.name)
        if port is None:
            known = ", ".join(node_type.ports) or "none"
            new = new_name_of_port(node_type.name, attribute.name)
            mend = f"version 4 has {new}" if new else did_you_mean(attribute.name, node_type.ports)
            what = f'unknown port "{attribute.name}" of <{node_type.name}>'
            self._report.error(attribute.place, "unknown-port", what, expected=f"one of: {known}", found=attribute.name, mend=mend)
        elif port.direction == "out":
            if key_of(port.name, attribute.value) is None:
                what, mend = f'output port "{port.name}" needs an entry', "put it in {braces}"
                self._report.warning(attribute.value_place, "output-literal", what, expected="{key}", found=attribute.value, mend=mend)
        elif is_checked_as_literal(attribute.value) and not (port.kind in (STRING, SCRIPT) and key_of(port.name, attribute.value)):
            check_literal(attribute, port, self._report, builtin=node_type.builtin)

    def _check_conditions(self, element: XmlElement) -> None:
        for name in CONDITIONS:
            attribute = element.attributes.get(name)
            if attribute is not None:
                check_script(attribute, self._report)

    def _check_private(self, element: XmlElement) -> None:
        """Attributes with `_` in front are ignored, so a misspelt condition would be too."""
        known = (*CONDITIONS, *TOOL_ATTRIBUTES)
        for name, attribute in element.attributes.items():
            if not is_port_name(name) and name not in (*known, "name", "ID"):
                what, wanted = f'attribute "{name}" is ignored', "one of: " + ", ".join(known)
                new = new_attribute(name)
                mend = f"version 4 has {new}" if new else did_you_mean(name, known)
                self._report.warning(attribute.place, "ignored-attribute", what, expected=wanted, mend=mend)

    def _check_thresholds(self, element: XmlElement) -> None:
        count = len(element.children)
        values: dict[str, int] = {}
        for name in ("success_count", "failure_count", "max_failures"):
            attribute = element.attributes.get(name)
            if attribute is None:
                continue
            try:
                values[name] = INT.parse(attribute.value)
            except ValueError:
                continue  # an entry, or told already
            if absolute_count(values[name], count) > count:
                what = f"{name} is more than the number of children"
                self._report.late(attribute.value_place, "threshold", what, expected=f"at most {count}", found=attribute.value)
        needed = absolute_count(values.get("success_count", -1), count)
        limit, most = values.get("failure_count"), count - needed + 1  # so many failures already leave too few children to succeed
        if limit is not None and count >= needed and count >= absolute_count(limit, count) > most:
            what = f"failure_count {limit} has no effect: {most} failures already end it"
            place = element.attributes["failure_count"].value_place
            self._report.warning(place, "unreachable-threshold", what, expected=f"at most {most}", found=str(limit))


def _names(element: XmlElement, key: str) -> bool:
    """True if a value below `element` has the key as a word, in braces or in a script; or may pass it on unnamed."""
    word, found = re.compile(rf"(?<!\w){re.escape(key)}(?!\w)"), list(element.children)
    for inner in found:  # grows as it is walked
        found += inner.children
    return any("_autoremap" in inner.attributes or any(word.search(one.value) for one in inner.attributes.values()) for inner in found)
