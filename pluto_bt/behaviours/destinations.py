"""Goals as missions write them: a point, a pose, the name of a goal of the map, `home`, or the text of ROS messages (Nav2).

    "4;2"   "4;2;90"   "dock"   "home"   "0;map;4;2;0;0;0;0.7071;0.7071" (stamp in ns, frame, position, quaternion)   "json:{…}"

Several: "1,2;3,4,90;dock", or "stamp;frame" and then nine parts for each.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Final

from pluto_bt.behaviours.pose_text import POSE_PARTS, finite, header_of, member, metres, pose_of_json, pose_of_parts, read_json
from pluto_bt.maps.world import World

_NUMBER: Final = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
HOME: Final = "home"


@dataclass(frozen=True, slots=True)
class Destination:
    """One goal: x, y in metres of the map, `theta_deg` counter-clockwise from x (None = any heading); or the `name` of one of the map's."""

    x_m: float = 0.0
    y_m: float = 0.0
    theta_deg: float | None = None
    name: str = ""
    stamp_ns: int = 0
    frame: str = ""

    TEXT_FORM: ClassVar = "x;y, x;y;theta_deg, the name of a goal of the map, or home"
    ANY_ENTRY: ClassVar = True  # may share an entry with other forms of a goal, a point of GoTo above all

    @classmethod
    def from_text(cls, text: str) -> Destination:
        """Read any of the forms. Raises ValueError."""
        if text.startswith("json:"):
            return _one_of_json(read_json(text))
        parts = [part.strip() for part in re.split("[;,]", text)]
        if len(parts) == POSE_PARTS and all(map(_NUMBER.fullmatch, (parts[0], *parts[2:]))):
            return _one_of_parts(parts)
        if len(parts) in (2, 3) and all(map(_NUMBER.fullmatch, parts)):
            numbers = [finite(part) for part in parts]
            return cls(metres(numbers[0]), metres(numbers[1]), numbers[2] if len(numbers) == 3 else None)
        if len(parts) == 1 and parts[0] and not _NUMBER.fullmatch(parts[0]):
            return cls(name=parts[0])
        raise ValueError(f"expected {cls.TEXT_FORM}")

    @classmethod
    def from_value(cls, value: object) -> Destination:
        """A point or pose that another node wrote as numbers. Raises ValueError."""
        if isinstance(value, (tuple, list)) and len(value) in (2, 3) and all(isinstance(part, (int, float)) for part in value):
            return cls(metres(value[0]), metres(value[1]), float(value[2]) if len(value) == 3 else None)
        raise ValueError(f"expected {cls.TEXT_FORM}")

    @property
    def theta_rad(self) -> float | None:
        """The heading, or None for any."""
        return None if self.theta_deg is None else math.radians(self.theta_deg)

    def to_text(self) -> str:
        """The text that reads back as this place."""
        if self.name:
            return self.name
        if self.stamp_ns or self.frame:
            half = math.radians(self.theta_deg or 0.0) / 2.0
            return f"{self.stamp_ns};{self.frame};{self.x_m!r};{self.y_m!r};0;0;0;{math.sin(half)!r};{math.cos(half)!r}"
        heading = "" if self.theta_deg is None else f";{self.theta_deg!r}"
        return f"{self.x_m!r};{self.y_m!r}{heading}"

    def numbers(self, count: int) -> tuple[float, ...]:
        """As a port for a point (2) or a pose (3) takes it. Raises ValueError for a name."""
        if self.name or count not in (2, 3):
            raise ValueError(f"{self.to_text()} is not {count} numbers")
        return (self.x_m, self.y_m, self.theta_deg or 0.0)[:count]

    def on(self, world: World | None) -> Destination:
        """The place itself, looked up in the map if it is a name. Raises LookupError with a sentence."""
        if not self.name:
            return self
        goals = () if world is None else world.goals
        found = next((goal for goal in goals if goal.id == self.name), None)
        if found is not None:
            return Destination(found.x_m, found.y_m, None if found.theta_rad is None else math.degrees(found.theta_rad))
        home = None if world is None else world.home
        if self.name == HOME and home is not None:
            return Destination(home.x_m, home.y_m, None if home.theta_rad is None else math.degrees(home.theta_rad))
        known = ", ".join([*(goal.id for goal in goals), *([HOME] if home is not None else [])]) or "none"
        raise LookupError(f'the map has no goal "{self.name}"; it has {known}')


@dataclass(frozen=True, slots=True)
class Destinations(Sequence[Destination]):
    """Several goals in order."""

    items: tuple[Destination, ...] = ()
    stamp_ns: int = 0
    frame: str = ""

    TEXT_FORM: ClassVar = "places with ';' between, their parts with ',': 1,2;3,4,90;dock"
    ANY_ENTRY: ClassVar = True

    @classmethod
    def from_text(cls, text: str) -> Destinations:
        """Read any of the forms. Raises ValueError."""
        if text.startswith("json:"):
            tree = read_json(text)
            return cls(tuple(_one_of_json(one) for one in member(tree, "goals")), *header_of(tree))
        parts = text.split(";")
        if len(parts) % POSE_PARTS == 2 and _NUMBER.fullmatch(parts[0].strip()) and not _NUMBER.fullmatch(parts[1].strip()) and "," not in text:
            poses = [parts[i : i + POSE_PARTS] for i in range(2, len(parts), POSE_PARTS)]
            return cls(tuple(map(_one_of_parts, poses)), int(float(parts[0])), parts[1].strip())
        return cls(tuple(Destination.from_text(part) for part in parts if part.strip()))

    @classmethod
    def from_value(cls, value: object) -> Destinations:
        """A list of places, points or texts. Raises ValueError."""
        if isinstance(value, Destination):
            return cls((value,))
        if isinstance(value, (list, tuple)):
            return cls(tuple(_one_of_item(one) for one in value))
        raise ValueError(f"expected {cls.TEXT_FORM}")

    def to_text(self) -> str:
        """The text that reads back as these places."""
        if all(one.name or not (one.stamp_ns or one.frame) for one in self.items) and not (self.stamp_ns or self.frame):
            return ";".join(one.to_text().replace(";", ",") for one in self.items)
        full = (Destination(p.x_m, p.y_m, p.theta_deg, "", p.stamp_ns, p.frame or self.frame or "map") for p in self.items)
        return ";".join([f"{self.stamp_ns};{self.frame or 'map'}", *(one.to_text() for one in full)])

    def __len__(self) -> int:
        return len(self.items)

    def __iter__(self) -> Iterator[Destination]:
        return iter(self.items)

    def __getitem__(self, index: Any) -> Any:
        return self.items[index]

    def having(self, items: Sequence[Destination]) -> Destinations:
        """Other places under the same header."""
        return Destinations(tuple(items), self.stamp_ns, self.frame)


def _one_of_parts(parts: Sequence[str]) -> Destination:
    stamp_ns, frame, x_m, y_m, theta_deg = pose_of_parts(parts)
    return Destination(x_m, y_m, theta_deg, "", stamp_ns, frame)


def _one_of_json(tree: Any) -> Destination:
    stamp_ns, frame, x_m, y_m, theta_deg = pose_of_json(tree)
    return Destination(x_m, y_m, theta_deg, "", stamp_ns, frame)


def _one_of_item(item: object) -> Destination:
    if isinstance(item, Destination):
        return item
    return Destination.from_text(item) if isinstance(item, str) else Destination.from_value(item)
