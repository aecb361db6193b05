"""TopicCompare and WaitFor: a field of a topic against a value."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, Final, get_args, get_origin

import msgspec
from py_trees.common import Status

from pluto_bt.behaviours.conditions import Condition
from pluto_bt.behaviours.leaf import NO_PORTS
from pluto_bt.behaviours.motion_leaf import MOTION_OUTPUTS
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.messages import Message
from pluto_bt.blackboard.topics import TOPICS

SIGNS: Final[dict[str, Callable[[Any, Any], bool]]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
TYPES: Final[dict[str, type[Message]]] = {topic.name: topic.type for topic in TOPICS}
COMPARE_INPUTS: Final = {
    "topic": Port(str, True, "name of the topic"),
    "field": Port(str, True, "field of its message; one number of several by a dot: pose.0, velocity.1"),
    "is": Port(str, False, "how to compare", "==", choices=tuple(SIGNS)),
    "value": Port(str, True, "number, true, false or text"),
}


class TopicCompare(Condition):
    """Compares one field of the newest value of a topic. Numbers compare as numbers, the rest as text."""

    INPUT_PORTS = {**COMPARE_INPUTS}
    OUTPUT_PORTS = NO_PORTS

    @classmethod
    def port_problems(cls, given: Mapping[str, str]) -> Iterator[tuple[str, str, Iterable[str]]]:
        """For `pluto check`: (port, what is wrong, the words that would do) of ports that stand as literals."""
        topic, field = given.get("topic"), given.get("field")
        if topic is not None and topic not in TYPES:
            yield "topic", f'there is no topic "{topic}"', TYPES
        elif topic is not None and field is not None and not has_field(TYPES[topic], field):
            yield "field", f'{topic} has no field "{field}"', field_names(TYPES[topic])

    def ask(self, robot: Robot) -> tuple[bool, str]:
        """FAILURE too if there is no value, no such field, or the value is too old."""
        topic, field = str(self.get_input("topic")), str(self.get_input("field"))
        if topic not in TYPES:
            return False, f'no topic "{topic}"'
        if robot.is_stale(topic):
            return False, f"{topic} has no fresh value"
        try:
            found = field_of(robot.newest(topic), field)
        except (AttributeError, IndexError, ValueError, TypeError):
            return False, f'{topic} has no field "{field}"'
        return compare(found, str(self.get_input("is")), str(self.get_input("value"))), f"{field} is {found}"


class WaitFor(TopicCompare):
    """RUNNING until the comparison holds; fails with `timeout` if it takes too long."""

    KIND = "Action"

    INPUT_PORTS = {**COMPARE_INPUTS, "timeout_s": Port(float, False, "fails with `timeout` after so long", math.inf, unit="s", ge=0.0)}
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def initialise(self) -> None:
        """Time counts from the first tick."""
        self._start_s = self.now_s()

    def act(self, robot: Robot) -> Status:
        """SUCCESS, or wait on."""
        is_so, text = self.ask(robot)
        if is_so:
            return self.succeed(text)
        if self.now_s() - self._start_s >= float(self.get_input("timeout_s")):
            return self.fail("timeout", text)
        return self.wait(text)


def field_of(message: Any, field: str) -> Any:
    """`pose.0` → the first number of `pose`. Only the message's own fields, never attributes of Python.

    Raises AttributeError, IndexError, ValueError or TypeError if there is none.
    """
    name, *indexes = field.split(".")
    if name not in message.__struct_fields__:
        raise AttributeError(name)
    value = getattr(message, name)
    for index in indexes:
        value = value[int(index)]
    return value


def has_field(kind: type[Message], field: str) -> bool:
    """True if `field_of` can find such a field in messages of a type; an item of a tuple without fixed length may be there."""
    name, *indexes = field.split(".")
    declared = {one.name: one.type for one in msgspec.structs.fields(kind)}.get(name)
    for index in indexes:
        items = get_args(declared)
        if get_origin(declared) is not tuple or not index.isdecimal():
            return False
        is_open = items[-1] is Ellipsis
        if not is_open and int(index) >= len(items):
            return False
        declared = items[0] if is_open else items[int(index)]
    return declared in (int, float, bool, str)


def field_names(kind: type[Message]) -> list[str]:
    """Every field that `TopicCompare` can ask for; of a tuple without fixed length the first item stands for all."""
    names = []
    for one in msgspec.structs.fields(kind):
        items = get_args(one.type) if get_origin(one.type) is tuple else ()
        count = 1 if items and items[-1] is Ellipsis else len(items)
        names += [f"{one.name}.{i}" for i in range(count)] if items else [one.name]
    return [name for name in names if has_field(kind, name)]


def compare(found: Any, sign: str, text: str) -> bool:
    """Numbers and truth values as numbers where the text is one; else as text."""
    if isinstance(found, bool):
        text = {"true": "1", "false": "0"}.get(text.lower(), text)
    if isinstance(found, (bool, int, float)):
        try:
            return bool(SIGNS[sign](float(found), float(text)))
        except ValueError:
            return sign == "!="
    return bool(SIGNS[sign](str(found), text))
