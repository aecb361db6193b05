"""Which names a world has: each once within its group, and found again when a script refers to it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from pluto_bt.source import Faults, Place, did_you_mean

Group = Literal["obstacle", "region", "line", "goal", "marker"]  # a goal and an area may both be called "kitchen"

MOST_COMPARED = 500  # names that are looked through for a similar one


class Ids:
    """The names given so far, by group."""

    def __init__(self, faults: Faults) -> None:
        self._faults = faults
        self.robot = "robot"  # its name; a script may place it
        self._places: dict[Group, dict[str, Place]] = {"obstacle": {}, "region": {}, "line": {}, "goal": {}, "marker": {}}

    def take(self, group: Group, name: str, place: Place) -> None:
        """`name` is used at `place`; a fault if another of its group has it."""
        first = self._places[group].setdefault(name, place)
        if first is not place and name:
            where = f"line {first.line}, column {first.column}" if first.file == place.file else first.file
            what = f'the id "{name}" stands twice'
            self._faults.error(place, "duplicate-id", what, expected="an id for each", found=f"the first is in {where}", mend="give it another id")

    def take_all(self, group: Group, items: Iterable[tuple[str, Place]]) -> None:
        """The names that an included map brings along."""
        for name, place in items:
            self.take(group, name, place)

    def invent(self, group: Group, tag: str, place: Place) -> str:
        """A name for something that has none: where it stands, which no one would write as an id."""
        name = f"{tag}@{place.line}"
        if name in self._places[group]:
            name += f":{place.column}"
        self.take(group, name, place)
        return name

    def is_robot(self, name: str) -> bool:
        """True if nothing but the robot has this name."""
        return name == self.robot and name not in self._places["obstacle"]

    def check(self, groups: tuple[Group, ...], name: str, place: Place, what: str) -> None:
        """A fault if nothing in these groups is called `name`."""
        if name and not any(name in self._places[group] for group in groups):
            known = [known for group in groups for known in self._places[group]][:MOST_COMPARED]
            expected = f"one of: {', '.join(known[:20])}{', …' if len(known) > 20 else ''}" if known else "the world has none"
            self._faults.error(place, "unknown-id", f'there is no {what} "{name}"', expected=expected, found=name, mend=did_you_mean(name, known))
