"""What a mission remembers can be taken after any tick, kept as JSON, and given to the same mission loaded anew: it goes on as if all was well."""

from __future__ import annotations

import json
from typing import Any, ClassVar

import pytest
from py_trees.common import Status
from py_trees.ports import BehaviourWithPorts, PortInformation

from pluto_bt.behaviours.ports import Port
from pluto_bt.runtime import VirtualClock
from pluto_bt.trees import Mission, load_mission, memory
from pluto_bt.trees.journal import Journal, Line, Past, read_journal

TICK_S = 0.1


class Work(BehaviourWithPorts):
    """A step of so many ticks; it counts on the blackboard what it did, so that a repetition would show."""

    INPUT_PORTS: ClassVar = {"ticks": Port(int, False, "how many", 2), "ends": Port(str, False, "with what", "SUCCESS")}
    OUTPUT_PORTS: ClassVar[dict[str, PortInformation]] = {}

    def setup(self, **mission: Any) -> None:
        self._store = mission["blackboard"]

    def initialise(self) -> None:
        self._left = self.get_input("ticks")

    def update(self) -> Status:
        if self._left > 0:
            self._left -= 1
            return Status.RUNNING
        self._store["@done"] = self._store.get("@done", "") + self.name + " "
        return Status[self.get_input("ends")]


W = '<Work name="{}" ticks="{}"/>'.format
A, B, C, F = W("a", 1), W("b", 2), W("c", 1), '<Work name="f" ticks="1" ends="FAILURE"/>'
TREES = {
    "Sequence": f"<Sequence>{A}{B}{C}</Sequence>",
    "SequenceWithMemory": f'<ForceSuccess><RetryUntilSuccessful num_attempts="3"><SequenceWithMemory>{A}{F}</SequenceWithMemory>'
                          "</RetryUntilSuccessful></ForceSuccess>",
    "AsyncSequence": f"<AsyncSequence>{A}{B}<AlwaysSuccess/>{C}</AsyncSequence>",
    "ReactiveSequence": f"<ReactiveSequence><AlwaysSuccess/>{B}</ReactiveSequence>",
    "Fallback": f"<Fallback>{F}{F}{B}</Fallback>",
    "AsyncFallback": f"<AsyncFallback>{F}<AlwaysFailure/>{B}</AsyncFallback>",
    "ReactiveFallback": f"<ReactiveFallback><AlwaysFailure/>{B}</ReactiveFallback>",
    "Parallel": f'<Parallel success_count="3">{A}{W("d", 5)}{B}</Parallel>',
    "ParallelAll": f'<ParallelAll max_failures="3">{F}{W("d", 4)}{B}</ParallelAll>',
    "IfThenElse": f"<IfThenElse>{A}{B}{C}</IfThenElse>",
    "WhileDoElse": f"<WhileDoElse><AlwaysFailure/>{A}{B}</WhileDoElse>",
    "Switch2": f'<Sequence><Script code="v := 2"/><Switch2 variable="{{v}}" case_1="1" case_2="2">{A}{B}{C}</Switch2></Sequence>',
    "TryCatch": f"<Fallback><TryCatch>{A}{F}{B}</TryCatch>{C}</Fallback>",
    "Repeat": f'<Repeat num_cycles="3"><Sequence>{A}{B}</Sequence></Repeat>',
    "RetryUntilSuccessful": f'<ForceSuccess><RetryUntilSuccessful num_attempts="3">{F}</RetryUntilSuccessful></ForceSuccess>',
    "Inverter": f"<Inverter>{F}</Inverter>",
    "RunOnce": f'<Repeat num_cycles="3"><Sequence><RunOnce then_skip="false">{A}</RunOnce>{B}</Sequence></Repeat>',
    "LoopInt": f'<Sequence><LoopInt queue="3;5;7" value="{{i}}"><Sequence><Script code="last := i"/>{B}</Sequence></LoopInt>{A}</Sequence>',
    "Precondition": f'<Sequence><Script code="v := 1"/><Precondition if="v == 1">{B}</Precondition></Sequence>',
    "WaitValueUpdate": f'<Sequence><Script code="v := 1"/><WaitValueUpdate entry="{{v}}">{B}</WaitValueUpdate>{A}</Sequence>',
    "SkipUnlessUpdated": f'<Sequence><Script code="v := 1"/><Repeat num_cycles="2"><ForceSuccess><SkipUnlessUpdated entry="{{v}}">{B}'
                         f"</SkipUnlessUpdated></ForceSuccess></Repeat>{A}</Sequence>",
    "KeepRunningUntilFailure": f'<ForceSuccess><KeepRunningUntilFailure><Sequence><Script code="k := 1"/>{A}{F}</Sequence></KeepRunningUntilFailure>'
                               "</ForceSuccess>",
    "Delay": f'<Sequence><Delay delay_msec="0">{B}</Delay>{A}</Sequence>',
    "Timeout": f'<Sequence><Timeout msec="90000">{B}</Timeout>{A}</Sequence>',
    "SubTree": f'<Sequence>{A}<SubTree ID="sub" name="one" x="5"/><SubTree ID="sub" name="two" x="{{y}}"/></Sequence>',
    "RateController": f'<Sequence>{A}<RateController hz="2">{W("d", 4)}</RateController>{B}</Sequence>',
    "RoundRobin": f'<Repeat num_cycles="3"><ForceSuccess><RoundRobin>{A}{F}{B}</RoundRobin></ForceSuccess></Repeat>',
    "RecoveryNode": f'<ForceSuccess><RecoveryNode number_of_retries="2">{F}{A}</RecoveryNode></ForceSuccess>',
    "PersistentSequence": f'<Sequence><Script code="i := 0"/><PersistentSequence current_child_idx="{{i}}">{A}{B}</PersistentSequence></Sequence>',
    "SingleTrigger": f'<Repeat num_cycles="2"><Sequence><ForceSuccess><SingleTrigger>{A}</SingleTrigger></ForceSuccess>{B}</Sequence></Repeat>',
    "entries": f"<Sequence><Script code=\"n := 3; r := 1.5; t := 'x'\"/>{A}<UnsetBlackboard key=\"n\"/>{B}</Sequence>",
}  # fmt: skip
SUB = f'<BehaviorTree ID="sub"><Sequence><Script code="z := x"/>{B}</Sequence></BehaviorTree>'


def made(name: str) -> tuple[Mission, VirtualClock]:
    clock = VirtualClock()
    more = SUB if name == "SubTree" else ""
    text = f'<root BTCPP_format="4" main_tree_to_execute="m"><BehaviorTree ID="m">{TREES[name]}</BehaviorTree>{more}</root>'
    return load_mission(text, [Work], clock, blackboard={"y": 7}), clock


def on(mission: Mission, clock: VirtualClock, ticks: int) -> str:
    """Tick so often, or to the end; the last answer."""
    status = "RUNNING"
    while status == "RUNNING" and ticks:
        status, ticks = mission.tick_once(), ticks - 1
        clock.advance(TICK_S)
    return status


def outcome(mission: Mission, status: str) -> tuple[str, dict[str, Any]]:
    return status, dict(mission.blackboard.items())


@pytest.mark.parametrize("name", TREES)
def test_a_mission_goes_on_where_it_was_cut_off_whatever_the_tick(name: str) -> None:
    mission, clock = made(name)
    wanted = outcome(mission, on(mission, clock, 100))
    assert wanted[0] == "SUCCESS"
    length = mission.ticks
    for ticks in range(1, length):
        cut, clock = made(name)
        on(cut, clock, ticks)
        state = json.loads(json.dumps(memory.take(cut)))
        again, clock = made(name)
        assert memory.give_back(again, state) == []
        assert outcome(again, on(again, clock, 100)) == wanted, f"after tick {ticks}"


@pytest.mark.parametrize("name", TREES)
def test_changes_add_up_to_the_whole(name: str) -> None:
    mission, clock = made(name)
    state: memory.State = {"nodes": {}, "board": {}}
    while on(mission, clock, 1) == "RUNNING":
        now = memory.take(mission)
        state = memory.merged(state, json.loads(json.dumps(memory.changed(state, now))))
        assert state["nodes"] == now["nodes"]
        assert all(state["board"].get(number, {}) == entries for number, entries in now["board"].items())
        assert memory.changed(state, now) == {}


def test_values_come_back_as_what_they_were() -> None:
    from collections import deque

    for value in (True, 3, 2.5, "x", None, (1.0, 2.0), [1, "a"], deque([(1, 2)]), {1, 2}, [(1.0, 2.0), (3.0, 4.0)]):
        back = memory.from_json(json.loads(json.dumps(memory.to_json(value))))
        assert back == value and type(back) is type(value)


def test_a_journal_is_read_up_to_its_last_whole_line(tmp_path: Any) -> None:
    path = tmp_path / "j"
    journal = Journal(path, Past({"mission": "m"}))
    for tick in range(1, 4):
        change = {"nodes": {"0": ["R", {"index": tick}]}}
        journal.write(Line("step", 5, {}, tick, ((f"leaf {tick}", "SUCCESS"),), change, pose=(float(tick), 0.0, 0.0)), is_sure=True)
    journal.write(Line("act", keys=("say#1",)), is_sure=True)
    journal.close()
    whole = path.read_bytes()
    for cut in range(len(whole) + 1):
        path.write_bytes(whole[:cut])
        past = read_journal(path)
        lines = whole[:cut].count(b"\n")
        assert (past is None) == (lines == 0)
        if past is not None:
            assert (past.tick, len(past.finished), list(past.keys)) == (min(lines - 1, 3), min(lines - 1, 3), ["say#1"] if lines == 5 else [])
            assert past.has_begun == (lines > 1)


def test_a_long_journal_is_written_anew_and_says_the_same(tmp_path: Any) -> None:
    path = tmp_path / "j"
    journal = Journal(path, Past({"mission": "m"}))
    for tick in range(1, 3000):
        journal.write(Line("step", tick, {}, tick, (), {"nodes": {str(tick % 7): ["R", {"index": tick, "words": "x" * 400}]}}), is_sure=False)
    journal.close()
    past = read_journal(path)
    assert past is not None and past.tick == 2999 and len(past.state["nodes"]) == 7 and path.stat().st_size < 1_100_000


def test_a_journal_opened_again_keeps_the_keys_of_what_had_only_begun(tmp_path: Any) -> None:
    """Cut off before its first step was written, twice in a row."""
    path = tmp_path / "j"
    journal = Journal(path, Past({"mission": "m"}))
    journal.write(Line("act", keys=("say#1",)), is_sure=True)
    journal.close()
    for _ in range(2):
        past = read_journal(path)
        assert past is not None and past.has_begun and list(past.keys) == ["say#1"]
        Journal(path, past).close()


def test_a_key_is_forgotten_when_its_own_beginning_is_counted_and_not_before(tmp_path: Any) -> None:
    """Two side effects were cut off in one tick; the run that goes on comes to the second one some ticks later."""
    path = tmp_path / "j"
    journal = Journal(path, Past({"mission": "m"}))
    for key in ("first#1", "second#1"):
        journal.write(Line("act", keys=(key,)), is_sure=True)
    journal.write(Line("step", begun={"first": 1}, change={"nodes": {"0": ["R", {}]}}), is_sure=True)
    journal.close()
    past = read_journal(path)
    assert past is not None and list(past.keys) == ["second#1"]


def test_a_mission_that_ended_is_over_also_if_its_journal_was_written_anew_just_then(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "j"
    journal = Journal(path, Past({"mission": "m"}))
    journal.write(Line("step", tick=1, change={"nodes": {"0": ["R", {}]}}), is_sure=True)
    monkeypatch.setattr("pluto_bt.trees.journal.COMPACT_BYTES", 1)
    journal.write(Line("end"), is_sure=True)
    journal.close()
    past = read_journal(path)
    assert past is not None and not past.has_begun
