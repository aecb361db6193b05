"""Values and events, told to a person or to a program."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from functools import cache
from typing import Any

import msgspec

from pluto_bt.blackboard.messages import ModuleState, NodeState
from pluto_bt.gateway.client import Element
from pluto_bt.gateway.subscriptions import ALIASES
from pluto_bt.gateway.values import fields_of
from pluto_bt.gateway.wire import TYPES
from pluto_bt.gateway.words import said_by

_ROWS: dict[str, type[msgspec.Struct]] = {"node": NodeState, "module": ModuleState}
LONG_LIST = 12  # numbers shown of a longer list
LONG_TEXT = 160  # characters shown of a longer text
POSE_PARTS = 9  # of a pose in the text of a path: stamp;frame;x;y;z and a quaternion; before them stand a stamp and a frame


def event_line(event: Element) -> str:
    """An event for a person, from an `<event>` or a `<value>` of the topic."""
    part = {child.tag: child.text or "" for child in event} if event.tag == "value" else {**event.attrib, "text": event.text or ""}
    time = event.get("stamp") or event.get("time") or "0"
    return f"{float(time):9.2f} s  {part.get('level', ''):<7} {said_by(part.get('source', ''), part.get('text', ''))}"


def shown(value: Element) -> str:
    """A value for a person: a line a field, long lists cut; codes with their names."""
    lines = [f"{value.get('topic')}  at {value.get('stamp')} s, age {value.get('age')} s"]
    for part in value:
        words = _short((part.text or "").split(" "))
        text = " ".join(words) or " ".join(f"{key}={word}" for key, word in part.attrib.items())
        cut = f"{' '.join(words[:LONG_LIST])} … ({len(words)} in all)" if len(words) > LONG_LIST and part.tag != "text" else text
        lines.append(f"  {part.tag:<16} {cut}")
    return "\n".join(lines)


def as_json(value: Element) -> str:
    """A value as one line of JSON, each field as its type has it: a list of one number is a list, what is no finite number is null."""
    topic = value.get("topic", "")
    kinds = _kinds(ALIASES.get(topic, topic))
    fields: dict[str, Any] = {name: [] for name, kind in kinds.items() if kind == "rows"}
    for part in value:
        if part.attrib:
            fields.setdefault(part.tag, []).append(_row(part.tag, part.attrib))
        else:
            fields[part.tag] = _READ[kinds.get(part.tag, "str")](part.text or "")
    head = {"topic": topic, "seq": int(value.get("seq", "0")), "stamp_s": float(value.get("stamp", "0"))}
    return json.dumps({**head, **fields}, ensure_ascii=False)


@cache
def _kinds(topic: str) -> dict[str, str]:
    """Field → type; nothing of a topic that we do not know."""
    return {field["name"]: field["type"] for field in fields_of(TYPES[topic])} if topic in TYPES else {}


def brief(text: str) -> str:
    """An output of a node for a person: of a path its ends and how many points it has, of any other long text its beginning."""
    if len(text) <= LONG_TEXT:
        return text
    parts = text.split(";")
    is_path = len(parts) % POSE_PARTS == 2 and _number(parts[0]) is not None
    pairs = list(zip(parts[4::POSE_PARTS], parts[5::POSE_PARTS], strict=True)) if is_path else [tuple(part.split(",")) for part in parts]
    points = [f"{x:g},{y:g}" for pair in pairs if len(pair) == 2 and (x := _number(pair[0])) is not None and (y := _number(pair[1])) is not None]
    if len(points) < max(3, len(pairs)):
        return f"{text[:LONG_TEXT]}… ({len(text)} characters)"
    return f"{points[0]};{points[1]};…;{points[-1]} ({len(points)} points)"


def _short(words: list[str]) -> list[str]:
    """Numbers without the digits that no sensor has; a text as it is."""
    values = [_number(word) for word in words]
    return words if None in values else [f"{value:.7g}" if "." in word else word for value, word in zip(values, words, strict=True)]


def _row(tag: str, attributes: dict[str, str]) -> dict[str, Any]:
    """A row of a list, each attribute as its field has it; one that we do not know is a text."""
    kinds = _row_kinds(tag)
    return {key: msgspec.convert(word, kinds.get(key, str), strict=False) for key, word in attributes.items()}


@cache
def _row_kinds(tag: str) -> dict[str, Any]:
    if tag not in _ROWS:
        return {"element": int, "code": int}
    return {field.name: field.type for field in msgspec.structs.fields(_ROWS[tag])}


def _number(word: str) -> float | None:
    try:
        number = float(word)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


_READ: dict[str, Callable[[str], Any]] = {
    "str": str, "base64": str, "int": int, "float": _number, "bool": lambda text: text == "true",
    "ints": lambda text: [*map(int, text.split())], "floats": lambda text: [*map(_number, text.split())],
}  # fmt: skip
