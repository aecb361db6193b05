"""From the children of `<set>` to a message of the blackboard."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, get_origin, get_type_hints

import msgspec

from pluto_bt.blackboard.messages import Message
from pluto_bt.gateway.port import RefusedError


def message_from(kind: type[Message], fields: Mapping[str, str], now_s: float) -> Message:
    """A message of `kind`, stamped now; fields that are not given have their defaults. Raises: RefusedError (`invalid`, `bad-value`)."""
    hints = get_type_hints(kind)
    known = [name for name in kind.__struct_fields__ if name != "stamp_s"]
    unknown = [name for name in fields if name not in known]
    if unknown or not fields:
        fields_text = ", ".join(f"<{name}>" for name in known)
        raise RefusedError("invalid", f"expected at least one of the fields {fields_text}, found {unknown[0] if unknown else 'none'}")
    given: dict[str, Any] = {name: text.split() if get_origin(hints[name]) is tuple else text for name, text in fields.items()}
    try:
        message = msgspec.convert({"stamp_s": now_s, **given}, kind, strict=False)
    except msgspec.ValidationError as error:
        raise RefusedError("bad-value", str(error).replace("`", "")) from None
    for name in given:
        value = getattr(message, name)
        numbers = value if isinstance(value, tuple) else (value,)
        if not all(math.isfinite(number) for number in numbers if isinstance(number, float)):
            raise RefusedError("bad-value", f"<{name}>: expected finite numbers, found {fields[name]!r}")
    return message
