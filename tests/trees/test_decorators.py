"""Decorators and timed leaves of bt_xml.md, sections 7 and 8, tick by tick. Notation: tests/trees/harness.py."""

from __future__ import annotations

from collections import deque

import pytest

from pluto_bt.trees import TickError
from tests.trees.harness import Bench

PLAIN = [
    # body                                                                    ticks
    ("<Inverter>a:RSF</Inverter>", "aR → R; aS → F; aF → S"),
    ("<Inverter>a:K</Inverter>", "aK → K"),
    ("<ForceSuccess>a:RFS</ForceSuccess>", "aR → R; aF → S; aS → S"),
    ("<ForceSuccess>a:K</ForceSuccess>", "aK → K"),
    ("<ForceFailure>a:RSF</ForceFailure>", "aR → R; aS → F; aF → F"),
    ("<ForceFailure>a:R</ForceFailure>", "aR → R; halt a!; aR → R"),
    ("<KeepRunningUntilFailure>a:SSF</KeepRunningUntilFailure>", "aS → R; aS → R; aF → F"),
    ("<KeepRunningUntilFailure>a:RK</KeepRunningUntilFailure>", "aR → R; aK → R"),
]

REPEATING = [
    ('<RetryUntilSuccessful num_attempts="3">a:FFS</RetryUntilSuccessful>', "aF aF aS → S"),
    ('<RetryUntilSuccessful num_attempts="3">a:FFS</RetryUntilSuccessful>', "= aF → R; = aF → R; = aS → S"),
    ('<RetryUntilSuccessful num_attempts="2">a:F</RetryUntilSuccessful>', "aF aF → F; aF aF → F"),
    ('<RetryUntilSuccessful num_attempts="2">a:F</RetryUntilSuccessful>', "= aF → R; = aF → F"),
    ('<RetryUntilSuccessful num_attempts="0">a:S</RetryUntilSuccessful>', "→ F"),
    ('<RetryUntilSuccessful num_attempts="-1">a:FFFFS</RetryUntilSuccessful>', "aF aF aF aF aS → S"),
    ('<RetryUntilSuccessful num_attempts="3">a:RFRFS</RetryUntilSuccessful>', "= aR → R; = aF aR → R; = aF aS → S"),
    ('<RetryUntilSuccessful num_attempts="2">a:K</RetryUntilSuccessful>', "aK → K"),
    ('<RetryUntilSuccessful num_attempts="2">a:FRF</RetryUntilSuccessful>', "aF aR → R; halt a!; aF aF → F"),
    ('<Repeat num_cycles="3">a:S</Repeat>', "aS aS aS → S; aS aS aS → S"),
    ('<Repeat num_cycles="3">a:S</Repeat>', "= aS → R; = aS → R; = aS → S"),
    ('<Repeat num_cycles="3">a:SF</Repeat>', "aS aF → F"),
    ('<Repeat num_cycles="0">a:S</Repeat>', "→ S"),
    ('<Repeat num_cycles="2">a:RS</Repeat>', "= aR → R; = aS aS → S"),
    ('<Repeat num_cycles="2">a:RSRS</Repeat>', "= aR → R; = aS aR → R; = aS → S"),
    ('<Repeat num_cycles="2">a:SKS</Repeat>', "= aS → R; = aK → K; = aS → S"),
    ('<Repeat num_cycles="-1">a:SSF</Repeat>', "aS aS aF → F"),
    ('<Repeat num_cycles="3">a:SRSS</Repeat>', "aS aR → R; halt a!; aS aS aS → S"),
]

TIMING = [
    ('<Sleep msec="100"/>', "→ R; +50; → R; +50; → S"),
    ('<Sleep msec="0"/>', "→ S"),
    ('<Sequence><Sleep msec="100"/>a:S</Sequence>', "→ R; +100; aS → S; → R"),
    ('<Sequence><Sleep msec="100"/>a:S</Sequence>', "→ R; +60; halt; → R; +60; → R; +40; aS → S"),
    ('<Delay delay_msec="100">a:S</Delay>', "→ R; +99; → R; +1; aS → S; → R"),
    ('<Delay delay_msec="100">a:R</Delay>', "→ R; +100; aR → R; halt a!; → R"),
    ('<Delay delay_msec="0">a:S</Delay>', "aS → S"),
    ('<Timeout msec="100">a:RS</Timeout>', "aR → R; +50; aS → S"),
    ('<Timeout msec="100">a:R</Timeout>', "aR → R; +99; aR → R; +1 a!; → F; aR → R"),
    ('<Timeout msec="0">a:R</Timeout>', "aR → R; +9999; aR → R"),
    ('<Timeout msec="100">a:RF</Timeout>', "aR → R; aF → F; +200; aF → F"),
    ('<Timeout msec="100">a:R</Timeout>', "aR → R; halt a!; +200; aR → R; +100 a!; → F"),
    ('<Timeout msec="100"><Sequence>a:S b:R</Sequence></Timeout>', "aS bR → R; +100 b!; → F"),
    ('<RunOnce>a:S</RunOnce>', "aS → S; → K; → K"),
    ('<RunOnce then_skip="false">a:F</RunOnce>', "aF → F; → F"),
    ('<RunOnce>a:RS</RunOnce>', "aR → R; aS → S; → K"),
    ('<RunOnce>a:RS</RunOnce>', "aR → R; halt a!; aS → S; → K"),
]

CONDITIONAL = [
    # the entry n, and its value in each tick, are those of the row
    ('<Precondition if="n==1" else="SKIPPED">a:S</Precondition>', 1, "aS → S"),
    ('<Precondition if="n==1" else="SKIPPED">a:S</Precondition>', 2, "→ K"),
    ('<Precondition if="n==1">a:S</Precondition>', 2, "→ F"),
    ('<Precondition if="n==1" else="RUNNING">a:S</Precondition>', 2, "→ R; → R"),
    ('<Sequence><Precondition if="n==1"><Sequence><Script code="n=5"/>a:RS</Sequence></Precondition></Sequence>', 1, "aR → R; aS → S; → F"),
    ('<Sequence _skipIf="n==1">a:S</Sequence>', 1, "→ K"),
    ('<Sequence _skipIf="n==1">a:S</Sequence>', 2, "aS → S"),
    ('<Sequence _failureIf="n==1" _successIf="true">a:S</Sequence>', 1, "→ F"),
    ('<Sequence _successIf="n==1" _skipIf="true">a:S</Sequence>', 1, "→ S"),
    ('<Sequence _while="n==1">a:S</Sequence>', 2, "→ K"),
    ('<Sequence>a:RS(_while="n==1")</Sequence>', 1, "aR → R; aS → S"),
    ('<Sequence><Sequence _while="n==1"><Script code="n=2"/>a:R</Sequence>b:S</Sequence>', 1, "aR → R; a! bS → S"),
    ('<Sequence>a:RS(_skipIf="n==2")<Script code="n=2"/>b:S(_skipIf="n==2")</Sequence>', 1, "aR → R; aS → S"),
    ('<Sequence>a:S(_onSuccess="n=7")b:S(_skipIf="n!=7")</Sequence>', 1, "aS bS → S"),
    ('<Fallback>a:F(_onFailure="n=7")b:S(_failureIf="n!=7")</Fallback>', 1, "aF bS → S"),
    ('<Sequence>a:S(_post="n+=1" _onSuccess="n*=10")<ScriptCondition code="n==11"/></Sequence>', 1, "aS → S"),
    ('<Sequence>a:K(_post="n=9")<ScriptCondition code="n==1"/></Sequence>', 1, "aK → S"),
    ('<Sequence>a:S(_successIf="true" _post="n=9")<ScriptCondition code="n==9"/></Sequence>', 1, "→ S"),
]


@pytest.mark.parametrize(("body", "ticks"), PLAIN + REPEATING + TIMING)
def test_decorator(body: str, ticks: str) -> None:
    assert Bench(body).run(ticks) == ticks


@pytest.mark.parametrize(("body", "n", "ticks"), CONDITIONAL)
def test_conditions(body: str, n: int, ticks: str) -> None:
    assert Bench(body, blackboard={"n": n}).run(ticks) == ticks


LOOPS = [
    ('<LoopInt queue="1;2;3" value="{v}"><Script code="sum += v"/></LoopInt>', "→ R; → R; → R; → S; → R", 7.0),
    ('<LoopInt queue="" value="{v}" if_empty="FAILURE">a:S</LoopInt>', "→ F", 0),
    ('<LoopDouble queue="1.5;2.5" value="{v}"><Script code="sum += v"/></LoopDouble>', "→ R; → R; → S", 4),
    ('<LoopString queue="a; b" value="{v}" if_empty="SKIPPED"><ScriptCondition code="v==\'a\' || v==\' b\'"/></LoopString>', "→ R; → R; → K", 0),
    ('<LoopBool queue="true;false" value="{v}"><ScriptCondition code="v"/></LoopBool>', "→ R; → F; → R", 0),
    ('<LoopInt queue="1;2" value="{v}">a:RSK</LoopInt>', "aR → R; aS → R; aK → R; → S", 0),
]


@pytest.mark.parametrize(("body", "ticks", "total"), LOOPS)
def test_loops_pop_one_element_per_run_of_the_child(body: str, ticks: str, total: float) -> None:
    bench = Bench(body, blackboard={"sum": 0.0})
    assert bench.run(ticks) == ticks
    assert bench.mission.blackboard["sum"] == total


def test_a_queue_on_the_blackboard_is_shared_and_emptied() -> None:
    queue = deque([1, 2, 3])
    bench = Bench('<LoopInt queue="{q}" value="{v}">a:SSF</LoopInt>', blackboard={"q": queue})
    assert bench.run("aS → R; aS → R; aF → F; → S") == "aS → R; aS → R; aF → F; → S"
    assert not queue


def test_a_list_on_the_blackboard_begins_anew_with_each_activation() -> None:
    bench = Bench('<LoopInt queue="{q}" value="{v}">a:S</LoopInt>', blackboard={"q": [4, 5]})
    assert bench.run("aS → R; aS → R; → S; aS → R") == "aS → R; aS → R; → S; aS → R"


UPDATES = [
    ('<SkipUnlessUpdated entry="{x}">a:S</SkipUnlessUpdated>', ["→ K", "aS → S", "→ K", "aS → S"]),
    ('<WaitValueUpdate entry="{x}">a:S</WaitValueUpdate>', ["→ R", "aS → S", "→ R", "aS → S"]),
    ('<SkipUnlessUpdated entry="x">a:RS</SkipUnlessUpdated>', ["→ K", "aR → R", "aS → S", "aS → S"]),
    ('<WasEntryUpdated entry="{x}"/>', ["→ F", "→ S", "→ F", "→ S"]),
]


@pytest.mark.parametrize(("body", "ticks"), UPDATES)
def test_a_write_counts_even_if_the_value_is_equal(body: str, ticks: list[str]) -> None:
    """Ticks: nothing written; written; not written; written again with the same value."""
    bench = Bench(body)
    seen = [bench.tick()]
    bench.mission.blackboard["x"] = 1
    seen += [bench.tick(), bench.tick()]
    bench.mission.blackboard["x"] = 1
    seen.append(bench.tick())
    assert seen == ticks


def test_the_child_of_an_update_watcher_is_left_as_it_ended() -> None:
    """Nobody makes it IDLE again: its pre-conditions are asked once, and a Sleep that has passed does not wait anew."""
    bench = Bench('<SkipUnlessUpdated entry="{x}">a:S(_skipIf="asked += 1; false")</SkipUnlessUpdated>', blackboard={"asked": 0, "x": 0})
    for _ in range(3):
        bench.mission.blackboard["x"] = 1
        assert bench.tick() == "aS → S"
    assert bench.mission.blackboard["asked"] == 1
    bench = Bench('<Sequence><WaitValueUpdate entry="{x}"><Sleep msec="100"/></WaitValueUpdate>a:S</Sequence>', blackboard={"x": 0})
    assert bench.run("→ R; +100; aS → S") == "→ R; +100; aS → S"
    bench.mission.blackboard["x"] = 1
    assert bench.tick() == "aS → S"


def test_an_update_watcher_that_is_interrupted_halts_its_child() -> None:
    bench = Bench('<ReactiveSequence><ScriptCondition code="go"/><SkipUnlessUpdated entry="{x}">a:R</SkipUnlessUpdated></ReactiveSequence>',
                  blackboard={"go": True, "x": 0})  # fmt: skip
    assert bench.tick() == "aR → R"
    bench.mission.blackboard["go"] = False
    assert bench.tick() == "a! → F"


def test_retry_reads_its_port_again_after_each_failure() -> None:
    body = '<RetryUntilSuccessful num_attempts="{n}"><Sequence><Script code="n = 2; tries += 1"/>a:F</Sequence></RetryUntilSuccessful>'
    bench = Bench(body, blackboard={"n": 5, "tries": 0})
    assert bench.tick() == "aF aF → F"
    assert bench.mission.blackboard["tries"] == 2


def test_on_halted_runs_for_an_interrupted_node_and_not_for_a_finished_one() -> None:
    bench = Bench('<ReactiveSequence><ScriptCondition code="go"/>a:R(_onHalted="halts += 1")</ReactiveSequence>', blackboard={"go": True, "halts": 0})
    assert bench.tick() == "aR → R"
    bench.mission.blackboard["go"] = False
    assert bench.tick() == "a! → F"
    assert bench.mission.blackboard["halts"] == 1
    assert bench.tick() == "→ F"
    assert bench.mission.blackboard["halts"] == 1


def test_while_that_turns_false_halts_with_its_script() -> None:
    bench = Bench('<Sequence>a:R(_while="go" _onHalted="halts += 1")b:S</Sequence>', blackboard={"go": True, "halts": 0})
    assert bench.tick() == "aR → R"
    bench.mission.blackboard["go"] = False
    assert bench.tick() == "a! bS → S"
    assert bench.mission.blackboard["halts"] == 1


RUNTIME_ERRORS = [
    ("<IfThenElse>a:K b:S</IfThenElse>", "the condition (first child) was skipped"),
    ("<WhileDoElse>a:K b:S</WhileDoElse>", "the condition (first child) was skipped"),
    ("<IfThenElse>a:S</IfThenElse>", "IfThenElse needs 2 or 3 children, it has 1"),
    ('<Parallel success_count="3">a:S b:S</Parallel>', "success_count 3 is more than the 2 children; it can never succeed"),
    ('<Parallel failure_count="3">a:S b:S</Parallel>', "failure_count 3 is more than the 2 children; it can never fail"),
    ('<ParallelAll max_failures="3">a:S b:S</ParallelAll>', "max_failures 3 is more than the 2 children; it can never fail"),
    ("<Switch2>a:S b:S</Switch2>", "Switch2 needs 3 children (one per case and a default), it has 2"),
    ("<Sleep/>", "port 'msec' is missing"),
    ("<Repeat>a:S</Repeat>", "port 'num_cycles' is missing"),
    ('<Precondition if="0" else="WRONG">a:S</Precondition>', "'WRONG' is no NodeStatus: expected one of IDLE, RUNNING, SUCCESS, FAILURE, SKIPPED"),
    ('<Repeat num_cycles="{n}">a:S</Repeat>', "entry 'n' has no value"),
    ('<Sequence _skipIf="nothing">a:S</Sequence>', "script _skipIf failed: unknown name 'nothing'"),
    ('<Script code="x = 1"/>', "script failed: entry 'x' does not exist; ':=' would create it"),
    ('<ScriptCondition code="5"/>', "script failed: the condition is number 5: expected true or false (0 or 1)"),
    ("<ScriptCondition code=\"'yes'\"/>", "script failed: the condition is text 'yes': expected true or false (0 or 1)"),
]


@pytest.mark.parametrize(("body", "reason"), RUNTIME_ERRORS)
def test_what_is_only_found_while_ticking(body: str, reason: str) -> None:
    bench = Bench(body)
    with pytest.raises(TickError) as caught:
        bench.mission.tick_once()
    assert caught.value.reason == reason
    assert caught.value.line == 1
    assert set(bench.mission.statuses().values()) <= {"IDLE", "RUNNING", "SUCCESS", "SKIPPED"}
