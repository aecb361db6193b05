"""Branches that are never ticked."""

from __future__ import annotations

from collections.abc import Mapping

from pluto_bt.trees.checks.outcomes import GUARDS, deciding_condition
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.report import Report


def check_reach(root: Plan, unreached: Mapping[int, Mapping[int, str]], report: Report) -> None:
    """Warn of each branch that no tick comes to. A tree that is used twice may be reached once, so elements count, not nodes.

    Args:
        unreached: by id of a plan, its children that are never ticked: index → why.
    """
    reached: set[int] = set()
    lost: dict[int, tuple[Plan, str]] = {}  # by the element of the parent: the first child stands for those after it
    decided: dict[int, tuple[Plan, str]] = {}
    waiting = [root]
    while waiting:
        plan = waiting.pop()
        name = deciding_condition(plan) if any(name in plan.element.attributes for name in GUARDS) else ""
        if name:
            decided.setdefault(id(plan.element), (plan, name))
            continue
        reached.add(id(plan.element))
        why = unreached[id(plan)]
        for i, child in enumerate(plan.children):
            if i not in why:
                waiting.append(child)
            elif id(plan.element) not in lost:
                lost[id(plan.element)] = child, why[i]
    for plan, reason in lost.values():
        if id(plan.element) not in reached:
            what = f"<{plan.element.tag}> can never be reached: {reason}"
            report.warning(plan.element.place, "unreachable", what, expected="a branch that can be ticked", mend="delete it, or what hides it")
    for plan, name in decided.values():
        if id(plan.element) not in reached:
            always = "false" if name == "_while" else "true"
            what = f"<{plan.element.tag}> is never ticked: {name} is always {always}"
            report.warning(plan.element.attributes[name].value_place, "unreachable", what, expected="a condition on entries")
