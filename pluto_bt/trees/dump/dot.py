"""The tree in the language of Graphviz."""

from __future__ import annotations

import itertools

from pluto_bt.trees.dump.model import COLOURS, Drawn
from pluto_bt.trees.dump.text import details

SHAPES = {"Control": "box", "Decorator": "hexagon", "SubTree": "folder", "Action": "ellipse", "Condition": "diamond"}


def dot(root: Drawn) -> str:
    """A digraph from top to bottom; children keep their order."""
    lines = ["digraph mission {", "  ordering=out;", '  node [style=filled, fontname="sans-serif", fontsize=11];']
    _add(root, itertools.count(), lines)
    return "\n".join([*lines, "}"]) + "\n"


def _add(node: Drawn, numbers: itertools.count[int], lines: list[str]) -> int:
    number = next(numbers)
    fill, line = COLOURS[node.status]
    label = "\n".join([node.title, *details(node, 40)])
    tip = f"{node.status} {node.feedback}".strip()
    shape = SHAPES[node.kind]
    lines.append(f'  n{number} [label={_quoted(label)}, shape={shape}, fillcolor="{fill}", color="{line}", tooltip={_quoted(tip)}];')
    for child in node.children:
        lines.append(f"  n{number} -> n{_add(child, numbers, lines)};")
    return number


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
