"""Messages of the blackboard as JSON and back, bit for bit: numbers keep all their digits, and those that JSON lacks are spelled out."""

from __future__ import annotations

import math
from collections import deque
from typing import Any, get_args, get_origin, get_type_hints

import msgspec
import numpy as np

from pluto_bt.blackboard.messages import Message, read_only

_WORDS = {"NaN": math.nan, "Infinity": math.inf, "-Infinity": -math.inf}


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    return list(value) if isinstance(value, deque | set | frozenset) else str(value)


_encoder = msgspec.json.Encoder(enc_hook=_plain)


def encode(value: Any) -> bytes:
    """`value` as JSON; what JSON does not know stands as text, NaN and the infinities as words."""
    data = _encoder.encode(value)
    if b"null" in data:  # JSON's answer to a number that is not finite; messages hold no None
        data = _encoder.encode(_spelled(msgspec.to_builtins(value, enc_hook=_plain)))
    return data


def decode(data: bytes, kind: type[Message]) -> Message:
    """The message back. Raises: msgspec.DecodeError, msgspec.ValidationError for what is none of that type."""
    return msgspec.json.decode(data, type=kind, strict=False, dec_hook=_array)


def _array(kind: Any, value: Any) -> Any:
    if not isinstance(value, list):
        raise NotImplementedError(f"expected numbers for {kind}, found {type(value).__name__}")
    return read_only([_WORDS[item] if isinstance(item, str) else item for item in value])


def _spelled(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    if isinstance(value, dict):
        return {key: _spelled(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_spelled(item) for item in value]
    return value


def schema_of(kind: type[msgspec.Struct]) -> bytes:
    """The JSON schema of a struct, flat and without references, as viewers of MCAP read it."""
    return msgspec.json.encode(_schema(kind))


def _schema(kind: Any) -> dict[str, Any]:
    names = {int: "integer", float: "number", str: "string", bool: "boolean"}
    if kind in names:
        return {"type": names[kind]}
    if kind is bytes:
        return {"type": "string", "contentEncoding": "base64"}
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        hints = get_type_hints(kind)
        return {"type": "object", "title": kind.__name__, "properties": {name: _schema(hints[name]) for name in kind.__struct_fields__}}
    if get_origin(kind) in (tuple, list):
        return {"type": "array", "items": _schema(get_args(kind)[0])}
    if get_origin(kind) is np.ndarray:
        return {"type": "array", "items": {"type": "number"}}
    return {"type": "object"}
