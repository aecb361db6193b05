"""The tree as lines of text."""

from __future__ import annotations

from collections.abc import Iterator

from pluto_bt.trees.dump.model import SIGNS, Drawn

MARKS = {"": "", "IDLE": "-", "RUNNING": "*", "SUCCESS": "o", "FAILURE": "x", "SKIPPED": ">"}
PRETTY_MARKS = {"": "", "IDLE": "·", "RUNNING": "●", "SUCCESS": "✓", "FAILURE": "✗", "SKIPPED": "»"}

PLAIN_SIGNS = str.maketrans({"–": "-", "—": "-", "“": '"', "”": '"', "’": "'", "°": " deg", "×": "x", "…": "..."})


def ascii_tree(root: Drawn) -> str:
    """Four blanks a level, only characters that every terminal has."""
    return "\n".join(_ascii(root, 0)) + "\n"


def _ascii(node: Drawn, level: int) -> Iterator[str]:
    title = node.title.replace("“", '"').replace("”", '"')
    line = f"{'    ' * level}{SIGNS[node.kind][0]} {title}{_ports(node)}{_status(node, MARKS)}"
    yield line.translate(PLAIN_SIGNS).encode("ascii", "backslashreplace").decode()
    for child in node.children:
        yield from _ascii(child, level + 1)


def unicode_tree(root: Drawn) -> str:
    """With lines between parents and children."""
    lines = [_unicode_line(root)]
    _add_children(root, "", lines)
    return "\n".join(lines) + "\n"


def _add_children(node: Drawn, indent: str, lines: list[str]) -> None:
    for i, child in enumerate(node.children):
        is_last = i == len(node.children) - 1
        lines.append(f"{indent}{'└─ ' if is_last else '├─ '}{_unicode_line(child)}")
        _add_children(child, indent + ("   " if is_last else "│  "), lines)


def _unicode_line(node: Drawn) -> str:
    return f"{SIGNS[node.kind][1]} {node.title}{_ports(node)}{_status(node, PRETTY_MARKS)}"


def _ports(node: Drawn) -> str:
    """Ports and conditions, in one line."""
    words = [f"{name}={one_line(value)}" for name, value in node.ports + node.conditions]
    return "  " + " ".join(words) if words else ""


def _status(node: Drawn, marks: dict[str, str]) -> str:
    if not node.status:
        return ""
    feedback = f" – {one_line(node.feedback)}" if node.feedback else ""
    return f"  [{marks[node.status]} {node.state}{feedback}]"


def details(node: Drawn, longest: int) -> list[str]:
    """What stands in a box under the title: ports and conditions, its state unless it is idle, what it says."""
    lines = [f"{name} = {one_line(value, longest)}" for name, value in node.ports + node.conditions]
    if node.status not in ("", "IDLE"):
        lines.append(f"{PRETTY_MARKS[node.status]} {node.state}")
    return [*lines, f"– {one_line(node.feedback, longest)}"] if node.feedback else lines


def one_line(text: str, longest: int = 60) -> str:
    """`text` without line feeds, cut where it is too long to be read."""
    line = " ".join(text.split()) if text.split() else text
    return line if len(line) <= longest else line[: longest - 1] + "…"
