"""Parts of a tree that depend on their entries alone: left out while nothing is written, ticked whenever something is."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest
from py_trees.common import Status
from py_trees.ports import BehaviourWithPorts
from py_trees.visitors import SnapshotVisitor

from pluto_bt.behaviours.ports import Port
from pluto_bt.bench.row import best_us
from pluto_bt.runtime import VirtualClock
from pluto_bt.trees import Mission, load_mission

ANSWERS = {0: Status.SUCCESS, 1: Status.FAILURE, 2: Status.RUNNING, 3: Status.INVALID}
TICKED: list[str] = []


class Follows(BehaviourWithPorts, tag="SteadyFollows"):
    """Answers by its port alone."""

    PORTS_ALONE = True
    INPUT_PORTS: ClassVar = {"n": Port(int)}
    OUTPUT_PORTS: ClassVar[dict[str, Port]] = {}

    def update(self) -> Status:
        TICKED.append(self.name)
        self.feedback_message = f"n = {self.get_input('n')}"
        return ANSWERS[self.get_input("n") % 4]


class Always(Follows, tag="SteadyAlways"):
    """The same, but its own class does not say so: it is always ticked."""


def mission_of(body: str, kind: str = "SteadyFollows", clock: VirtualClock | None = None, **entries: int) -> Mission:
    leaves = body
    for name in "abcdefgh":
        leaves = leaves.replace(f"[{name}]", f'<{kind} name="{name}" n="{{{name}}}"/>')
    text = f'<root BTCPP_format="4"><BehaviorTree ID="T">{leaves}</BehaviorTree></root>'
    return load_mission(text, nodes=[Follows, Always], clock=clock or VirtualClock(), blackboard={"a": 0, "b": 0, "c": 0, "d": 0} | entries)


def ticked(mission: Mission) -> tuple[str, str]:
    TICKED.clear()
    return mission.tick_once(), "".join(TICKED)


def test_a_steady_part_is_ticked_once_and_again_after_a_write() -> None:
    mission = mission_of("<ReactiveSequence>[a][b][c]</ReactiveSequence>", c=2)
    assert [ticked(mission) for _ in range(3)] == [("RUNNING", "abc"), ("RUNNING", ""), ("RUNNING", "")]
    mission.blackboard["b"] = 0  # an equal value counts as written
    assert ticked(mission) == ("RUNNING", "abc")
    mission.blackboard["unread"] = 5  # makes an entry
    assert ticked(mission) == ("RUNNING", "abc")
    mission.blackboard["unread"] = 6
    assert ticked(mission) == ("RUNNING", "")
    mission.blackboard["c"] = 0
    assert [ticked(mission) for _ in range(2)] == [("SUCCESS", "abc"), ("SUCCESS", "")]
    assert mission.statuses() == dict.fromkeys("abc", "SUCCESS") | {"ReactiveSequence::1": "SUCCESS"}


@pytest.mark.parametrize(
    "body",
    [
        '<ReactiveSequence>[a]<SteadyFollows name="b" n="{b}" _onSuccess="c=1"/></ReactiveSequence>',  # a script
        '<ReactiveSequence>[a]<Sleep msec="500"/></ReactiveSequence>',  # a timer
        '<ReactiveSequence>[a]<SteadyAlways name="b" n="{b}"/></ReactiveSequence>',  # not declared
        '<SequenceWithMemory>[a][b]</SequenceWithMemory>',
        "[a]",
    ],
)
def test_everything_else_is_ticked_in_every_tick(body: str) -> None:
    mission = mission_of(body)
    for _ in range(3):
        assert ticked(mission)[1].startswith("a")


def test_a_halted_part_begins_anew() -> None:
    mission = mission_of("<ReactiveSequence>[a][b]</ReactiveSequence>", b=2)
    ticked(mission)
    mission.halt()
    assert ticked(mission) == ("RUNNING", "ab")


def test_a_sequence_that_ended_midway_asks_its_first_child_again() -> None:
    mission = mission_of("<Sequence>[a][b]</Sequence>", b=2)
    assert [ticked(mission) for _ in range(2)] == [("RUNNING", "ab"), ("RUNNING", "")]
    mission.blackboard["a"] = 1
    assert ticked(mission) == ("RUNNING", "b")
    assert [ticked(mission) for _ in range(2)] == [("RUNNING", "b"), ("RUNNING", "")], "once more, to see that nothing changes any more"
    mission.blackboard["b"] = 0
    assert [ticked(mission) for _ in range(3)] == [("SUCCESS", "b"), ("FAILURE", "a"), ("FAILURE", "")]


def test_who_looks_on_sees_every_node() -> None:
    mission = mission_of("<ReactiveSequence>[a][b]</ReactiveSequence>")
    visitor = SnapshotVisitor()
    for _ in range(2):
        visitor.initialise()
        for node in mission.root.tick():
            node.visit(visitor)
        assert len(visitor.visited) == 3


def test_a_leaf_that_is_made_to_fail_fails() -> None:
    mission = mission_of("<ReactiveSequence>[a][b]</ReactiveSequence>")
    ticked(mission)
    mission.replace_step("b", lambda: Status.FAILURE)
    assert ticked(mission) == ("FAILURE", "a")


KINDS = ("ReactiveSequence", "ReactiveFallback", "Sequence", "Fallback", "Inverter", "ForceSuccess", "ForceFailure")


def random_body(rng: np.random.Generator, depth: int) -> str:
    if depth == 0 or rng.random() < 0.2:
        return f"[{rng.choice(list('abcd'))}]"
    kind = str(rng.choice(KINDS))
    count = 1 if kind in KINDS[4:] else int(rng.integers(1, 4))
    return f"<{kind}>{''.join(random_body(rng, depth - 1) for _ in range(count))}</{kind}>"


@pytest.mark.parametrize("seed", range(80))
def test_nothing_differs_from_ticking_all(seed: int) -> None:
    """Two missions, one with leaves that are always ticked: the same answers and statuses whatever is written when."""
    rng = np.random.default_rng(seed)
    body = f"<ReactiveFallback>{random_body(rng, 3)}{random_body(rng, 3)}</ReactiveFallback>"
    steady, plain = mission_of(body), mission_of(body, "SteadyAlways")
    left_out = 0
    for _ in range(40):
        if rng.random() < 0.4:
            key, value = str(rng.choice(list("abcd"))), int(rng.integers(0, 4))
            steady.blackboard[key] = plain.blackboard[key] = value
        if rng.random() < 0.1:
            steady.halt()
            plain.halt()
        (one, ticks), (other, all_ticks) = ticked(steady), ticked(plain)
        left_out += len(all_ticks) - len(ticks)
        assert one == other
        assert steady.status_line() == plain.status_line() and list(steady.statuses().values()) == list(plain.statuses().values())
    assert left_out > 0


def test_a_tree_of_a_thousand_steady_leaves_costs_next_to_nothing_while_nothing_changes() -> None:
    mission = mission_of(f"<ReactiveSequence>{'<ReactiveSequence>[a][a][a][a][a][a][a][a][a]</ReactiveSequence>' * 111}</ReactiveSequence>")

    def changed() -> None:
        mission.blackboard["a"] = 0
        mission.tick_once()

    full_us, still_us = best_us(changed, 20), best_us(mission.tick_once, 200)
    assert still_us < 0.02 * full_us
