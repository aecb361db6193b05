"""Typed ports of leaves: py_trees' `PortInformation` with a unit, limits and choices, and the text form of a value.

A leaf declares its ports as class attributes, as py_trees does; `INOUT_PORTS` is our extension (py_trees has no such direction):

    class GoTo(BehaviourWithPorts):
        INPUT_PORTS = {"goal": Port(tuple[float, float], description="where to", unit="m")}
        OUTPUT_PORTS = {"reason": Port(str, required=False)}
        INOUT_PORTS = {"visits": Port(int, required=False)}

`data_type` may be int, float, bool, str, `list[...]` of those, `tuple[float, float]` (a point, "x;y" or "x,y"),
`tuple[float, float, float]` (a pose "x;y;theta_deg"), `list[tuple[float, float]]` ("1,2;3,4"), an Enum, a Literal, `X | None`, `Any`,
or a class with a classmethod `from_text(str)` that raises ValueError with a plain sentence.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

from py_trees.ports import PortInformation


@dataclass(frozen=True)
class Port(PortInformation):
    """One port of a leaf.

    Attributes:
        unit: unit of the value as a person writes it ("m", "m/s", "deg", "s"); shown by `pluto nodes` and in faults.
        ge: smallest value allowed, for numbers (each number of a list or point).
        le: largest value allowed.
        choices: the words allowed, for texts.
        names: "area" for the id of an area of the map; a check against a world looks whether it is there.
    """

    unit: str = ""
    ge: float | None = None
    le: float | None = None
    choices: tuple[str, ...] = ()
    names: str = ""

    def __post_init__(self) -> None:
        """py_trees' own check of the default does not know tuples; the loader checks values where they are written."""


def text_of(value: Any) -> str:
    """The text that a mission file would hold for `value`; reading it back gives the value again.

    >>> text_of([(1.0, 2.0), (3.0, 4.5)])
    '1.0,2.0;3.0,4.5'
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, list):
        return ";".join(",".join(map(text_of, item)) if isinstance(item, tuple) else text_of(item) for item in value)
    if isinstance(value, tuple):
        return ";".join(map(text_of, value))
    to_text = getattr(value, "to_text", None)
    return str(to_text()) if callable(to_text) else str(value)
