"""The world's script: what is due at a time, and what happens on entering a place."""

from __future__ import annotations

from pluto_bt.maps.script import Action, At, When
from pluto_bt.maps.world import World
from sim.regions import Regions
from sim.simtime import NEVER_NS, NS, ticks_up


class Script:
    """Actions in the order of time; those of one time, and those of one entering, in the order of the file."""

    def __init__(self, world: World) -> None:
        timed = [(ticks_up(round(entry.t_s * NS)), entry) for entry in world.script if isinstance(entry, At)]
        self._timed = sorted(timed, key=lambda item: item[0])
        self._next = 0
        places = {terrain.id: terrain.points for terrain in world.terrains} | {area.id: area.points for area in world.areas}
        self._whens = [entry for entry in world.script if isinstance(entry, When) and entry.inside in places]
        self._regions = Regions([places[when.inside] for when in self._whens])
        self._inside: tuple[int, ...] = ()
        self._spent: dict[int, None] = {}

    def next_ns(self) -> int:
        """When the next timed actions are due."""
        return self._timed[self._next][0] if self._next < len(self._timed) else NEVER_NS

    def due(self, now_ns: int) -> list[Action]:
        """The timed actions that are due and not yet given out."""
        actions: list[Action] = []
        while self.next_ns() <= now_ns:
            actions += self._timed[self._next][1].actions
            self._next += 1
        return actions

    def entered(self, x_m: float, y_m: float) -> list[Action]:
        """The actions of the places that the robot has entered since the last call; a robot that starts inside enters at the start."""
        inside = self._regions.at(x_m, y_m) if self._whens else self._inside
        if inside is self._inside:
            return []
        new = [i for i in inside if i not in self._inside and i not in self._spent]
        self._inside = inside
        self._spent.update((i, None) for i in new if self._whens[i].once)
        return [action for i in new for action in self._whens[i].actions]
