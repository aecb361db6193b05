"""The legs of a mission: where it drives, in order, as far as the file alone tells.

A goal is known if it stands in the file, or in an entry that has a value before the first tick and that nothing writes; in a Loop over such a
list each element is a leg. The robot is taken to succeed: after a Fallback it stands where its first child brings it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from pluto_bt.behaviours.destinations import Destination, Destinations
from pluto_bt.source import Place
from pluto_bt.trees.checks.entries import Home, home_key, known_text, written_homes
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.pointers import key_of
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.values import DOUBLE, PortProblem

Point = tuple[float, float]
STAYS: Final = "stays"  # a leaf that leaves the robot where it is
ASKED: Final = "asked"  # the same, but it asks for the way to its goal
MOST_LEGS: Final = 500
ALTERNATIVES: Final = ("IfThenElse", "WhileDoElse", "Switch2", "Switch3", "Switch4", "Switch5", "Switch6")


@dataclass(frozen=True)
class Leg:
    """One drive to a known goal.

    Attributes:
        way: "straight", "found" where the leaf looks for a way as it goes, "planned" where it plans one on the map.
        start: where the leg before ended; None if that is not known.
        goal: x m, y m, map frame; a name of a goal of the map is kept as text.
        tolerance_m: nearer counts as reached.
        speed_mps: the leaf's own limit; infinite if only the platform limits it.
    """

    plan: Plan
    place: Place
    way: str
    start: Point | None
    goal: Point | str
    tolerance_m: float
    speed_mps: float


class Course:
    """One walk through a mission from a start (None: not known)."""

    def __init__(self, nodes: list[Plan], start: Point | None, places: Mapping[str, Point]) -> None:
        """`places`: the goals of the map, by name."""
        self._places = places
        self.legs: list[Leg] = []
        self._bound: dict[Home, str] = {}  # elements of the loops around the node that is looked at
        self._written = written_homes(nodes)
        self._seen: set[tuple[int, Point | None, Point | str]] = set()
        self._visit(nodes[0], start)

    def _visit(self, plan: Plan, at: Point | None) -> Point | None:
        """Note the legs of a node that begins at `at`; where it leaves the robot."""
        name, children = plan.type_name, plan.children
        if not children:
            return self._leaf(plan, at)
        if len(self.legs) >= MOST_LEGS:
            return None
        if name in ("Fallback", "AsyncFallback", "ReactiveFallback"):
            ends = [self._visit(child, at if i == 0 else None) for i, child in enumerate(children)]
            return ends[0]
        if name in ALTERNATIVES:
            first = 1 if name in ("IfThenElse", "WhileDoElse") else 0
            ends = [self._visit(child, at) for child in children][first:]
            return ends[0] if len(set(ends)) == 1 else None
        if name in ("Parallel", "ParallelAll"):
            moved = [end for child in children if (end := self._visit(child, at)) != at]
            return at if not moved else moved[0] if len(moved) == 1 else None
        if name.startswith("Loop"):
            return self._loop(plan, at)
        rounds = 1 if name != "Repeat" or plan.element.get("num_cycles") == "1" else 2  # the second shows the way back
        for _ in range(rounds):
            for child in children:
                at = self._visit(child, at)
        return at

    def _loop(self, plan: Plan, at: Point | None) -> Point | None:
        queue, value = plan.element.attributes.get("queue"), plan.element.attributes.get("value")
        key = key_of("value", value.value) if value is not None else None
        elements = self._text(plan, "queue") if queue is not None else None
        if key is None or elements is None:
            return self._visit(plan.children[0], None)  # how often it goes round is not known
        home = home_key(plan, key)
        for element in [part for part in elements.split(";") if part][:MOST_LEGS]:
            self._bound[home] = element
            at = self._visit(plan.children[0], at)
        self._bound.pop(home, None)
        return at

    def _leaf(self, plan: Plan, at: Point | None) -> Point | None:
        make: Any = plan.node_type.make if plan.node_type is not None else None
        way = getattr(make, "WAY", "")
        if not way or plan.node_type is None:
            return None if getattr(make, "DRIVES", False) else at
        if way == STAYS:
            return at
        if way == ASKED:
            self._way_to(plan, "planned", None if "start" in plan.element.attributes else at)
            return at
        return self._way_to(plan, way, at)

    def _way_to(self, plan: Plan, way: str, at: Point | None) -> Point | None:
        """Note the legs to the goals of a leaf; the last goal."""
        assert plan.node_type is not None  # the caller looked
        port = next((plan.node_type.ports[name] for name in ("goal", "goals") if name in plan.node_type.ports), None)
        goals = self._goals(plan, port) if port is not None else []
        for goal in goals:
            self._add(plan, way, at, goal, plan.element.attributes[port.name].value_place if port is not None else plan.element.place)
            at = goal if isinstance(goal, tuple) else self._places.get(goal)
        return at if goals else None

    def _add(self, plan: Plan, way: str, at: Point | None, goal: Point | str, place: Place) -> None:
        assert plan.node_type is not None  # the caller looked
        ports, step = plan.node_type.ports, (id(plan.element), at, goal)
        if step not in self._seen:
            self._seen.add(step)
            tolerance_m = self._number(plan, ports.get("tolerance_m"), 0.3)
            speed_mps = self._number(plan, ports.get("max_speed_mps"), math.inf)
            self.legs.append(Leg(plan, place, way, at, goal, tolerance_m, speed_mps))

    def _goals(self, plan: Plan, port: PortModel) -> list[Point | str]:
        """The goals that the port names, if they are known."""
        text = self._text(plan, port.name)
        if text is None:
            return []
        try:
            value = port.kind.convert(text)
        except PortProblem:
            return []  # told by the static check
        goals = [_place_of(one) for one in (value if isinstance(value, Destinations) else [value])]
        return [goal for goal in goals if goal is not None]

    def _number(self, plan: Plan, port: PortModel | None, otherwise: float) -> float:
        if port is None:
            return otherwise
        text = self._text(plan, port.name)
        try:
            return float(DOUBLE.convert(text if text is not None else port.default))
        except (PortProblem, TypeError):
            return otherwise

    def _text(self, plan: Plan, port: str) -> str | None:
        """The text that a port has whenever it is read; None if that is not known."""
        attribute = plan.element.attributes.get(port)
        key = key_of(port, attribute.value) if attribute is not None else None
        if key is not None and (home := home_key(plan, key)) in self._bound:
            return self._bound[home]
        return known_text(plan, port, () if port == "queue" else self._written)


def _place_of(value: object) -> Point | str | None:
    """A goal as a leg has it."""
    if isinstance(value, Destination):
        return value.name or (value.x_m, value.y_m)
    is_point = isinstance(value, tuple) and len(value) >= 2 and all(isinstance(part, float) and math.isfinite(part) for part in value)
    return (value[0], value[1]) if is_point and isinstance(value, tuple) else None
