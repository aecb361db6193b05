"""Steps that stand in for those of leaves: faults that a world script lets them have, and listeners who hear how they end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from pluto_bt.trees.engine.context import Context
from pluto_bt.trees.engine.leaf import told
from pluto_bt.trees.engine.status import RUNNING, Result, name_of
from pluto_bt.trees.errors import StepError
from pluto_bt.trees.tracked import Tracked

Step = Callable[[], Result]


class StandIns:
    """Those of one mission."""

    def __init__(self, tracked: Sequence[Tracked], context: Context) -> None:
        """`tracked`: every node of the mission, depth first."""
        self._tracked, self._context = tracked, context
        self._own_steps: dict[int, Step] = {}  # of the nodes that were replaced

    def replace(self, name: str, step: Step | None) -> bool:
        """Let `step` stand in for that of all leaves called `name` (by name, type or path), None = their own again. False if there is none."""
        found = [one for one in self._tracked if not one.node.children and name in (one.plan.name, one.plan.type_name, one.path)]
        self._context.may_remember = False  # from now on not all follows from the entries
        for tracked in found:
            node = tracked.node
            own = self._own_steps.setdefault(id(node), node.step)
            node.step = own if step is None else self._begun(node, step)
        return bool(found)

    def watch(self, listen: Callable[[int, str], None]) -> None:
        """Call `listen` (number of the node, what it told its parent) whenever a leaf ends: SUCCESS, FAILURE or SKIPPED."""
        for number, tracked in enumerate(self._tracked):
            if not tracked.node.children:
                tracked.node.step = _watched(number, tracked.node.step, listen)

    def _begun(self, node: Any, step: Step) -> Step:
        def begin() -> Result:
            self._context.current = node
            try:
                return step()
            except Exception as error:
                raise StepError(node, told(error)) from error

        return begin


def _watched(number: int, step: Step, listen: Callable[[int, str], None]) -> Step:
    def watched() -> Result:
        result = step()
        if result is not RUNNING:
            listen(number, name_of(result))
        return result

    return watched
