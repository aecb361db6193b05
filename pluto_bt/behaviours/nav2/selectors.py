"""Nav2's selectors: the name of a planner, controller, … comes from a topic, else from the port. The topic is an entry of the main tree here."""

from __future__ import annotations

from typing import ClassVar

from py_trees.common import Status

from pluto_bt.behaviours.leaf import Leaf
from pluto_bt.behaviours.nav2.planning import value_of
from pluto_bt.behaviours.ports import Port


class Selector(Leaf):
    """Writes the name that was written last to the entry `topic_name` of the main tree, else the default; FAILURE where there is neither."""

    WHAT: ClassVar[str] = ""

    def update(self) -> Status:
        """Answers at once."""
        topic = str(self.get_input("topic_name"))
        chosen = str(self._store.get(f"@{topic}", "") or value_of(self, f"default_{self.WHAT}", ""))
        if not chosen:
            self.feedback_message = f"neither default_{self.WHAT} nor the entry {topic} has a value"
            return Status.FAILURE
        self._set_output(f"selected_{self.WHAT}", chosen)
        return self.succeed(chosen)


def _selector(what: str, title: str) -> type[Selector]:
    inputs = {
        "topic_name": Port(str, False, "the entry of the main tree that chooses", f"{what}_selector"),
        f"default_{what}": Port(str, False, "the choice until somebody writes that entry"),
    }
    outputs = {f"selected_{what}": Port(str, False, "the choice")}
    doc = f"Chooses a {what.replace('_', ' ')}: by an entry of the main tree, else the default. Our robots have one of each."
    members = {"WHAT": what, "INPUT_PORTS": inputs, "OUTPUT_PORTS": outputs, "__module__": __name__, "__doc__": doc}
    return type(f"{title}Selector", (Selector,), members)


PlannerSelector, ControllerSelector = _selector("planner", "Planner"), _selector("controller", "Controller")
SmootherSelector, GoalCheckerSelector = _selector("smoother", "Smoother"), _selector("goal_checker", "GoalChecker")
ProgressCheckerSelector, PathHandlerSelector = _selector("progress_checker", "ProgressChecker"), _selector("path_handler", "PathHandler")
