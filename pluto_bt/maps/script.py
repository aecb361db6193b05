"""A world's script as data: what happens when or where. Metres and radians, map frame.

The contract of its XML is DESIGN.md, section 5. Every item keeps its `place` in the file for later checks.
"""

from __future__ import annotations

from dataclasses import dataclass

from pluto_bt.source.faults import NOWHERE, Place


@dataclass(frozen=True, slots=True)
class Remove:
    """Takes a shape or actor away."""

    id: str
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class Put:
    """`<place>`: moves a shape's or actor's centre and makes it present; x, y None = where the file drew it."""

    id: str
    x_m: float | None
    y_m: float | None
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class Carry:
    """`<place>` with the robot's name: somebody lifts the robot and sets it down there; its wheels notice nothing. theta None = as it stood."""

    x_m: float
    y_m: float
    theta_rad: float | None = None
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class FaultAction:
    """A device or a part of the software fails. `for_s` 0 = for ever; the other numbers as the kind needs (docs/worlds.md)."""

    device: str
    kind: str
    for_s: float = 0.0
    value: float | None = None
    rate: float | None = None
    delay_s: float | None = None
    beams: tuple[int, int] | None = None
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class SetTopic:
    """Writes a topic whose writer is `world`."""

    topic: str
    value: str
    place: Place = NOWHERE


Action = Remove | Put | Carry | FaultAction | SetTopic


@dataclass(frozen=True, slots=True)
class At:
    """Actions at a time of the run."""

    t_s: float
    actions: tuple[Action, ...]
    place: Place = NOWHERE


@dataclass(frozen=True, slots=True)
class When:
    """Actions when the robot enters an area or terrain (each time it enters; `once`: only the first time)."""

    inside: str
    once: bool
    actions: tuple[Action, ...]
    place: Place = NOWHERE
