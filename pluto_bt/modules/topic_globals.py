"""Topics as a mission sees them: `{@Localization/Pose}` is the message, and `@Localization_Pose_x` one number of it, for scripts."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from operator import attrgetter
from typing import Any, get_args, get_origin

import msgspec

from pluto_bt.blackboard import TOPICS, Snapshot, Topic
from pluto_bt.blackboard.messages import LaserPose, Message, Pose

POSE_NAMES = ("x", "y", "z", "theta", "phi", "psi", "pan", "tilt")
SCALARS = (int, float, bool, str)
MOST_ITEMS = 16  # of a vector without fixed length: as many sonars as a ring has
Getter = Callable[[Any], Any]


def fields_of(kind: type[Message]) -> dict[str, Getter]:
    """The numbers and words of a message by name; a tuple's items carry their place, those of a pose their letter."""
    found: dict[str, Getter] = {}
    for field in msgspec.structs.fields(kind):
        if field.type in SCALARS:
            found[field.name] = attrgetter(field.name)
        elif get_origin(field.type) is tuple and get_args(field.type)[0] in SCALARS:
            is_pose = field.name == "pose" and kind in (Pose, LaserPose)
            for i, word in enumerate(_item_names(field.type, is_pose)):
                found[word if is_pose else f"{field.name}_{word}"] = _item(field.name, i)
    return found


def _item(name: str, i: int) -> Getter:
    """Reads one item of a tuple field. Raises IndexError where the tuple is shorter."""
    return lambda value: getattr(value, name)[i]


def _item_names(declared: Any, is_pose: bool) -> Iterable[str]:
    arguments = get_args(declared)
    count = MOST_ITEMS if arguments[-1] is Ellipsis else len(arguments)
    return POSE_NAMES[:count] if is_pose else [str(i) for i in range(count)]


class TopicGlobals:
    """Implements `pluto_bt.trees.scopes.Topics` over the snapshot of the tick."""

    def __init__(self, view: Callable[[], Snapshot | None] = lambda: None, topics: Iterable[Topic] = TOPICS) -> None:
        self.view = view
        self._getters: dict[str, tuple[str, Getter]] = {}
        for topic in topics:
            self._getters[topic.name] = (topic.name, lambda value: value)
            for field, getter in fields_of(topic.type).items():
                self._getters[f"{topic.name.replace('/', '_').replace('-', '_')}_{field}"] = (topic.name, getter)

    def names(self) -> Iterable[str]:
        """All names that can be read, without the `@`."""
        return self._getters

    def topic_of(self, name: str) -> str | None:
        """The topic that a name means, None for a name of no topic."""
        getter = self._getters.get(name)
        return None if getter is None else getter[0]

    def seq(self, name: str) -> int:
        """How often the topic has been written."""
        view = self.view()
        sample = None if view is None else view.newest(self._getters[name][0])
        return 0 if sample is None else sample.seq

    def get(self, name: str) -> Any:
        """The newest value. Raises KeyError for an unknown name or a topic that nobody has written."""
        topic, getter = self._getters[name]
        view = self.view()
        sample = None if view is None else view.newest(topic)
        if sample is None:
            raise KeyError(name)
        try:
            return getter(sample.value)
        except IndexError:
            raise KeyError(name) from None
