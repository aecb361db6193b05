"""Messages of the blackboard as XML: one child a field, numbers separated by spaces, SI and radians (PROTOCOL.md, section Values)."""

from __future__ import annotations

import base64
from collections.abc import Callable
from functools import cache, lru_cache
from typing import Any, get_origin, get_type_hints

import msgspec

from pluto_bt.blackboard.codes import status_name
from pluto_bt.blackboard.messages import FVectorState, LaserScan, Message
from pluto_bt.gateway.xml_text import element, escape, numbers, scalar
from pluto_bt.runtime.parameters import unit_of

WIRE_NAMES: dict[type[Message], dict[str, str]] = {LaserScan: {"angle_min_rad": "angle_min", "angle_step_rad": "angle_step", "ranges_m": "ranges"}}
ROW_NAMES = {"nodes": "node", "modules": "module"}


def body_of(value: Message) -> str:
    """The children of `<value>` for any message."""
    body = "".join([write(getattr(value, name)) for name, write in _plan(type(value))])
    return body + _statuses(value.element) if isinstance(value, FVectorState) else body


def value_line(topic: str, seq: int, stamp_s: float, age_s: float, body: str, *, id: str = "", dropped: int = 0) -> bytes:
    """One `<value>` line. The body serves every client; only the head is a client's own."""
    head = f' id="{escape(id)}"' if id else ""
    age_s = max(0.0, age_s)
    line = f'<value{head} topic="{topic}" seq="{seq}" stamp="{stamp_s:.6f}" age="{age_s:.3f}" dropped="{dropped}">{body}</value>\n'
    return line.encode()


def fields_of(kind: type[Message]) -> tuple[dict[str, str], ...]:
    """Name on the wire, type and unit of every field, for `describe`."""
    names = WIRE_NAMES.get(kind, {}) | ROW_NAMES
    hints = get_type_hints(kind)
    fields = [name for name in kind.__struct_fields__ if name != "stamp_s"]
    told = [name for name in fields if not (kind is LaserScan and name == "count")]
    return tuple({"name": names.get(name, name), "type": _type_name(hints[name]), "unit": unit_of(name) if "_" in name else ""} for name in told)


Write = Callable[[Any], str]


@cache
def _plan(kind: type[Message]) -> tuple[tuple[str, Write], ...]:
    """For each field of a message that is told: its name, and how it is written."""
    names, hints = WIRE_NAMES.get(kind, {}), get_type_hints(kind)
    told = [name for name in kind.__struct_fields__ if name != "stamp_s" and not (kind is LaserScan and name == "count")]
    return tuple((name, _writer(names.get(name, name), hints[name], is_optional=kind is FVectorState)) for name in told)


def _writer(name: str, hint: Any, *, is_optional: bool) -> Write:
    """How a field of this type is written; an optional text is left out if it is empty."""
    if name in ROW_NAMES:
        tag = ROW_NAMES[name]
        return lambda rows: "".join([_row(tag, row) for row in rows])
    if hint is str:
        return lambda text: f"<{name}>{escape(text)}</{name}>" if text or not is_optional else ""
    if hint is bytes:
        return lambda data: f"<{name}>{base64.b64encode(data).decode()}</{name}>"
    if hint in (bool, int, float):
        return lambda value: f"<{name}>{scalar(value)}</{name}>"
    if get_origin(hint) is tuple:
        return lambda values: f"<{name}>{numbers(values)}</{name}>"
    return lambda array: f"<{name}>{numbers(array.tolist())}</{name}>"


def _row(tag: str, item: msgspec.Struct) -> str:
    return element(tag, {name: getattr(item, name) for name in item.__struct_fields__})


@lru_cache(1024)
def _statuses(codes: tuple[int, ...]) -> str:
    """For people: the name of each code."""
    return "".join(element("status", {"element": i, "code": code, "name": status_name(i, code)}) for i, code in enumerate(codes))


def _type_name(hint: Any) -> str:
    if hint is bytes:
        return "base64"
    if hint in (int, float, bool, str):
        return str(hint.__name__)
    text = str(hint)
    if "NodeState" in text or "ModuleState" in text:
        return "rows"
    return "ints" if "int" in text.replace("float", "") and "ndarray" not in text else "floats"

