"""The library's own trees: `<SubTree ID="Escape"/>` works in every mission, without an include. A mission's own tree of that name goes first.

A tree of the library is the file `pluto_bt/trees/library/ID.xml`, all in small letters; the file may hold helpers and the tree's model.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from pluto_bt.source.xml_reader import XmlElement
from pluto_bt.trees.loader.files import MissionFiles

FOLDER: Final = Path(__file__).resolve().parents[1] / "library"


def library_trees() -> tuple[str, ...]:
    """The files of the library, by the names of their trees in small letters, in order."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.xml")))


def add_library_trees(files: MissionFiles) -> None:
    """Read the library's trees that the mission uses and does not define, and those that these use."""
    known = library_trees()
    waiting = [tree.element for tree in files.trees.values()]
    seen: dict[str, None] = {}
    while waiting:
        for tree_id in _used_by(waiting.pop()):
            if tree_id in files.trees or tree_id in seen or tree_id.lower() not in known:
                continue
            seen[tree_id] = None
            before = set(files.trees)
            path = FOLDER / f"{tree_id.lower()}.xml"
            files.read_library(path, f"library/{path.name}")
            waiting += [tree.element for name, tree in files.trees.items() if name not in before]


def _used_by(element: XmlElement) -> Iterator[str]:
    """The IDs of all SubTrees below an element."""
    waiting = list(element.children)
    while waiting:
        inner = waiting.pop()
        waiting.extend(inner.children)
        if inner.tag == "SubTree":
            yield inner.get("ID")
