"""A tick of our engine against stock py_trees: reactive sequences of conditions that each read one changing blackboard value."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from py_trees.common import Status
from py_trees.ports import BehaviourWithPorts

from pluto_bt.behaviours.ports import Port
from pluto_bt.bench.baseline import load_baseline
from pluto_bt.bench.row import BenchRow, best_pair_us, best_us
from pluto_bt.trees import Mission, load_mission

COLUMNS = 9
ROWS = (1, 10, 111)  # about 10, 100 and 1000 nodes
TARGET = 20.0
STILL_TARGET = 1.0  # per cent
SUCCESS, FAILURE = Status.SUCCESS, Status.FAILURE  # as the baseline has them: looking a member up costs as much as a call


class Positive(BehaviourWithPorts, tag="BenchPositive"):
    """SUCCESS while its input is above 0."""

    INPUT_PORTS = {"x": Port(int)}  # noqa: RUF012  py_trees declares these two as instance attributes, which mypy keeps us from changing
    OUTPUT_PORTS = {}  # noqa: RUF012

    def update(self) -> Status:
        return SUCCESS if self.get_input("x") > 0 else FAILURE


class SteadyPositive(Positive, tag="BenchSteadyPositive"):
    """The same, and says so: it depends on its port alone."""

    PORTS_ALONE = True


def run() -> list[BenchRow]:
    """One row a tree size: our cost per visited node, and how many times cheaper that is. Then a tree whose inputs did not change."""
    baseline = load_baseline("tick_baseline")
    return [*(_row(rows, baseline) for rows in ROWS), _still_row()]


def _still_row() -> BenchRow:
    """A large tree of leaves that depend on their ports alone: a tick in which nothing was written, as a share of one in which something was."""
    mission = steady_mission(ROWS[-1])
    full_us, still_us = best_pair_us(_ours(mission), mission.tick_once)
    note = f"{still_us:.2f} against {full_us:.0f} µs a tick"
    return BenchRow("inputs unchanged, share of a full tick", 100.0 * still_us / full_us, "%", f"<= {STILL_TARGET:g}", note)


def wide_mission(rows: int) -> Mission:
    """The baseline's tree as a mission: `rows` sequences of nine conditions under one, all reactive (memory=False)."""
    return _mission(rows, "BenchPositive")


def steady_mission(rows: int) -> Mission:
    """The same of leaves that depend on their ports alone."""
    return _mission(rows, "BenchSteadyPositive")


def _mission(rows: int, leaf: str) -> Mission:
    leaves = "".join(f'<{leaf} name="leaf {j}" x="{{x}}"/>' for j in range(COLUMNS))
    body = "".join(f'<ReactiveSequence name="row {i}">{leaves}</ReactiveSequence>' for i in range(rows))
    text = f'<root BTCPP_format="4"><BehaviorTree ID="Wide"><ReactiveSequence>{body}</ReactiveSequence></BehaviorTree></root>'
    return load_mission(text, nodes=[Positive, SteadyPositive], blackboard={"x": 1})


def _row(rows: int, baseline: Any) -> BenchRow:
    visited = rows * (COLUMNS + 1) + 1
    ours = _ours(wide_mission(rows))
    if baseline is None:
        note = f"{best_us(ours) / visited:.2f} µs a node; no ratio: shared/bench/tick_baseline.py is not there (PLUTO_SHARED names its folder)"
        return BenchRow(f"stock py_trees / ours, {visited} nodes", math.nan, "×", f">= {TARGET:g}", note)
    pair = best_pair_us(ours, _stock(*baseline.stock_tree(rows, COLUMNS)), repeats=max(100, 20_000 // visited))
    ours_us, stock_us = (microseconds / visited for microseconds in pair)
    note = f"{stock_us:.2f} against {ours_us:.2f} µs a node"
    return BenchRow(f"stock py_trees / ours, {visited} nodes", stock_us / ours_us, "×", f">= {TARGET:g}", note)


def _ours(mission: Mission) -> Callable[[], object]:
    value = 1

    def tick() -> None:
        nonlocal value
        value += 1
        mission.blackboard["x"] = value
        assert mission.tick_once() == "SUCCESS"

    return tick


def _stock(tree: Any, writer: Any) -> Callable[[], object]:
    value = 1

    def tick() -> None:
        nonlocal value
        value += 1
        writer.x = value
        tree.tick()

    return tick
