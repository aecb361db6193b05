"""Literals of leaves that name something of the robot: a leaf class with a method `port_problems` judges its own ports.

It is given the ports that stand as literals in the file, and yields (port, what is wrong, the words that would do).
"""

from __future__ import annotations

from pluto_bt.source import did_you_mean
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.pointers import key_of
from pluto_bt.trees.loader.report import Report


def check_words(nodes: list[Plan], report: Report) -> None:
    """Ask each leaf class that has `port_problems`, once an element."""
    told: set[int] = set()
    for plan in nodes:
        judge = getattr(plan.node_type and plan.node_type.make, "port_problems", None)
        if judge is None or id(plan.element) in told:
            continue
        told.add(id(plan.element))
        attributes = plan.element.attributes
        given = {name: one.value for name, one in attributes.items() if key_of(name, one.value) is None}
        for port, message, known in judge(given):
            found, names = given[port], list(known)
            wanted = "one of: " + ", ".join(names) if len(names) <= 25 else f"one of {len(names)} names (docs/missions.md)"
            report.late(attributes[port].value_place, "unknown-word", message, expected=wanted, found=found, mend=did_you_mean(found, names))
