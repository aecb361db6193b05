"""`why` names the first cause. Each fault of a world script is a cause known by construction; so are an obstacle, a stop and an emergency stop."""

from __future__ import annotations

import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from pluto_bt.cli import main
from pluto_bt.gateway.why import lines
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.record.box import Box, open_box
from pluto_bt.runner import make_runner
from pluto_bt.runtime.latch import ESTOP
from pluto_bt.scenario import Play
from pluto_bt.source import Faults
from pluto_bt.system import System
from pluto_bt.trees import load_mission
from pluto_bt.trees.why import Cause
from pluto_bt.trees.why_box import why_at
from tests.stories.test_faults import GONE, ROWS, FaultRow, faulty, platform_for

SILENT = (*GONE, "frozen", "late")
FIRST: dict[tuple[str, str], tuple[str, str]] = {
    **{("laser", kind): ("sensor", "laser-stale") for kind in (*SILENT, "stuck", "nan")},
    ("laser", "fatal"): ("sensor", "laser-fatal"),
    **{("sonar", kind): ("sensor", "sonar-stale") for kind in (*SILENT, "nan")},
    **{("bumpers", kind): ("sensor", "bumper-stale") for kind in SILENT},
    **{("odometry", kind): ("sensor", "odometry-stale") for kind in (*SILENT, "nan")},
    **{("base", kind): ("sensor", "base-lost") for kind in SILENT},
    **{(device, "stuck"): ("sensor", "odometry-frozen") for device in ("base", "odometry")},
    ("base", "blocked"): ("sensor", "odometry-frozen"),
    ("module", "off"): ("module", "module-stopped"),
    ("module", "raise"): ("module", "module-error"),
    ("module", "hang"): ("module", "hung"),
    **{("leaf", kind): ("node", "leaf-error") for kind in ("raise", "wrong")},
    ("leaf", "hang"): ("node", "hung"),
}
SLOW = {("base", "stuck"): 26.0, ("odometry", "stuck"): 26.0}  # is noticed again and again, and named when the goto gives up
DECISIVE = [row for row in ROWS if (row.device, row.kind) in FIRST]


def opened(path: Path) -> Box:
    faults = Faults()
    box = open_box(path, str(path), faults)
    assert box is not None and not faults.has_errors
    return box


@pytest.mark.parametrize("number", range(len(DECISIVE)), ids=[f"{row.device}-{row.kind}" for row in DECISIVE])
def test_the_first_cause_of_a_fault_is_named(scenario: Play, tmp_path: Path, number: int) -> None:
    row: FaultRow = DECISIVE[number]
    until_s = SLOW.get((row.device, row.kind), 6.0)
    scenario(faulty(row, tmp_path), mission="patrol.xml", platform=platform_for(row, number), start="-4.5,0,0",
             ports={"goals": "4,0.5", "timeout_s": 30}, max_time_s=until_s, record=tmp_path / "a.mcap")  # fmt: skip
    box = opened(tmp_path / "a.mcap")
    first = why_at(box, None if row.device == "leaf" or row.kind in ("raise", "hang", "stuck") else 5.5).first
    assert first is not None and (first.layer, first.code) == FIRST[row.device, row.kind], first
    assert first.text and first.unblock and 3.8 <= first.since_s <= until_s, "it says since when, and what would help"


def test_before_the_fault_nothing_hinders_the_robot(scenario: Play, tmp_path: Path) -> None:
    scenario(faulty(DECISIVE[0], tmp_path), mission="patrol.xml", platform="pioneer", start="-4.5,0,0", ports={"goals": "4,0.5"}, max_time_s=6.0,
             record=tmp_path / "a.mcap")  # fmt: skip
    answer = why_at(opened(tmp_path / "a.mcap"), 3.5)
    assert answer.is_moving and [cause.layer for cause in answer.causes] == ["node", "mission"]
    chain = [cause.layer for cause in why_at(opened(tmp_path / "a.mcap"), 5.5).causes]
    assert chain[0] == "sensor" and chain[-4:] == ["avoidance", "motion", "node", "mission"], "from the sensor up to the mission"


WALLED = """<world name="hall" seed="1"><wall id="fence">-6,-2 6,-2 6,2 -6,2 -6,-2</wall> <wall id="across">1,-2 1,2</wall></world>"""


def acted(folder: Path, act: Callable[[System], None], at_s: float, until_s: float, leaf: str = '<GoTo goal="5;0"/>') -> list[Cause]:
    """A drive in a closed hall, something done to the robot at a time, and the answer at the end."""
    (folder / "w.xml").write_text(WALLED, encoding="utf-8")
    (folder / "m.xml").write_text(f'<root BTCPP_format="4"><BehaviorTree ID="m">{leaf}</BehaviorTree></root>', encoding="utf-8")
    inputs = read_inputs(Request(str(folder / "m.xml"), world=str(folder / "w.xml"), start="-5,0,0", platform="pioneer"))
    done: list[Any] = []

    def progress(system: System) -> None:
        if system.clock.now_s() >= at_s and not done:
            done.append(act(system))

    make_runner(inputs, max_time_s=until_s, on_progress=progress, record=folder / "a.mcap").run()
    return why_at(opened(folder / "a.mcap"), until_s - 0.2).causes


def test_a_short_quiet_run_ends_for_want_of_time_alone(tmp_path: Path) -> None:
    """Before the first scan avoidance complains of the laser; whoever asks three seconds later must not be sent to look at it."""
    acted(tmp_path, lambda system: None, 9.0, 3.0)
    answer = why_at(opened(tmp_path / "a.mcap"))
    assert answer.first is not None and (answer.first.layer, answer.first.code) == ("run", "max-time"), answer


def test_a_broken_contract_is_why_the_run_has_ended(scenario: Play, tmp_path: Path) -> None:
    """Whatever else there was to complain of: here the laser, slowing the robot before a wall."""
    (tmp_path / "w.xml").write_text(WALLED, encoding="utf-8")
    rule, leaf = '<Contract name="this side" always="@Localization_Pose_x < 0"/>', '<HoldHeading heading_deg="0" speed_mps="0.9" duration_s="60"/>'
    (tmp_path / "m.xml").write_text(f'<root BTCPP_format="4">{rule}<BehaviorTree ID="m">{leaf}</BehaviorTree></root>', encoding="utf-8")
    run = scenario(tmp_path / "w.xml", mission=tmp_path / "m.xml", start="-5,0,0", platform="pioneer", record=tmp_path / "a.mcap")
    causes = why_at(opened(tmp_path / "a.mcap")).causes
    assert run.reason == "contract" and (causes[0].layer, causes[0].code) == ("run", "contract"), causes
    assert "this side" in causes[0].text and causes[0].unblock


def test_a_stop_and_an_emergency_stop_are_an_operators(tmp_path: Path) -> None:
    causes = acted(tmp_path, lambda system: system.operator_stop("anna"), 3.0, 6.0)
    assert (causes[0].layer, causes[0].code, causes[0].since_s) == ("operator", "operator-stop", pytest.approx(3.0, abs=0.2))
    assert "anna" in causes[0].text and "resume" in causes[0].unblock
    causes = acted(tmp_path, lambda system: system.latch.set(ESTOP, "the red button"), 3.0, 6.0)
    assert (causes[0].layer, causes[0].code, causes[0].text) == ("operator", "estop", "the red button")


def test_a_wall_across_the_way_is_seen_by_the_laser(tmp_path: Path) -> None:
    causes = acted(tmp_path, lambda system: None, 3.0, 20.0, leaf='<HoldHeading heading_deg="0" speed_mps="0.5" duration_s="60"/>')
    assert causes[0].layer == "sensor" and causes[0].code in ("laser", "sonar"), causes
    assert causes[-1].layer == "mission" and causes[-2].layer == "node"
    told = "\n".join(lines(False, [cause._asdict() for cause in causes]))
    sentence = causes[0].text.partition(": ")[2]
    assert told.count(sentence) == 1 and told.endswith("mission m running") and ": the same\n" in told, "what one link hands to the next is told once"


WAITING = {
    "Delay": '<Delay name="pause" delay_msec="60000"><Say text="x"/></Delay>',
    "WaitValueUpdate": '<Sequence><Script code="k := 1"/> <Repeat num_cycles="2"><WaitValueUpdate entry="{k}">'
    '<Say text="x"/></WaitValueUpdate></Repeat></Sequence>',
    "Precondition": '<Sequence><Script code="k := 1"/><Precondition if="k == 2" else="RUNNING"><Say text="x"/></Precondition></Sequence>',
}


@pytest.mark.parametrize("kind", WAITING)
def test_a_decorator_that_waits_itself_is_named_with_what_would_end_it(tmp_path: Path, kind: str) -> None:
    causes = acted(tmp_path, lambda system: None, 9.0, 2.0, leaf=WAITING[kind])
    assert [cause.layer for cause in causes] == ["node", "mission"] and causes[0].code == "running"
    assert f"({kind}): waits " in causes[0].text and causes[0].unblock


def test_an_operator_who_ends_a_paused_mission_is_named_also_after_an_errand(tmp_path: Path) -> None:
    def act(system: System) -> None:
        system.operator_stop("anna")
        system.latch.release("operator-stop")  # as the command for an errand does
        system.executive.core.start_errand(load_mission('<root BTCPP_format="4"><BehaviorTree ID="e"><Say text="hi"/></BehaviorTree></root>'))
        system.executive.core.abort("stopped")

    acted(tmp_path, act, 3.0, 6.0)
    first = why_at(opened(tmp_path / "a.mcap")).first
    assert first is not None and (first.layer, first.text) == ("operator", "an operator ended the mission")


def test_past_its_end_a_run_that_succeeded_is_told_as_at_its_end(tmp_path: Path) -> None:
    acted(tmp_path, lambda system: None, 99.0, 60.0, leaf='<GoTo goal="-3;0"/>')
    box = opened(tmp_path / "a.mcap")
    assert why_at(box, 9999.0) == why_at(box) and [(cause.layer, cause.code) for cause in why_at(box).causes] == [("mission", "succeeded")]


def test_the_command_tells_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    acted(tmp_path, lambda system: system.operator_stop("anna"), 3.0, 6.0)
    assert main(["why", str(tmp_path / "a.mcap"), "--at", "5"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0] == "not moving" and told[1].startswith("  because operator: operator-stop since 3.")
    assert told[2].startswith("          what would help: resume")
    assert main(["why", str(tmp_path / "a.mcap"), "--at", "2", "--json"]) == 0
    assert '"moving": true' in capsys.readouterr().out
    assert main(["why", str(tmp_path / "a.mcap"), "--at", "soon"]) == 2
    capsys.readouterr()
    assert main(["why", str(tmp_path / "a.mcap"), "--at", "300"]) == main(["why", str(tmp_path / "a.mcap")]) == 0
    assert capsys.readouterr().out.count("not moving when the run ended, at ") == 2


def test_where_nobody_listens_it_says_what_would_help_and_what_a_robot_may_still_be_doing(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as held:  # bound and not listening: nobody else can take the port meanwhile
        held.bind(("127.0.0.1", 0))
        assert main(["why", "--gateway", f"127.0.0.1:{held.getsockname()[1]}"]) == 1
    told = capsys.readouterr().err
    assert "no gateway at 127.0.0.1" in told and "--realtime" in told and "compiling kernels" in told
