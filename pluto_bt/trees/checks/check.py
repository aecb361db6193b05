"""`check_mission`: every fault of a mission, without making a node of it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pluto_bt.runtime.clock import MissionClock
from pluto_bt.source import Fault
from pluto_bt.trees.checks.driving import check_driving
from pluto_bt.trees.checks.flow import Flow
from pluto_bt.trees.checks.outcomes import Ends, outcome
from pluto_bt.trees.checks.reach import check_reach
from pluto_bt.trees.checks.robot_words import check_words
from pluto_bt.trees.checks.unused import check_unused
from pluto_bt.trees.errors import MissionError
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.load import Reading, build, no_collecting, read_mission
from pluto_bt.trees.mission import Mission
from pluto_bt.trees.scopes import Topics


@dataclass(frozen=True)
class Examined:
    """What a check found.

    Attributes:
        plan: the unfolded main tree; None if there is none.
    """

    faults: tuple[Fault, ...]
    plan: Plan | None


def check_mission(text_or_path: str | Path, nodes: Iterable[Any] = (), **options: Any) -> tuple[Fault, ...]:
    """All faults of a mission, in the order of the text; the options are those of `examine_mission`."""
    return examine_mission(text_or_path, nodes, **options).faults


def examine_mission(
    text_or_path: str | Path,
    nodes: Iterable[Any] = (),
    *,
    tree: str | None = None,
    ports: Mapping[str, str] | None = None,
    topics: Topics | None = None,
    file: str | None = None,
    plugins: Sequence[str] = (),
    models: Sequence[str | Path] = (),
    whole: bool = True,
) -> Examined:
    """All faults of a mission: also those that BehaviorTree.CPP finds only while ticking, and as warnings those it silently accepts.

    Makes no node. `models` are files whose TreeNodesModel describes foreign nodes; without `whole` it is not asked whether the nodes work
    together (entries, reach, driving), only whether each is right. The other arguments are those of `load_mission`.
    """
    with no_collecting():
        reading = read_mission(text_or_path, nodes, None, tree=tree, ports=ports, topics=topics, file=file, plugins=plugins, models=models)
        if whole and reading.plan is not None and reading.main is not None and not reading.report.faults.is_full:
            _check_whole(reading, reading.plan)
        check_unused(reading.unused, reading.files, reading.types, reading.report)
        return Examined(reading.report.faults.in_order(), reading.plan)


def load_checked(
    text_or_path: str | Path, ports: Mapping[str, str], nodes: Iterable[Any] = (), clock: MissionClock | None = None, *, topics: Topics | None = None
) -> Mission:
    """`load_mission` of what `check_mission` takes, with these inputs, in one reading. Raises: MissionError with all errors."""
    with no_collecting():
        reading = read_mission(text_or_path, nodes, None, tree=None, ports=ports, topics=topics, file=None, plugins=())
        faults = reading.report.faults
        if reading.plan is not None and reading.main is not None and not faults.is_full:
            _check_whole(reading, reading.plan)
        if faults.has_errors:
            raise MissionError(tuple(fault for fault in faults.in_order() if fault.severity == "error"))
        return build(reading, clock)


def _check_whole(reading: Reading, root: Plan) -> None:
    nodes, report = root.walk(), reading.report
    ends: dict[int, Ends] = {}
    unreached: dict[int, dict[int, str]] = {}
    for plan in reversed(nodes):
        ends[id(plan)], unreached[id(plan)] = outcome(plan, [ends[id(child)] for child in plan.children])
    check_reach(root, unreached, report)
    check_driving(nodes, report)
    check_words(nodes, report)
    model = reading.files.subtree_models.get(reading.main.tree_id) if reading.main is not None else None
    inputs = {name: port for name, port in model.ports.items() if port.direction != "out"} if model is not None else {}
    flow = Flow(reading.board, inputs, ends, report)
    flow.run(nodes)
    looks = [element.attributes[name] for element in reading.files.contracts for name in ("when", "always") if element.get(name)]
    flow.run_beside(looks)
