"""The types of ports and blackboard entries: how each is read from text, and from a value of another type.

Rules of BehaviorTree.CPP 4.10 for its own types (int, unsigned, double, bool, string, NodeStatus, vectors, queues): numbers stop at
the first foreign character, leading blanks and `+` are refused, ranges are checked; numbers become text with six decimals.
The kinds of Python types that leaves declare (points, lists, enums, …) are in `pluto_bt.trees.python_types`.
"""

from __future__ import annotations

import math
import re
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

from pluto_bt.trees.engine.status import STATUS_OF_NAME, Result, Skip

INT32: Final = (-(2**31), 2**31 - 1)
INT64_RANGE: Final = (-(2**63), 2**63 - 1)
EXACT_INT: Final = 2**53  # beyond it a double no longer holds every integer

_INTEGER = re.compile(r"-?\d+", re.ASCII)  # the digits of other scripts are no numbers in any file
REAL = re.compile(r"-?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|inf(?:inity)?)", re.ASCII)


REALS: Final = ("double", "float")  # types of a model that take digits for a real number
TEXTS: Final = ("string", "std::string")  # … and for text


class PortProblem(Exception):  # noqa: N818  it is no error of the program; it becomes a StepError or a fault with a place
    """A value that is missing, does not fit, or may not be written; the text is a plain sentence."""


@dataclass(frozen=True, eq=False)
class Kind:
    """A type of values. Two ports on one key must have the same kind (identity), unless one is untyped.

    Attributes:
        name: as `pluto nodes` shows it.
        form: what a person writes, for the "expected" of a fault.
        parse: value of a text; raises ValueError.
        cast: value of a value of another kind; raises ValueError.
        python: values of exactly this type need no cast.
        typed: False for "anything".
        raw: True if a reader wants the entry's value as it is, not converted.
    """

    name: str
    form: str
    parse: Callable[[str], Any]
    cast: Callable[[Any], Any]
    python: type | None = None
    typed: bool = True
    raw: bool = False

    def convert(self, value: Any) -> Any:
        """`value` as this kind; a text is parsed. Raises PortProblem."""
        try:
            return self.parse(value) if isinstance(value, str) and self.python is not str else self.cast(value)
        except ValueError as error:
            raise PortProblem(f"{value!r} is no {self.name}: {error}") from None


def to_text(value: Any) -> str:
    """A value as a string port reads it: digits, six decimals, true/false. Raises ValueError for other types."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return f"{value:.6f}"
    raise ValueError(f"a {type(value).__name__} has no text form")


def parse_int(text: str, low: int, high: int) -> int:
    """Leading digits of `text`, within low..high."""
    found = _INTEGER.match(text)
    if found is None or len(found[0]) > 40:  # more digits are out of every range, and slow to convert
        raise ValueError("expected a whole number")
    if not low <= (value := int(found[0])) <= high:
        raise ValueError(f"out of range {low}..{high}")
    return value


def parse_real(text: str) -> float:
    """Leading real number of `text`."""
    found = REAL.match(text)
    if found is None:
        raise ValueError("expected a number")
    value = float(found[0])
    if math.isinf(value) and "inf" not in found[0]:
        raise ValueError("out of range")
    return value


def parse_bool(text: str) -> bool:
    """One of `0 1 true false TRUE FALSE True False`."""
    if text in ("1", "true", "True", "TRUE"):
        return True
    if text in ("0", "false", "False", "FALSE"):
        return False
    raise ValueError("expected true or false")


def trailing_text(kind: Kind, text: str) -> str:
    """What reading `text` as a number would silently drop at its end ("abc" of "10abc", which is read as 10)."""
    if kind in (INT, INT64, UINT):
        found = _INTEGER.match(text)
    elif kind is DOUBLE:
        found = REAL.match(text)
    else:
        return ""
    return text[found.end() :] if found is not None else ""


def literal_value(text: str) -> int | float | str:
    """The value of a literal on a SubTree tag or of `--port`: all digits → int, a real number → float, else the text."""
    if len(text) <= 400 and _INTEGER.fullmatch(text):
        number = int(text)
        return number if INT64_RANGE[0] <= number <= INT64_RANGE[1] else float(text)
    return float(text) if REAL.fullmatch(text) and "inf" not in text else text


def declared_value(text: str, type_name: str) -> int | float | str:
    """`literal_value`, but that digits are a real number or a text where a model declares one (`type_name`)."""
    if type_name in TEXTS:
        return text
    value = literal_value(text)
    return float(value) if type_name in REALS and isinstance(value, int) else value


def _cast_int(low: int, high: int) -> Callable[[Any], int]:
    def cast(value: Any) -> int:
        if isinstance(value, (int, float)) and math.isfinite(value) and value == int(value):
            if low <= value <= high:
                return int(value)
            raise ValueError(f"out of range {low}..{high}")
        raise ValueError("expected a whole number")

    return cast


def cast_real(value: Any) -> float:
    """A number as a double. Raises ValueError for other values, and for integers that a double cannot hold exactly."""
    if isinstance(value, int) and abs(value) > EXACT_INT:
        raise ValueError(f"{value} is too large to be exact")
    if isinstance(value, (int, float)):
        return float(value)
    raise ValueError("expected a number")


def cast_bool(value: Any) -> bool:
    """True or false of a number: any real, or the integers 0 and 1. Raises ValueError for everything else."""
    if isinstance(value, float):
        return value != 0.0
    if isinstance(value, int) and value in (0, 1):
        return bool(value)
    raise ValueError("expected true or false (0 or 1)")


def _parse_status(text: str) -> Result:
    if text not in STATUS_OF_NAME:
        raise ValueError(f"expected one of {', '.join(STATUS_OF_NAME)}")
    return STATUS_OF_NAME[text]


def _cast_status(value: Any) -> Result:
    if isinstance(value, (Skip, type(STATUS_OF_NAME["IDLE"]))):
        return value
    raise ValueError("expected a node status")


def _whole(name: str, low: int, high: int, form: str) -> Kind:
    return Kind(name, form, lambda text: parse_int(text, low, high), _cast_int(low, high))


INT: Final = Kind("int", "a whole number", lambda text: parse_int(text, *INT32), _cast_int(*INT32), int)
INT64: Final = _whole("int64", *INT64_RANGE, "a whole number")
UINT: Final = _whole("unsigned int", 0, 2**32 - 1, "a whole number, not negative")
DOUBLE: Final = Kind("double", "a number", parse_real, cast_real, float)
BOOL: Final = Kind("bool", "true or false", parse_bool, cast_bool, bool)
STRING: Final = Kind("string", "text", str, to_text, str)
STATUS: Final = Kind("NodeStatus", "one of " + ", ".join(STATUS_OF_NAME), _parse_status, _cast_status)
ANYTHING: Final = Kind("any", "anything", lambda text: text, lambda value: value, typed=False)
SCRIPT: Final = Kind("script", "a script", str, to_text, str)


def queue_of(item: Kind) -> Kind:
    """The shared queue that Loop nodes pop from: text `1;2;3`, or a deque made by another node."""

    def cast(value: Any) -> Any:
        if isinstance(value, deque):
            return value
        if isinstance(value, (list, tuple)):
            return deque(item.convert(one) for one in value)
        raise ValueError("expected a list")

    return Kind(f"queue<{item.name}>", f"{item.form}; more after ';'", lambda text: deque(split_list(item, text)), cast, deque, raw=True)


def split_list(item: Kind, text: str) -> list[Any]:
    """The elements of `1;2;3`; a trailing ';' adds nothing."""
    parts = text.split(";")
    if parts[-1] == "":
        parts.pop()
    return [item.parse(part) for part in parts]


def kind_of_value(value: Any) -> Kind | None:
    """The kind that a value written without a port gives its entry; None for values that leave it open."""
    if isinstance(value, bool):
        return BOOL
    if isinstance(value, int):
        return INT if INT32[0] <= value <= INT32[1] else INT64
    return DOUBLE if isinstance(value, float) else None
