"""The kinds of the Python types by which leaves declare their ports.

Points, poses and lists of points are ours: "x;y" or "x,y", "x;y;theta_deg", "1,2;3,4". A class with a classmethod `from_text(str)` reads
itself; other classes can only come from another node.
"""

from __future__ import annotations

import json
import re
import types
import typing
from collections import deque
from enum import Enum
from functools import cache
from typing import Any

from pluto_bt.trees.values import ANYTHING, BOOL, DOUBLE, INT, REAL, STRING, Kind, split_list, to_text


@cache
def kind_of_type(data_type: Any) -> Kind:
    """The kind of a port that a leaf declares by a Python type."""
    plain = {int: INT, float: DOUBLE, bool: BOOL, str: STRING, Any: ANYTHING, object: ANYTHING, None: ANYTHING}
    if data_type in plain:
        return plain[data_type]
    origin, args = typing.get_origin(data_type), typing.get_args(data_type)
    if origin is list and len(args) == 1:
        return _list_of(kind_of_type(args[0]))
    if origin is tuple and args and all(arg in (float, int) for arg in args):
        return _numbers(tuple(kind_of_type(arg) for arg in args))
    if origin is typing.Literal:
        return _words(args)
    if origin in (typing.Union, types.UnionType):
        return _union([kind_of_type(arg) for arg in args if arg is not type(None)])
    if isinstance(data_type, type) and issubclass(data_type, Enum):
        return _enum(data_type)
    if isinstance(data_type, type) and callable(getattr(data_type, "from_text", None)):
        return _own_text(data_type)
    return _only_objects(data_type)


def _list_of(item: Kind) -> Kind:
    def parse(text: str) -> list[Any]:
        if text.startswith("json:"):
            try:
                return cast(json.loads(text[5:]))
            except RecursionError:
                raise ValueError("it is nested too deeply") from None
        return split_list(item, text)

    def cast(value: Any) -> list[Any]:
        if not isinstance(value, (list, tuple, deque)):
            raise ValueError("expected a list")
        return [item.parse(one) if isinstance(one, str) else item.cast(one) for one in value]

    form = f"{item.form.replace(';', ',')};…" if ";" in item.form else f"{item.form}; more after ';'"  # "x,y;…": inside a list the comma parts
    return Kind(f"list of {item.name}", form, parse, cast)


def _numbers(items: tuple[Kind, ...]) -> Kind:
    """A point or a pose: so many numbers with ';' or ',' between."""
    count = len(items)
    form = ";".join(("x", "y", "theta_deg")[:count]) if count <= 3 else f"{count} numbers with ';' between"

    def parse(text: str) -> tuple[Any, ...]:
        parts = [part.strip() for part in re.split("[;,]", text)]
        if len(parts) != count or not all(REAL.fullmatch(part) for part in parts):
            raise ValueError(f"expected {form}")
        return tuple(item.parse(part) for item, part in zip(items, parts, strict=True))

    def cast(value: Any) -> tuple[Any, ...]:
        numbers = getattr(value, "numbers", None)  # a value of a class that can be written as so many
        if callable(numbers):
            value = numbers(count)
        if not isinstance(value, (list, tuple)) or len(value) != count:
            raise ValueError(f"expected {form}")
        return tuple(item.cast(one) for item, one in zip(items, value, strict=True))

    return Kind("point" if count == 2 else "pose" if count == 3 else f"{count} numbers", form, parse, cast)


def _words(words: tuple[Any, ...]) -> Kind:
    by_text = {to_text(word): word for word in words}

    def parse(text: str) -> Any:
        if text not in by_text:
            raise ValueError(f"expected one of {', '.join(by_text)}")
        return by_text[text]

    def cast(value: Any) -> Any:
        return value if value in words else parse(to_text(value))

    return Kind("word", f"one of {', '.join(by_text)}", parse, cast)


def _enum(enum: type[Enum]) -> Kind:
    def parse(text: str) -> Enum:
        for member in enum:
            if text == member.name or text == str(member.value):
                return member
        raise ValueError(f"expected one of {', '.join(enum.__members__)}")

    def cast(value: Any) -> Enum:
        return value if isinstance(value, enum) else enum(int(value) if isinstance(value, float) else value)

    return Kind(enum.__name__, f"one of {', '.join(enum.__members__)}", parse, cast)


def _union(members: list[Kind]) -> Kind:
    if len(members) == 1:
        return members[0]

    def first(way: str, value: Any) -> Any:
        for member in members:
            try:
                return getattr(member, way)(value)
            except ValueError:
                continue
        raise ValueError(f"expected {form}")

    form = " or ".join(member.form for member in members)
    return Kind(" | ".join(member.name for member in members), form, lambda text: first("parse", text), lambda value: first("cast", value))


def _own_text(data_type: Any) -> Kind:
    """A class that reads itself; also from other values with `from_value`. With `ANY_ENTRY` its ports give an entry no type: each converts."""
    from_value = getattr(data_type, "from_value", None)

    def cast(value: Any) -> Any:
        if isinstance(value, data_type):
            return value
        if from_value is not None:
            return from_value(value)
        if isinstance(value, (int, float, tuple)):
            return parse(";".join(map(str, value)) if isinstance(value, tuple) else str(value))
        raise ValueError(f"expected {_a(data_type.__name__)}")

    def parse(text: str) -> Any:
        try:
            return data_type.from_text(text)
        except Exception as error:  # a user's reader may raise anything
            raise ValueError(str(error) or type(error).__name__) from None

    form = getattr(data_type, "TEXT_FORM", _a(data_type.__name__))
    return Kind(data_type.__name__, form, parse, cast, data_type, typed=not getattr(data_type, "ANY_ENTRY", False))


def _a(word: str) -> str:
    return f"{'an' if word[:1].lower() in 'aeiou' else 'a'} {word}"


def _only_objects(data_type: Any) -> Kind:
    wanted = typing.get_origin(data_type) or data_type
    name = getattr(wanted, "__name__", str(wanted))

    def parse(_text: str) -> Any:
        raise ValueError("it cannot be written as text; name an entry with {braces}")

    def cast(value: Any) -> Any:
        if isinstance(wanted, type) and not isinstance(value, wanted):
            raise ValueError(f"expected {_a(name)}")
        return value

    return Kind(name, "{key}", parse, cast, wanted if isinstance(wanted, type) else None)
