"""What the operators of scripts do with values: numbers (int, float, bool) and texts. All arithmetic is in doubles."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from pluto_bt.trees.scopes import EMPTY, Entry
from pluto_bt.trees.values import PortProblem, cast_bool, cast_real, parse_real, to_text

EPSILON: Final = 1.1920928955078125e-07  # of a 32-bit float: numbers nearer than this are equal


class ScriptError(Exception):
    """A script that fails while it runs; the text is a plain sentence."""


def is_number(value: Any) -> bool:
    """True for int, float and bool."""
    return isinstance(value, (int, float))


def number(value: Any, what: str) -> float:
    """A number as a double."""
    try:
        return cast_real(value)
    except ValueError as error:
        raise ScriptError(f"{what}: {error}") from None


def truth(value: Any, what: str) -> bool:
    """0 or 1 as an integer, or any real."""
    try:
        return cast_bool(value)
    except ValueError as error:
        raise ScriptError(f"{what} is {shown(value)}: {error}") from None


def whole(value: Any, sign: str) -> int:
    """An operand of a bit operator."""
    if is_number(value) and math.isfinite(value) and value == int(value):
        return int(value)
    raise ScriptError(f"'{sign}' needs whole numbers, not {shown(value)}")


def number_of_text(text: str, enums: Mapping[str, int]) -> float:
    """A text that is compared with a number: true, false, an enum name, or digits."""
    if text in ("true", "false"):
        return float(text == "true")
    if text in enums:
        return float(enums[text])
    try:
        return parse_real(text)
    except ValueError:
        raise ScriptError(f"text {text!r} is no number") from None


def combine(sign: str, left: Any, right: Any) -> Any:
    """`left sign right` for every binary operator but comparisons and assignments."""
    for value, side in ((left, "left"), (right, "right")):
        if value is EMPTY:
            raise ScriptError(f"the {side} operand of '{sign}' has no value")
    if sign == "..":
        return _joined(left, right)
    if is_number(left) and is_number(right):
        if sign in ("&", "|", "^"):
            return _bits(sign, whole(left, sign), whole(right, sign))
        if sign in ("&&", "||"):
            a, b = truth(left, f"the left side of '{sign}'"), truth(right, f"the right side of '{sign}'")
            return float(a and b if sign == "&&" else a or b)
        return calculate(sign, number(left, f"left of '{sign}'"), number(right, f"right of '{sign}'"))
    if sign == "+" and isinstance(left, str) and isinstance(right, str):
        return left + right
    raise ScriptError(f"'{sign}' cannot be used between {shown(left)} and {shown(right)}")


def calculate(sign: str, left: float, right: float) -> float:
    """`+ - * /` in doubles; division by zero gives infinity."""
    if sign == "+":
        return left + right
    if sign == "-":
        return left - right
    if sign == "*":
        return left * right
    if right == 0.0:
        return math.nan if left == 0.0 or math.isnan(left) else math.copysign(math.inf, left) * math.copysign(1.0, right)
    return left / right


def _bits(sign: str, left: int, right: int) -> float:
    return float(left & right if sign == "&" else left | right if sign == "|" else left ^ right)


def _joined(left: Any, right: Any) -> str:
    texts, numbers = [isinstance(v, str) for v in (left, right)], [is_number(v) for v in (left, right)]
    if any(texts) and all(t or n for t, n in zip(texts, numbers, strict=True)):
        return "".join(_as_text(v) for v in (left, right))
    raise ScriptError(f"'..' joins texts, not {shown(left)} and {shown(right)}")


def _as_text(value: Any) -> str:
    return str(int(value)) if isinstance(value, bool) else to_text(value)


def compare(sign: str, left: Any, right: Any, enums: Mapping[str, int]) -> bool:
    """`left sign right`; numbers within EPSILON are equal, texts compare by bytes, a text is converted to meet a number."""
    for value, side in ((left, "left"), (right, "right")):
        if value is EMPTY:
            raise ScriptError(f"the {side} operand of '{sign}' has no value")
    if isinstance(left, str) and isinstance(right, str):
        return _holds(sign, left.encode(), right.encode(), left == right)
    if isinstance(left, str) and is_number(right):
        left = number_of_text(left, enums)
    elif isinstance(right, str) and is_number(left):
        right = number_of_text(right, enums)
    if not (is_number(left) and is_number(right)):
        raise ScriptError(f"'{sign}' cannot compare {shown(left)} and {shown(right)}")
    a, b = number(left, f"left of '{sign}'"), number(right, f"right of '{sign}'")
    return _holds(sign, a, b, abs(a - b) <= EPSILON)


def _holds(sign: str, a: Any, b: Any, same: bool) -> bool:
    if sign == "==":
        return same
    if sign == "!=":
        return not same
    # written as BehaviorTree.CPP writes them: a comparison with nan is true
    return not {"<": a >= b, ">": a <= b, "<=": a > b, ">=": a < b}[sign]


def assign(key: str, entry: Entry, value: Any, enums: Mapping[str, int]) -> Any:
    """`:=` and `=`: store by the rules of the entry's kind; the value that is stored."""
    if value is EMPTY:
        raise ScriptError(f"what is assigned to {key!r} has no value")
    old = entry.value
    try:
        if isinstance(value, str) and not isinstance(old, str) and not (old is EMPTY and _is_open(entry)):
            stored = _parsed(key, entry, value, enums)
        else:
            stored = value if old is EMPTY else _like(key, old, value)
        entry.put(stored)
    except PortProblem as problem:
        raise ScriptError(str(problem)) from None
    return entry.value


def update(key: str, entry: Entry, sign: str, value: Any) -> Any:
    """`+= -= *= /=`: the value that is stored."""
    old = entry.value
    if old is EMPTY or value is EMPTY:
        raise ScriptError(f"'{sign}' needs a value on both sides; {key!r} has none" if old is EMPTY else f"the right side of '{sign}' has no value")
    if is_number(value):
        if not is_number(old):
            raise ScriptError(f"'{sign}' cannot be used on {key!r}, which is {shown(old)}")
        new: Any = calculate(sign[0], number(old, key), number(value, f"right of '{sign}'"))
    elif isinstance(value, str) and sign == "+=" and isinstance(old, str):
        new = old + value
    else:
        raise ScriptError(f"'{sign}' cannot be used between {shown(old)} and {shown(value)}")
    try:
        entry.put(_like(key, old, new))
    except PortProblem as problem:
        raise ScriptError(str(problem)) from None
    return entry.value


def _is_open(entry: Entry) -> bool:
    return entry.kind is None or not entry.kind.typed


def _parsed(key: str, entry: Entry, text: str, enums: Mapping[str, int]) -> Any:
    """A text for an entry that holds something else."""
    if entry.kind is not None and entry.kind.typed:
        return entry.kind.convert(text)
    if is_number(entry.value):
        return number_of_text(text, enums)
    raise ScriptError(f"{key!r} is {shown(entry.value)} and cannot take a text")


def _like(key: str, old: Any, value: Any) -> Any:
    """`value` in the kind that `old` has: an integer entry refuses a fraction, a text entry refuses numbers."""
    if isinstance(old, str) and isinstance(value, str):
        return value
    if is_number(old) and is_number(value):
        if isinstance(old, float):
            return number(value, key)
        if math.isfinite(value) and value == int(value):
            return bool(value) if isinstance(old, bool) and value in (0, 1) else int(value)
        raise ScriptError(f"{key!r} holds whole numbers and cannot take {shown(value)}")
    if type(old) is type(value):
        return value
    raise ScriptError(f"{key!r} is {shown(old)} and cannot take {shown(value)}")


def shown(value: Any) -> str:
    """A value as a report names it."""
    if isinstance(value, str):
        return f"text {value!r}"
    return f"number {value:g}" if is_number(value) else f"a {type(value).__name__}"
