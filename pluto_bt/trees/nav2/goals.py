"""GoalUpdatedController and GoalUpdater, and how Nav2's nodes see that the goal has changed."""

from __future__ import annotations

from typing import Any, ClassVar, Final

from pluto_bt.behaviours.destinations import Destination, Destinations
from pluto_bt.trees.engine.node import DecoratorNode, start
from pluto_bt.trees.engine.status import IDLE, RUNNING, Result
from pluto_bt.trees.ports import PortModel, PortProblem
from pluto_bt.trees.python_types import kind_of_type
from pluto_bt.trees.scopes import EMPTY, MissingValue, Scope

GOAL, GOALS = kind_of_type(Destination), kind_of_type(Destinations)
GOAL_PORTS: Final = {
    "goal": PortModel("goal", kind=GOAL, required=False, description="the goal; without it the entry `goal`"),
    "goals": PortModel("goals", kind=GOALS, required=False, description="the goals; without it the entry `goals`"),
}


class GoalWatch:
    """Whether `goal` or `goals` have changed since the last look: by the node's ports, or by the entries of these names where it has none."""

    def __init__(self, node: Any) -> None:
        self._node = node
        self._seen: tuple[Any, ...] = ()

    def look(self) -> bool:
        """Look once; the first look finds nothing changed."""
        now = tuple(self._value(name) for name in GOAL_PORTS)
        before, self._seen = self._seen, now
        return bool(before) and before != now

    def _value(self, name: str) -> Any:
        reader = self._node.readers.get(name)
        if reader is not None:
            try:
                return reader()
            except MissingValue:
                return None
            except PortProblem as problem:
                self._node.fail(str(problem))
        entry = self._node.scope.find(name) if self._node.scope is not None else None
        return None if entry is None or entry.value is EMPTY else entry.value


class GoalUpdatedController(DecoratorNode):
    """The child on activation, when the goal has changed, and while it is RUNNING; RUNNING between these."""

    PORTS: ClassVar = dict(GOAL_PORTS)

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.scope: Scope | None = None  # set by the loader
        self._goals = GoalWatch(self)

    def step(self) -> Result:
        is_first = self.status is IDLE
        has_changed = self._goals.look()
        start(self)
        if not (is_first or has_changed or self.child.status is RUNNING):
            return RUNNING
        return self.pass_on()


class GoalUpdater(DecoratorNode):
    """Passes its input on to its output, or a newer goal from the entry `goal_update` (`goals_update`) of the main tree; always ticks the child.

    A goal without stamp is always newer.
    """

    PORTS: ClassVar = {
        "input_goal": PortModel("input_goal", kind=GOAL, required=False, description="the goal to begin with"),
        "input_goals": PortModel("input_goals", kind=GOALS, required=False, description="the goals to begin with"),
        "output_goal": PortModel("output_goal", "out", GOAL, required=False, description="the newer one"),
        "output_goals": PortModel("output_goals", "out", GOALS, required=False, description="the newer ones"),
    }

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.scope: Scope | None = None  # set by the loader

    def step(self) -> Result:
        for what, kind in (("goal", GOAL), ("goals", GOALS)):
            given = self._given(f"input_{what}")
            newer = self._update(f"@{what}_update", kind)
            chosen = newer if newer is not None and (given is None or not newer.stamp_ns or newer.stamp_ns > given.stamp_ns) else given
            if chosen is not None:
                self.write(f"output_{what}", chosen)
        return self.pass_on()

    def _given(self, port: str) -> Any:
        try:
            return self.readers[port]() if port in self.readers else None
        except MissingValue:
            return None
        except PortProblem as problem:
            self.fail(str(problem))

    def _update(self, key: str, kind: Any) -> Any:
        entry = self.scope.find(key) if self.scope is not None else None
        if entry is None or entry.value is EMPTY:
            return None
        try:
            return kind.convert(entry.value)
        except PortProblem as problem:
            self.fail(f"entry {key!r}: {problem}")
