"""The tree as a web page that folds: one file, no scripts."""

from __future__ import annotations

from xml.sax.saxutils import escape

from pluto_bt.trees.dump.model import COLOURS, SIGNS, Drawn

STYLE = """
body { font: 14px/1.5 system-ui, sans-serif; margin: 1.5em; color: #1f2328 }
details, .leaf { margin-left: 1.4em } summary { cursor: pointer }
.node { border: 1px solid; border-radius: 5px; padding: 0 .5em; display: inline-block; margin: 2px 0 }
.ports { color: #57606a; font-family: ui-monospace, monospace; font-size: 12px } .feedback { font-style: italic }
.state { font-size: 12px; font-weight: 600 }
"""


def xhtml(root: Drawn) -> str:
    """A self-contained page."""
    colours = "".join(f".s{status or 'NONE'} {{ background: {fill}; border-color: {line} }}\n" for status, (fill, line) in COLOURS.items())
    parts = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<html xmlns="http://www.w3.org/1999/xhtml" lang="en"><head><meta charset="UTF-8"/>',
        f"<title>{escape(root.title)}</title><style>{STYLE}{colours}</style></head><body>",
    ]
    _add(root, parts)
    return "\n".join([*parts, "</body></html>"]) + "\n"


def _add(node: Drawn, parts: list[str]) -> None:
    ports = " ".join(f'{escape(name)}="{escape(value)}"' for name, value in node.ports + node.conditions)
    words = [f"{SIGNS[node.kind][1]} <b>{escape(node.title)}</b>"]
    words += [f'<span class="ports">{ports}</span>'] if ports else []
    words += [f'<span class="state">{node.state}</span>'] if node.status else []
    words += [f'<span class="feedback">{escape(node.feedback)}</span>'] if node.feedback else []
    shown = f'<span class="node s{node.status or "NONE"}">{" ".join(words)}</span>'
    if not node.children:
        parts.append(f'<div class="leaf">{shown}</div>')
        return
    parts.append(f'<details open="open"><summary>{shown}</summary>')
    for child in node.children:
        _add(child, parts)
    parts.append("</details>")
