"""The tree as a drawing, from left to right: one column a level, one row a leaf; drawn by us, without Graphviz."""

from __future__ import annotations

from dataclasses import dataclass, field
from xml.sax.saxutils import escape, quoteattr

from pluto_bt.trees.dump.model import COLOURS, SIGNS, Drawn
from pluto_bt.trees.dump.text import details

HEAD_PX, LINE_TEXT_PX = 8.2, 6.9  # a letter of the bold head and of the lines under it; wide letters are caught by the padding
PADDING_PX = 10.0
LINE_PX = 15.0
GAP_X_PX = 42.0
GAP_Y_PX = 10.0
MARGIN_PX = 16.0


@dataclass(slots=True)
class Box:
    """One node with its place."""

    node: Drawn
    lines: list[str]
    level: int
    width: float
    height: float
    x: float = 0.0
    y: float = 0.0
    children: list[Box] = field(default_factory=list)


def svg(root: Drawn) -> str:
    """A self-contained SVG document."""
    columns: list[float] = []
    box = _measured(root, 0, columns)
    bottom = _placed(box, _column_starts(columns), MARGIN_PX)
    width = sum(columns) + GAP_X_PX * (len(columns) - 1) + 2 * MARGIN_PX
    height = bottom - GAP_Y_PX + MARGIN_PX
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" viewBox="0 0 {width:.0f} {height:.0f}" '
        'font-family="DejaVu Sans, Verdana, sans-serif" font-size="12">',
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="white"/>',
    ]
    _add_edges(box, parts)
    _add_boxes(box, parts)
    return "\n".join([*parts, "</svg>"]) + "\n"


def _measured(node: Drawn, level: int, columns: list[float]) -> Box:
    lines = [f"{SIGNS[node.kind][1]} {node.title}", *details(node, 44)]
    width = max(len(lines[0]) * HEAD_PX, *(len(line) * LINE_TEXT_PX for line in lines)) + 2 * PADDING_PX
    if level == len(columns):
        columns.append(0.0)
    columns[level] = max(columns[level], width)
    box = Box(node, lines, level, width, len(lines) * LINE_PX + PADDING_PX)
    box.children = [_measured(child, level + 1, columns) for child in node.children]
    return box


def _column_starts(columns: list[float]) -> list[float]:
    starts = [MARGIN_PX]
    for width in columns[:-1]:
        starts.append(starts[-1] + width + GAP_X_PX)
    return starts


def _placed(box: Box, starts: list[float], top: float) -> float:
    """Place `box` and all below it from `top` downwards; the first free height after them."""
    box.x = starts[box.level]
    bottom = top
    for child in box.children:
        bottom = _placed(child, starts, bottom)
    if not box.children:
        box.y = top
        return top + box.height + GAP_Y_PX
    first, last = box.children[0], box.children[-1]
    middle = (first.y + first.height / 2 + last.y + last.height / 2) / 2
    box.y = max(top, middle - box.height / 2)
    return max(bottom, box.y + box.height + GAP_Y_PX)


def _add_edges(box: Box, parts: list[str]) -> None:
    x0, y0 = box.x + box.width, box.y + box.height / 2
    for child in box.children:
        x1, y1 = child.x, child.y + child.height / 2
        bend = (x1 - x0) / 2
        colour = COLOURS[child.node.status][1]
        path = f"M{x0:.1f},{y0:.1f} C{x0 + bend:.1f},{y0:.1f} {x1 - bend:.1f},{y1:.1f} {x1:.1f},{y1:.1f}"
        parts.append(f'<path d="{path}" fill="none" stroke="{colour}"/>')
        _add_edges(child, parts)


def _add_boxes(box: Box, parts: list[str]) -> None:
    node = box.node
    fill, line = COLOURS[node.status]
    round_px = {"Action": 10, "Condition": 10, "Decorator": 5}.get(node.kind, 1)
    dash = ' stroke-dasharray="5 3"' if node.kind == "SubTree" else ""
    tip = f"{node.kind} {node.status}".strip()
    size = f'width="{box.width:.1f}" height="{box.height:.1f}" rx="{round_px}"'
    parts.append(f'<g data-status={quoteattr(node.status)}><title>{escape(tip)}</title><rect x="{box.x:.1f}" y="{box.y:.1f}" {size}'
                 f' fill="{fill}" stroke="{line}" stroke-width="1.2"{dash}/>')  # fmt: skip
    for i, text in enumerate(box.lines):
        weight = ' font-weight="bold"' if i == 0 else ' fill="#57606a" font-size="11"'
        parts.append(f'<text x="{box.x + PADDING_PX:.1f}" y="{box.y + PADDING_PX + LINE_PX * (i + 0.6):.1f}"{weight}>{escape(text)}</text>')
    parts.append("</g>")
    for child in box.children:
        _add_boxes(child, parts)
