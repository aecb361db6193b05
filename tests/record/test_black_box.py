"""Black boxes of whole runs: everything that the tree saw and did is in them, at any tick, and can be executed again."""

from __future__ import annotations

import io
import json
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from pluto_bt.cli import main
from pluto_bt.playback import replay_file, story_of
from pluto_bt.record.box import Box, open_box
from pluto_bt.scenario import Play, Run
from pluto_bt.source import Faults

JOB = """<root BTCPP_format="4"><include path="parts/there.xml"/>
  <BehaviorTree ID="main"><Sequence>
    <Sleep msec="1230"/> <Script code="seen := @Localization_Pose_x; n := 0"/>
    <Repeat num_cycles="3"><Script code="n += 1"/></Repeat>
    <Fallback><Timeout msec="1500"><GoTo goal="9;9"/></Timeout><AlwaysSuccess name="enough"/></Fallback>
    <SubTree ID="There" x="8"/> <UnsetBlackboard key="seen"/>
  </Sequence></BehaviorTree></root>"""
THERE = """<root BTCPP_format="4"><BehaviorTree ID="There"><MoveTo name="go there" goal="6;3" timeout_s="60"/></BehaviorTree></root>"""


@pytest.fixture
def mission(tmp_path: Path) -> str:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "there.xml").write_text(THERE, encoding="utf-8")
    (tmp_path / "job.xml").write_text(JOB, encoding="utf-8")
    return str(tmp_path / "job.xml")


def opened(path: Path) -> Box:
    faults = Faults()
    box = open_box(path, str(path), faults)
    assert box is not None and not faults.has_errors
    return box


def recorded(scenario: Play, path: Path, mission: str, **how: object) -> Run:
    return scenario("yard.xml", mission=mission, seed=2, record=path, **how)  # type: ignore[arg-type]


def test_a_run_in_lockstep_is_told_tick_by_tick_and_runs_again_identically(scenario: Play, mission: str, tmp_path: Path) -> None:
    run = recorded(scenario, tmp_path / "a.mcap", mission)
    box = opened(tmp_path / "a.mcap")
    assert (run.result, box.result["result"], box.result["trace_sha256"]) == ("SUCCESS", "SUCCESS", run.trace_sha256)
    assert set(box.file.attachments) == {"mission/job.xml", "mission/parts/there.xml", "world/yard.xml", "platform.toml"}
    assert [tree.role for tree in box.trees.values()] == ["mission", "job"]
    now = box.now(box.number_at(2.0))
    assert now.trees[1].board == {"n": 3, "seen": pytest.approx(2.0, abs=0.05), "There::10/x": 8}
    assert {row.path: status for row, status, _, _ in now.trees[1].rows()}["GoTo::8"] == "RUNNING"
    assert box.now(len(box) - 1).trees[1].board == {"n": 3, "There::10/x": 8}, "what was unset is gone"
    assert replay_file(tmp_path / "a.mcap") == []


def test_recording_changes_nothing(scenario: Play, mission: str, tmp_path: Path) -> None:
    assert recorded(scenario, tmp_path / "a.mcap", mission).trace_sha256 == scenario("yard.xml", mission=mission, seed=2).trace_sha256


def test_going_back_gives_the_same_as_coming_from_before(scenario: Play, mission: str, tmp_path: Path) -> None:
    recorded(scenario, tmp_path / "a.mcap", mission)
    there, back = opened(tmp_path / "a.mcap"), opened(tmp_path / "a.mcap")
    forward = [there.now(number) for number in range(len(there))]
    for number in reversed(range(len(back))):
        assert back.now(number) == forward[number]


def test_a_run_in_threads_runs_again_identically(scenario: Play, mission: str, tmp_path: Path) -> None:
    """How often a thread ticks in these 2.5 s of wall time is the machine's affair (25 to 150 times); that no tick is missing is the box's."""
    run = recorded(scenario, tmp_path / "a.mcap", mission, realtime=True, speed=6.0, gateway="127.0.0.1:0", max_time_s=15.0)
    box = opened(tmp_path / "a.mcap")
    assert box.run.mode == "threads" and len(box) >= run.ticks > 10
    assert replay_file(tmp_path / "a.mcap") == []


FAULTS = ('device="leaf:AlwaysSuccess" kind="raise"', 'device="laser" kind="off" for="3"', 'device="module:avoid" kind="raise"')


@pytest.mark.parametrize("fault", FAULTS)
def test_what_goes_wrong_goes_wrong_again(scenario: Play, mission: str, tmp_path: Path, fault: str) -> None:
    world = tmp_path / "w.xml"
    script = f'<script><at t="2"><fault {fault}/></at></script>'
    world.write_text(f'<world name="w"><wall id="w">-3,-3 12,-3 12,9</wall>{script}</world>', encoding="utf-8")
    scenario(str(world), mission=mission, record=tmp_path / "a.mcap", max_time_s=40)
    assert replay_file(tmp_path / "a.mcap") == []


def test_another_mission_on_the_same_inputs_is_told_from_the_first_tick_that_differs(scenario: Play, tmp_path: Path) -> None:
    text = '<root BTCPP_format="4"><BehaviorTree ID="m"><Timeout msec="{}"><GoTo goal="8;3"/></Timeout></BehaviorTree></root>'
    (tmp_path / "a.xml").write_text(text.format(9000), encoding="utf-8")
    (tmp_path / "b.xml").write_text(text.format(3000), encoding="utf-8")
    scenario("yard.xml", mission=str(tmp_path / "a.xml"), record=tmp_path / "a.mcap")
    found = replay_file(tmp_path / "a.mcap", mission=tmp_path / "b.xml")
    assert str(found[0]) == "tick 31 (3.10 s): status of Timeout::1: recorded RUNNING, now IDLE" or found[0].t_s == pytest.approx(3.0, abs=0.11)


def test_every_sample_of_a_topic_that_a_leaf_reads_is_there_and_of_others_one_a_second(scenario: Play, mission: str, tmp_path: Path) -> None:
    run = recorded(scenario, tmp_path / "a.mcap", mission)
    samples = opened(tmp_path / "a.mcap").samples(["Localization/Pose", "sick/scan", "ATRV2/Sonar", "drive/command"])
    for name in ("Localization/Pose", "sick/scan", "drive/command"):  # moveto looks at scans
        seqs = [sample.seq for sample in samples[name] if sample.written_s > 2.8]  # from when moveto begins
        assert len(seqs) > 10
        assert all(after == before + 1 for before, after in pairwise(seqs)), name
    assert len(samples["ATRV2/Sonar"]) == pytest.approx(run.sim_time_s, abs=3.0)


def test_a_small_limit_keeps_the_newest_and_says_so(scenario: Play, mission: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recorded(scenario, tmp_path / "a.mcap", mission, settings=["record.limit_mb=1"])
    box = opened(tmp_path / "a.mcap")
    assert (tmp_path / "a.mcap").stat().st_size < 1.05 * (1 << 20) and box.now(len(box) - 1).trees[1].state == "succeeded"


def test_the_commands_tell_a_run(scenario: Play, mission: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "a.mcap"
    recorded(scenario, file, mission)
    assert main(["info", str(file), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert (facts["result"], facts["seed"], facts["mission"], facts["is_whole"]) == ("SUCCESS", 2, "mission/job.xml", True)
    assert main(["replay", str(file)]) == 0
    assert "go there: SUCCESS" in capsys.readouterr().out
    assert main(["replay", str(file), "--at", "2"]) == 0
    assert re.search("▶ GoTo  goal=9;9  .● RUNNING", capsys.readouterr().out)
    assert main(["replay", str(file), "--execute"]) == 0
    assert "all identical" in capsys.readouterr().out
    assert main(["replay", str(file), "--execute", "--mission", "t01_say_hello.xml"]) == 1, "a shipped mission by its name, as everywhere"
    assert "differs from " in capsys.readouterr().out
    assert main(["replay", str(file), "--mission", "t01_say_hello.xml"]) == 2
    assert "--mission goes with --execute or --contracts" in capsys.readouterr().err
    (tmp_path / "mine.xml").write_text("<root/>", encoding="utf-8")
    for command in ("repair", "totest", "plot"):
        assert main([command, str(file), "--output", str(tmp_path / "mine.xml")]) == 2, command
    assert (tmp_path / "mine.xml").read_text(encoding="utf-8") == "<root/>", "a slip of the hand must not cost a mission"
    file.write_bytes(file.read_bytes()[:-9000])
    assert main(["replay", str(file), "--execute"]) == 0
    assert "cut short" in capsys.readouterr().err
    assert main(["repair", str(file)]) == 0 and main(["info", str(file)]) == 0
    assert "cut short" not in capsys.readouterr().out
    file.write_bytes(file.read_bytes()[:50])
    assert main(["repair", str(file)]) == 1 and "left as it is" in capsys.readouterr().err
    assert len(file.read_bytes()) == 50


def test_a_file_that_is_no_black_box_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.mcap").write_text("hello", encoding="utf-8")
    for command in ("info", "replay", "repair", "totest"):
        assert main([command, str(tmp_path / "a.mcap")]) == 2
        assert "is no MCAP file" in capsys.readouterr().err
        assert main([command, str(tmp_path / "none.mcap")]) == 2
        assert "expected  a black box" in capsys.readouterr().err


def test_a_run_can_be_gone_through_by_hand_and_a_box_without_ticks_says_so(
    scenario: Play, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "m.xml").write_text('<root BTCPP_format="4"><BehaviorTree ID="m"><Sleep msec="900"/></BehaviorTree></root>', encoding="utf-8")
    scenario("yard.xml", mission=str(tmp_path / "m.xml"), record=tmp_path / "a.mcap")
    keys = ["n", "", "p", "+3", "-1", "at 0.5", "c", "at inf", "at nan", "at", "sideways", "q"]
    monkeypatch.setattr("sys.stdin", io.StringIO("\n".join(keys) + "\n"))
    assert main(["replay", str(tmp_path / "a.mcap"), "--step"]) == 0
    told = capsys.readouterr()
    shown = [int(number) for number in re.findall(r"^tick (\d+)", told.out, re.M)]
    assert shown[:6] == [1, 2, 3, 2, 5, 4] and len(shown) == len(keys)
    assert told.err.count("Enter or n = next") == 4, "two times that are none, and two lines that mean nothing"
    data = (tmp_path / "a.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(data[:2000])
    for words in (["replay"], ["replay", "--step"], ["replay", "--at", "1"], ["why"]):
        assert main([words[0], str(tmp_path / "cut.mcap"), *words[1:]]) == 1
        assert "no tick was recorded" in capsys.readouterr().err


def test_a_spoiled_black_box_is_refused_or_read_but_never_a_traceback(scenario: Play, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "m.xml").write_text('<root BTCPP_format="4"><BehaviorTree ID="m"><Sleep msec="900"/></BehaviorTree></root>', encoding="utf-8")
    scenario("yard.xml", mission=str(tmp_path / "m.xml"), record=tmp_path / "a.mcap")
    data = (tmp_path / "a.mcap").read_bytes()
    rng = np.random.default_rng(0)
    for _ in range(60):
        spoiled = bytearray(data)
        for at in rng.integers(8, len(data) if rng.random() < 0.5 else 3000, size=3):
            spoiled[at] ^= int(rng.integers(1, 256))
        (tmp_path / "b.mcap").write_bytes(spoiled)
        for words in (["info"], ["replay"], ["why"]):
            assert main([*words, str(tmp_path / "b.mcap")]) in (0, 1, 2)
    capsys.readouterr()


def test_a_run_becomes_a_test_that_passes_and_that_can_fail(scenario: Play, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "short.xml").write_text('<root BTCPP_format="4"><BehaviorTree ID="m"><GoTo goal="3;3.5"/></BehaviorTree></root>', encoding="utf-8")
    scenario("yard.xml", mission=str(tmp_path / "short.xml"), record=tmp_path / "short.mcap")
    to = tmp_path / "test_short.py"
    assert main(["totest", str(tmp_path / "short.mcap"), "--output", str(to)]) == 0
    to.write_text(edited := to.read_text(encoding="utf-8") + "# mine\n", encoding="utf-8")
    assert main(["totest", str(tmp_path / "short.mcap"), "--output", str(to)]) == 2 and to.read_text(encoding="utf-8") == edited
    assert "exists already; nothing was written" in capsys.readouterr().err
    made: dict[str, object] = {"__file__": str(to)}
    exec(compile(to.read_text(encoding="utf-8"), str(to), "exec"), made)
    made["test_short_decides_the_same_on_the_recorded_inputs"]()  # type: ignore[operator]
    again = made["test_short_goes_the_same_way_in_the_simulator"]
    again(Play(tmp_path), tmp_path)  # type: ignore[operator]
    assert story_of(tmp_path / "again.mcap") == [("GoTo::1", "SUCCESS")]
    mission = tmp_path / "test_short_files" / "mission" / "short.xml"
    mission.write_text(mission.read_text(encoding="utf-8").replace("3;3.5", "4;3.5"), encoding="utf-8")
    with pytest.raises(AssertionError):
        made["test_short_decides_the_same_on_the_recorded_inputs"]()  # type: ignore[operator]
