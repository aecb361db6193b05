"""Messages of the blackboard as XML: one child a field, numbers separated by spaces, SI and radians (PROTOCOL.md, section Values)."""

from __future__ import annotations

import base64
from typing import Any, get_type_hints

import msgspec
import numpy as np

from pluto_bt.blackboard.codes import status_name
from pluto_bt.blackboard.messages import FVectorState, LaserScan, Message
from pluto_bt.gateway.xml_text import Attribute, element, escape, numbers, scalar
from pluto_bt.runtime.parameters import unit_of

WIRE_NAMES: dict[type[Message], dict[str, str]] = {LaserScan: {"angle_min_rad": "angle_min", "angle_step_rad": "angle_step", "ranges_m": "ranges"}}
ROW_NAMES = {"nodes": "node", "modules": "module"}


def body_of(value: Message) -> str:
    """The children of `<value>` for any message."""
    names = WIRE_NAMES.get(type(value), {})
    fields = [(names.get(name, name), getattr(value, name)) for name in value.__struct_fields__ if name != "stamp_s"]
    if isinstance(value, LaserScan):
        fields = [field for field in fields if field[0] in ("angle_min", "angle_step", "ranges")]
    if isinstance(value, FVectorState):
        fields = [field for field in fields if field[1] != ""]
    body = "".join(_field(name, content) for name, content in fields)
    return body + _statuses(value.element) if isinstance(value, FVectorState) else body


def value_line(topic: str, seq: int, stamp_s: float, age_s: float, body: str, *, id: str = "", dropped: int = 0) -> bytes:
    """One `<value>` line. The body serves every client; only the head is a client's own."""
    head: dict[str, Attribute] = {"id": id} if id else {}
    head |= {"topic": topic, "seq": seq, "stamp": f"{stamp_s:.6f}", "age": f"{max(0.0, age_s):.3f}", "dropped": dropped}
    return (element("value", head, body) + "\n").encode()


def fields_of(kind: type[Message]) -> tuple[dict[str, str], ...]:
    """Name on the wire, type and unit of every field, for `describe`."""
    names = WIRE_NAMES.get(kind, {}) | ROW_NAMES
    hints = get_type_hints(kind)
    fields = [name for name in kind.__struct_fields__ if name != "stamp_s"]
    told = [name for name in fields if not (kind is LaserScan and name == "count")]
    return tuple({"name": names.get(name, name), "type": _type_name(hints[name]), "unit": unit_of(name) if "_" in name else ""} for name in told)


def _field(name: str, value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"<{name}>{numbers(value.tolist())}</{name}>"
    if isinstance(value, bytes):
        return f"<{name}>{base64.b64encode(value).decode()}</{name}>"
    if isinstance(value, tuple):
        if name in ROW_NAMES:
            return "".join(_row(ROW_NAMES[name], item) for item in value)
        return f"<{name}>{numbers(value)}</{name}>"
    if isinstance(value, bytes):
        return f"<{name}>{base64.b64encode(value).decode()}</{name}>"
    return f"<{name}>{escape(scalar(value)) if isinstance(value, str) else scalar(value)}</{name}>"


def _row(tag: str, item: msgspec.Struct) -> str:
    return element(tag, {name: getattr(item, name) for name in item.__struct_fields__})


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

