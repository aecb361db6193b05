"""Trees that the main tree does not use: that they are there, and what would be wrong if they were."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from pluto_bt.source import did_you_mean
from pluto_bt.source.xml_reader import XmlAttribute, XmlElement
from pluto_bt.trees.loader.files import MissionFiles, TreeSource
from pluto_bt.trees.loader.library import library_trees
from pluto_bt.trees.loader.registry import NodeType
from pluto_bt.trees.loader.report import Report


def check_unused(unused: list[TreeSource], files: MissionFiles, types: Mapping[str, NodeType], report: Report) -> None:
    """Warn of each, of SubTrees in them that do not exist, and of circles among them."""
    told: set[str] = set()
    for source in unused:
        if not report.faults.has_errors:
            what = f"tree {source.tree_id!r} is not used"
            mend = f'use it with <SubTree ID="{source.tree_id}"/>, check it with --tree {source.tree_id}, or delete it'
            report.warning(source.element.place, "unused-tree", what, expected="a SubTree that uses it", found="none", mend=mend)
        for attribute in _references(source.element):
            is_known = attribute.value in files.trees or attribute.value in types or attribute.value.lower() in library_trees()
            if not is_known and files.is_whole:
                what, known = f"there is no tree {attribute.value!r}", "one of: " + ", ".join(files.trees)
                mend = did_you_mean(attribute.value, files.trees)
                report.warning(attribute.value_place, "unknown-tree", what, expected=known, found=attribute.value, mend=mend)
        circle = _circle_from(source, files) if source.tree_id not in told else []
        if circle:
            told.update(attribute.value for attribute in circle)
            shown = " → ".join([source.tree_id, *(attribute.value for attribute in circle)])
            what = f"tree {source.tree_id!r} contains itself"
            report.warning(circle[-1].value_place, "recursion", what, expected="no circle", found=shown)


def _references(element: XmlElement) -> Iterator[XmlAttribute]:
    """The IDs of all SubTrees below an element, in the order of the text."""
    waiting = list(reversed(element.children))
    while waiting:
        inner = waiting.pop()
        waiting.extend(reversed(inner.children))
        if inner.tag == "SubTree" and inner.get("ID"):
            yield inner.attributes["ID"]


def _circle_from(start: TreeSource, files: MissionFiles) -> list[XmlAttribute]:
    """References that lead from a tree back to itself; [] if none do."""
    ways: list[list[XmlAttribute]] = [[reference] for reference in _references(start.element)]
    seen: set[str] = set()
    while ways:
        way = ways.pop()
        name = way[-1].value
        if name == start.tree_id:
            return way
        if name not in seen and name in files.trees:
            seen.add(name)
            ways += [[*way, reference] for reference in _references(files.trees[name].element)]
    return []
