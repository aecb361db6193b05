"""One row of the table of modules: what runs, how often, in which thread, and what its failure means."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from pluto_bt.runtime.clock import NS
from pluto_bt.runtime.component import Component
from pluto_bt.source import PlutoError


@dataclass(frozen=True, slots=True)
class Module:
    """A row of MODULES (pluto_bt/system.py).

    Attributes:
        name: also the name of the writer of its topics.
        factory: "package.module:Class", imported when the module is made, so that a missing optional library breaks one row only.
        period_s: time between two steps; 0 = only when woken.
        group: the thread it lives in: io, estimation, chain or mission.
        needs: modules that must be started before it.
        critical: its failure stops the robot.
        budget_ms: time one step may take.
        wakes: topics and inboxes whose change calls for a step at once.
        device: made only if the robot has this device ("" = always).
    """

    name: str
    factory: str
    period_s: float
    group: str
    needs: tuple[str, ...] = ()
    critical: bool = False
    budget_ms: float = 5.0
    wakes: tuple[str, ...] = ()
    device: str = ""

    @property
    def period_ns(self) -> int:
        """The period in integer nanoseconds: due times are `start + k * period`, so ties are exact and nothing drifts."""
        return round(self.period_s * NS)

    def load(self) -> Callable[[Any], Component]:
        """The factory itself."""
        package, _, name = self.factory.partition(":")
        factory: Callable[[Any], Component] = getattr(importlib.import_module(package), name)
        return factory


def in_start_order(modules: Iterable[Module]) -> tuple[Module, ...]:
    """The rows, each after all that it needs, otherwise in table order. Needs that are not in the list are ignored.

    Raises: PlutoError if modules need each other in a circle.
    """
    rows = {module.name: module for module in modules}
    order: dict[str, Module] = {}

    def visit(module: Module, path: tuple[str, ...]) -> None:
        if module.name in path:
            raise PlutoError(f"modules need each other: {' -> '.join((*path, module.name))}")
        for need in module.needs:
            if need in rows and need not in order:
                visit(rows[need], (*path, module.name))
        order.setdefault(module.name, module)

    for module in rows.values():
        visit(module, ())
    return tuple(order.values())
