"""Writing XML: one element as one line, whatever text the robot puts into it."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

import msgspec

_json = msgspec.json.Encoder()
_SPECIAL = {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "\n": "&#10;", "\r": "&#13;", "\t": "&#9;"}
_TO_ESCAPE = re.compile('[&<>"\n\r\t]')
_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # XML 1.0 has no escape for these

Attribute = str | int | float | bool


def escape(text: str) -> str:
    """The text for content or an attribute, without a line break; characters that XML cannot carry become U+FFFD."""
    return _TO_ESCAPE.sub(lambda found: _SPECIAL[found[0]], _NOT_XML.sub("\ufffd", text))


def number(value: float) -> str:
    """A number as XML Schema writes it: the shortest text that reads back as the same double."""
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else ("INF" if value > 0 else "-INF")
    return repr(value)


def numbers(values: Sequence[float]) -> str:
    """Numbers separated by spaces, each as its shortest text that reads back as the same double."""
    listed = _json.encode(values)
    if b"n" in listed:  # null: JSON has no words for what is not finite
        return " ".join(map(number, values))
    return listed[1:-1].decode().replace(",", " ")


def scalar(value: Attribute) -> str:
    """An attribute's or a field's text, not escaped."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "true" if value else "false"
    return number(value)


def element(tag: str, attributes: Mapping[str, Attribute], body: str = "") -> str:
    """`<tag a="…">body</tag>`; attributes that are "" are left out where they mean nothing: give them only if they say something."""
    head = tag + "".join(f' {name}="{escape(scalar(value))}"' for name, value in attributes.items())
    return f"<{head}>{body}</{tag}>" if body else f"<{head}/>"
