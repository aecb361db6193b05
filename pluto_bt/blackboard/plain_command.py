"""What a sender hands to an inbox, made plain: whole flags and floats in tuples, as the links and the black box read them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from pluto_bt.blackboard.messages import ActuatorState, Pair

NO_PAIR: Pair = (math.nan, math.nan)
REST: Pair = (0.0, 0.0)
TEXTS = (str, bytes)  # Python would read numbers in them


def plain(command: ActuatorState) -> ActuatorState:
    """The same command, and the same object where it is plain already; lists, arrays and numpy's numbers are taken for what they say.

    An empty `acceleration` or `force` is a missing one: the manual's commands need not have them. One that is misshapen otherwise (an
    element is missing or too many, a text, half a flag) gets NaN for numbers: every link refuses that with `bad-command` and stands.

    Raises: TypeError if it is no ActuatorState at all.
    """
    if not isinstance(command, ActuatorState):
        raise TypeError(f"expected an ActuatorState, found {type(command).__name__}")
    pairs = (command.position, command.velocity, command.acceleration)
    if type(command.flags) is int and type(command.stamp_s) is float and all(map(_is_pair, pairs)) and _is_plain(command.force):
        return command
    try:
        acceleration, force = _floats(command.acceleration), _floats(command.force)
        pairs = (_pair(command.position), _pair(command.velocity), _pair(acceleration) if acceleration else REST)
        return ActuatorState(float(command.stamp_s), _whole(command.flags), *pairs, force or (0.0,))
    except (TypeError, ValueError, OverflowError):
        return ActuatorState(0.0, command.flags if type(command.flags) is int else 0, NO_PAIR, NO_PAIR)


def _whole(flags: Any) -> int:
    if isinstance(flags, TEXTS) or int(flags) != flags:
        raise TypeError("no whole number")
    return int(flags)


def _pair(values: Iterable[Any]) -> Pair:
    first, second = _floats(values)
    return first, second


def _floats(values: Iterable[Any]) -> tuple[float, ...]:
    numbers = tuple(values)
    if any(isinstance(number, TEXTS) for number in numbers):
        raise TypeError("a text")
    return tuple(map(float, numbers))


def _is_pair(values: tuple[float, ...]) -> bool:
    return type(values) is tuple and len(values) == 2 and type(values[0]) is float and type(values[1]) is float


def _is_plain(values: tuple[float, ...]) -> bool:
    return type(values) is tuple and len(values) > 0 and all(type(value) is float for value in values)
