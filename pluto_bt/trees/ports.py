"""What the engine knows of a port: direction, kind, default, limits. Leaves' own declarations are turned into this once per class."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

from pluto_bt.maps.numbers import MAX_METRES
from pluto_bt.trees.python_types import kind_of_type
from pluto_bt.trees.values import ANYTHING, Kind, PortProblem

Direction = Literal["in", "out", "inout"]

POSE = kind_of_type(tuple[float, float, float])

__all__ = ["Direction", "PortModel", "PortProblem", "is_beyond", "models_of_class", "range_problem"]


@dataclass(frozen=True)
class PortModel:
    """One declared port.

    Attributes:
        default: text, or a value of the kind; None if there is none.
        required: an input that must be given (found at the first tick in BehaviorTree.CPP, by `pluto check` here).
        at_load: a missing one already stops the loading, as in BehaviorTree.CPP.
        names: what of the world a text names: "area", or "" for nothing.
    """

    name: str
    direction: Direction = "in"
    kind: Kind = ANYTHING
    default: Any = None
    required: bool = True
    at_load: bool = False
    description: str = ""
    unit: str = ""
    ge: float | None = None
    le: float | None = None
    choices: tuple[str, ...] = ()
    names: str = ""

    @property
    def form(self) -> str:
        """What a person writes here, with unit and limits, for faults and tables."""
        parts = [f"one of {', '.join(self.choices)}" if self.choices else self.kind.form]
        if self.unit:
            parts.append(f"in {self.unit}")
        if self.ge is not None:
            parts.append(f"at least {self.ge:g}")
        if self.le is not None:
            parts.append(f"at most {self.le:g}")
        return ", ".join(parts)


def range_problem(model: PortModel, value: Any) -> str:
    """Why `value` is outside what the port allows, or ""."""
    if model.choices and value not in model.choices:
        return f"expected one of {', '.join(model.choices)}"
    is_place = model.unit == "m" or model.kind is POSE
    for number in _numbers_in(value):
        if math.isnan(number):
            return "not a number"
        if math.isinf(number) and (model.unit or is_place):  # what has a unit is a quantity of the world
            return "not finite"
        if is_place and abs(number) > MAX_METRES:
            return f"no place or distance is beyond {MAX_METRES:g} m"
        if model.ge is not None and number < model.ge:
            return f"{number:g} is below {model.ge:g}"
        if model.le is not None and number > model.le:
            return f"{number:g} is above {model.le:g}"
    return ""


def is_beyond(value: Any) -> bool:
    """True for coordinates that no world has."""
    return any(abs(number) > MAX_METRES for number in _numbers_in(value))


def _numbers_in(value: Any) -> Iterable[float]:
    if isinstance(value, (list, tuple)):
        for item in value:
            yield from _numbers_in(item)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield value


def models_of_class(leaf: Any) -> dict[str, PortModel]:
    """The ports that a py_trees `BehaviourWithPorts` class declares; `INOUT_PORTS` is our extension."""
    found: dict[str, PortModel] = {}
    sides: tuple[tuple[Direction, str], ...] = (("in", "INPUT_PORTS"), ("out", "OUTPUT_PORTS"), ("inout", "INOUT_PORTS"))
    for direction, attribute in sides:
        for name, declared in getattr(leaf, attribute, {}).items():
            found[name] = PortModel(
                name=name,
                direction=direction,
                kind=kind_of_type(declared.data_type),
                default=declared.default_value,
                required=declared.required and direction != "out",
                description=declared.description,
                unit=getattr(declared, "unit", ""),
                ge=getattr(declared, "ge", None),
                le=getattr(declared, "le", None),
                choices=tuple(getattr(declared, "choices", ())),
                names=getattr(declared, "names", ""),
            )
    return found
