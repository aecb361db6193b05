"""Branches of a parallel node that both drive the base: the second takes the command away from the first."""

from __future__ import annotations

from typing import Final

from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.report import Report

AT_ONCE: Final = ("Script", "SetBlackboard", "UnsetBlackboard", "AlwaysSuccess", "Say")  # they succeed in the tick they are begun
ROWS: Final = ("Sequence", "AsyncSequence", "SequenceWithMemory", "ReactiveSequence")


def check_driving(nodes: list[Plan], report: Report) -> None:
    """An error where two branches are certain to drive at the same time, a warning where they may."""
    drivers: dict[int, Plan] = {}
    for plan in reversed(nodes):
        found = plan if getattr(plan.node_type and plan.node_type.make, "DRIVES", False) else None
        for child in reversed(plan.children):
            found = drivers.get(id(child), found)
        if found is not None:
            drivers[id(plan)] = found
    told: set[int] = set()
    for plan in nodes:
        if plan.type_name in ("Parallel", "ParallelAll") and id(plan.element) not in told:
            told.add(id(plan.element))
            _check_branches([(child, drivers[id(child)]) for child in plan.children if id(child) in drivers], report)


def _check_branches(driving: list[tuple[Plan, Plan]], report: Report) -> None:
    for branch, driver in driving[1:]:
        first_branch, first = driving[0]
        is_certain = _drives_at_once(first_branch) and _drives_at_once(branch)
        place, other = driver.element.place, first.element.place
        what = f"<{driver.type_name}> {'drives' if is_certain else 'may drive'} the base while <{first.type_name}> of another parallel branch does"
        tell = report.late if is_certain else report.warning
        found = f"the other at {other.file or '<text>'}:{other.line}:{other.column}"
        mend = "the second takes the command away from the first, which fails with `cancelled`: put them in a <Sequence>"
        tell(place, "parallel-drive", what, expected="one branch that drives", found=found, mend=mend)


def _drives_at_once(plan: Plan) -> bool:
    """True if the first tick of this branch is certain to begin a leaf that drives."""
    while not any(name.startswith("_") and name not in ("_description", "_uid", "_fullpath", "_autoremap") for name in plan.element.attributes):
        if getattr(plan.node_type and plan.node_type.make, "DRIVES", False):
            return True
        children = plan.children
        if plan.type_name in ROWS:
            children = [child for i, child in enumerate(children) if not all(one.type_name in AT_ONCE for one in children[: i + 1])]
        elif plan.type_name in ("Delay", "Precondition", "SkipUnlessUpdated", "WaitValueUpdate", "RunOnce"):
            return False
        if not children:
            return False
        plan = children[0]
    return False
