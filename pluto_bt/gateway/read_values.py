"""Messages of the blackboard read back from XML: the way back from `values.body_of`, for programs that listen."""

from __future__ import annotations

import base64
from collections.abc import Callable
from functools import lru_cache
from typing import Any, get_args, get_origin, get_type_hints
from xml.etree.ElementTree import Element

import msgspec
import numpy as np

from pluto_bt.blackboard.messages import LaserScan, Message, read_only
from pluto_bt.gateway.values import ROW_NAMES, WIRE_NAMES

_SCALARS: dict[Any, Callable[[str], Any]] = {int: int, float: float, str: str, bool: lambda text: text == "true", bytes: base64.b64decode}


def message_of(kind: type[Message], value: Element) -> Message:
    """The message in a `<value>`. What the robot left out is as by default. Raises: ValueError for content that is none of that type."""
    names, hints = WIRE_NAMES.get(kind, {}), _hints(kind)
    fields: dict[str, Any] = {"stamp_s": float(value.get("stamp", "0"))}
    for name in kind.__struct_fields__[1:]:
        if name in ROW_NAMES:
            fields[name] = tuple(msgspec.convert(row.attrib, get_args(hints[name])[0], strict=False) for row in value.findall(ROW_NAMES[name]))
        elif (found := value.find(names.get(name, name))) is not None:
            fields[name] = _content(hints[name], found.text or "")
    if kind is LaserScan:
        fields["count"] = len(fields["ranges_m"])
    try:
        return kind(**fields)
    except TypeError as error:
        raise ValueError(f"no {kind.__name__}: {error}") from None


@lru_cache
def _hints(kind: type[Message]) -> dict[str, Any]:
    return get_type_hints(kind)


def _content(hint: Any, text: str) -> Any:
    if hint in _SCALARS:
        return _SCALARS[hint](text)
    if get_origin(hint) is np.ndarray:
        return read_only([float(word) for word in text.split()])
    item = _SCALARS[get_args(hint)[0]]
    return tuple(item(word) for word in text.split())
