"""Contracts: what must hold while a mission runs; broken, the robot stops, or asks, or only tells; and over a recorded run a report."""

from __future__ import annotations

from pathlib import Path

import pytest

from pluto_bt.cli import main
from pluto_bt.runtime import VirtualClock
from pluto_bt.scenario import Play
from pluto_bt.source import Fault
from pluto_bt.trees import load_mission
from pluto_bt.trees.contracts import ContractWatch
from pluto_bt.trees.loader.contracts import contracts_in

EAST = """{}<BehaviorTree ID="m"><Sequence>
  <Script code="far := 0"/><GoTo goal="5;3.5"/><Script code="far := 1"/>
  <Script code="late := 1" _skipIf="far == 1"/></Sequence></BehaviorTree></root>"""
ROOT = '<root BTCPP_format="4">'
NEAR = '<Contract name="stays near" always="@Localization_Pose_x &lt; 4" {}/>'


def mission(folder: Path, contract: str) -> str:
    (folder / "m.xml").write_text(EAST.format(ROOT + contract), encoding="utf-8")
    return str(folder / "m.xml")


def test_a_broken_contract_stops_the_robot_and_ends_the_run(scenario: Play, tmp_path: Path) -> None:
    run = scenario("yard.xml", mission=mission(tmp_path, NEAR.format("")), platform="pioneer")
    assert (run.result, run.reason, run.exit_code) == ("STOPPED", "contract", 1)
    assert 'contract "stays near" is broken: @Localization_Pose_x < 4' in run.text
    assert 4.0 < run.final_pose[0] < 4.7, "at once, with its braking distance"
    assert run.contracts[0]["verdict"] == "broken" and len(run.contracts[0]["breaches"]) == 1


def test_a_contract_that_holds_is_told_as_kept(scenario: Play, tmp_path: Path) -> None:
    run = scenario("yard.xml", mission=mission(tmp_path, NEAR.format("").replace("4", "9")), platform="pioneer")
    assert run.result == "SUCCESS" and run.contracts[0]["verdict"] == "kept" and run.contracts[0]["judged"] > 50


def test_within_so_many_seconds_it_may_be_broken(scenario: Play, tmp_path: Path) -> None:
    at_once = scenario("yard.xml", mission=mission(tmp_path, NEAR.format('then="tell"')), platform="pioneer")
    assert at_once.result == "SUCCESS" and at_once.said("contract") and at_once.contracts[0]["breaches"][0]["until_s"] is None
    later = scenario("yard.xml", mission=mission(tmp_path, NEAR.format('within_s="1"')), platform="pioneer")
    breach = later.contracts[0]["breaches"][0]
    assert later.reason == "contract" and breach["broken_s"] - breach["since_s"] == pytest.approx(1.0, abs=0.11)
    never = scenario("yard.xml", mission=mission(tmp_path, NEAR.format('within_s="30"')), platform="pioneer")
    assert never.result == "SUCCESS" and never.contracts[0]["breaches"] == []


def test_asked_the_robot_waits_for_an_operator(scenario: Play, tmp_path: Path) -> None:
    run = scenario("yard.xml", mission=mission(tmp_path, NEAR.format('then="ask"')), platform="pioneer", max_time_s=20)
    assert (run.reason, run.runner.system.latch.held.word) == ("max-time", "operator-stop")
    assert 4.0 < run.final_pose[0] < 4.7 and 'contract "stays near"' in run.runner.system.latch.held.text


def test_asked_of_nobody_the_run_ends(scenario: Play, tmp_path: Path) -> None:
    run = scenario("yard.xml", mission=mission(tmp_path, NEAR.format('then="ask"')), platform="pioneer", max_time_s=None)
    assert (run.result, run.reason, run.exit_code) == ("STOPPED", "held", 1) and run.sim_time_s < 20.0
    assert run.text.startswith('broken contract "stays near" stopped the robot, and nobody is there') and "--gateway" in run.text
    assert 4.0 < run.final_pose[0] < 4.7


def test_it_is_judged_only_when_it_says_and_only_what_is_known(scenario: Play, tmp_path: Path) -> None:
    contract = '<Contract always="@Localization_Pose_x &lt; 4" when="far == 1" then="tell"/><Contract always="late == 1"/>'
    run = scenario("yard.xml", mission=mission(tmp_path, contract), platform="pioneer")
    first, second = run.contracts
    assert run.result == "SUCCESS" and first["breaches"][0]["since_s"] == pytest.approx(run.sim_time_s, abs=1.0)
    assert (second["verdict"], second["name"]) == ("not judged", "contract 2") and "late" in second["problem"]


def test_what_cannot_be_judged_is_broken(scenario: Play, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "a.mcap"
    run = scenario("yard.xml", mission=mission(tmp_path, "<Contract name='says' always=\"far == 'x'\"/>"), platform="pioneer", record=file)
    assert (run.result, run.reason, run.contracts[0]["verdict"]) == ("STOPPED", "contract", "broken") and run.sim_time_s < 2.0
    assert run.text == "contract \"says\" cannot be judged: script failed: text 'x' is no number" and run.contracts[0]["problem"] in run.text
    assert main(["replay", str(file), "--contracts"]) == 1
    assert "(cannot be judged: script failed: text 'x' is no number)" in capsys.readouterr().out


def test_over_a_recorded_run_with_its_own_contracts_or_with_others(scenario: Play, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "a.mcap"
    scenario("yard.xml", mission=mission(tmp_path, NEAR.format('then="tell"')), platform="pioneer", record=file)
    assert main(["replay", str(file), "--contracts"]) == 1
    told = capsys.readouterr().out
    assert told.startswith("broken     stays near: @Localization_Pose_x < 4\n           did not hold from ")
    (tmp_path / "rules.xml").write_text(f'{ROOT}<Contract name="far is a flag" always="far == 0 || far == 1"/></root>', encoding="utf-8")
    assert main(["replay", str(file), "--contracts", "--mission", str(tmp_path / "rules.xml")]) == 0
    assert capsys.readouterr().out == "kept       far is a flag: far == 0 || far == 1\n"


def test_the_live_watch_and_the_report_agree(scenario: Play, tmp_path: Path) -> None:
    from pluto_bt.contract_report import check_box
    from tests.stories.test_why import opened

    run = scenario("yard.xml", mission=mission(tmp_path, NEAR.format('then="tell" within_s="0.5"')), platform="pioneer", record=tmp_path / "a.mcap")
    kept = check_box(opened(tmp_path / "a.mcap"), contracts_in(tmp_path / "m.xml", "m.xml"))
    assert [one.as_json() for one in kept] == run.contracts


FAULTS = {
    "<Contract/>": ("does not say what must hold", 1),
    '<Contract always="a =="/>': ("script of always", 1),
    '<Contract always="a := 3"/>': ("only looks", 1),
    '<Contract always="(far = 3) > 2"/>': ("only looks", 1),
    '<Contract always="far" within_s="soon"/>': ("within_s takes seconds", 1),
    '<Contract always="far" then="halt"/>': ('cannot "halt"', 1),
    '<Contract alwys="a"/>': ('unknown attribute "alwys"', 2),
}


@pytest.mark.parametrize("text", FAULTS)
def test_a_faulty_contract_is_refused_with_its_place(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from pluto_bt.trees import check_mission

    words, count = FAULTS[text]
    faults: list[Fault] = [fault for fault in check_mission(EAST.format(ROOT + "\n  " + text)) if fault.severity == "error"]
    assert len(faults) == count and all(fault.line == 2 and fault.column >= 3 for fault in faults)
    assert any(words in fault.message for fault in faults)


@pytest.mark.parametrize("always", ["@Localization_Pose_q &lt; 3", "nobody_writes_this == 1"])
@pytest.mark.parametrize("attributes", ['always="{}"', 'always="1 == 1" when="{}"'])
def test_a_contract_that_could_never_be_judged_is_refused(always: str, attributes: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = mission(tmp_path, f"<Contract {attributes.format(always)}/>")
    assert main(["run", file]) == 2
    told = capsys.readouterr().err
    assert told.count("error: ") == 1 and f"m.xml:1:{(tmp_path / 'm.xml').read_text().index(always) + 1}: error: " in told


def test_other_tools_pass_over_it_and_an_included_file_may_hold_it(tmp_path: Path) -> None:
    (tmp_path / "rules.xml").write_text(f'{ROOT}<Contract always="n &lt; 3" within_s="0"/></root>', encoding="utf-8")
    text = f'{ROOT}<include path="rules.xml"/><BehaviorTree ID="m"><Repeat num_cycles="5"><Script code="n += 1"/></Repeat></BehaviorTree></root>'
    loaded = load_mission(text, clock=VirtualClock(), blackboard={"n": 0}, file=str(tmp_path / "m.xml"))
    watch = loaded.contract_watch()
    assert isinstance(watch, ContractWatch) and [one.contract.always for one in watch.kept] == ["n < 3"]
    broken = []
    for tick in range(5):
        loaded.tick_exactly_once()
        broken += [breach.broken_s for breach in watch.look(tick * 0.1)]
    assert broken == [pytest.approx(0.2)]
