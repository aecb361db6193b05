"""What a stranger does first: `pluto` alone, the things that it suggests, a mission of his own, the help of each command."""

from __future__ import annotations

import json
import shlex
from collections import deque
from pathlib import Path

import pytest

from pluto_bt.cli import COMMANDS, FIRST_STEPS, main
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.result import RunResult
from pluto_bt.runtime.parameters import describe, unit_of

SUGGESTED = [line.strip().partition("   ")[0] for line in FIRST_STEPS.splitlines() if line.startswith("  pluto")]


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_pluto_alone_prints_three_things_to_try(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert capsys.readouterr().out.count("\n  pluto ") == len(SUGGESTED) == 3


@pytest.mark.parametrize("line", SUGGESTED)
def test_each_of_them_works(line: str) -> None:
    assert main(shlex.split(line)[1:]) == 0


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    try:
        code = main([name, "--help"])
    except SystemExit as end:  # argparse's way
        code = int(end.code or 0)
    assert code == 0
    assert capsys.readouterr().out.startswith(f"usage: pluto {name}")


def test_a_new_mission_runs_as_it_is_and_with_another_place(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "mission", "errand"]) == 0
    assert main(["check", "errand.xml"]) == 0
    assert main(["run", "errand.xml"]) == 0
    assert main(["run", "errand.xml", "--port", "place=4;1"]) == 0
    assert main(["new", "mission", "errand"]) == 2, "never over an existing file"
    assert main(["check", "errand.xml", "--port", "place=door"]) == 2
    assert 'input "place" is declared as point; "door" is none' in capsys.readouterr().out


UNUSABLE = ["mission GoTo", "leaf GoTo", "leaf go_to", "mission Sequence", "leaf Say", "mission root", "mission nowhere/errand"]


@pytest.mark.parametrize("words", UNUSABLE)
def test_a_new_file_that_could_not_be_used_is_not_written(words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", *words.split()]) == 2
    assert "nothing was written" in capsys.readouterr().err and list(Path().iterdir()) == []


@pytest.mark.parametrize(("words", "written"), [("mission ../a/errand", "errand.xml"), ("leaf ../a/BatteryLow", "battery_low.py")])
def test_a_new_file_is_written_where_its_name_says(words: str, written: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    monkeypatch.chdir(tmp_path / "b")
    assert main(["new", *words.split()]) == 0
    assert (tmp_path / "a" / written).is_file() and list(Path().iterdir()) == []


def test_a_patrol_of_two_rounds_counts_its_goals_and_keeps_its_inputs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "patrol.xml", "--port", "goals=4,3.5;2,3.5", "--port", "rounds=2", "--json"]) == 0
    board = json.loads(capsys.readouterr().out.splitlines()[-1])["blackboard"]
    assert (board["reached"], board["recoveries"], board["goals"]) == (4, 0, "4,3.5;2,3.5")


def test_a_queue_stands_as_a_list_in_the_result() -> None:
    assert json.loads(RunResult(result="SUCCESS", blackboard={"tour": deque(["1,2"])}).as_json())["blackboard"]["tour"] == ["1,2"]


@pytest.mark.parametrize(
    ("result", "reason", "code"),
    [("SUCCESS", "", 0), ("FAILURE", "hung", 1), ("FAILURE", "interrupted", 1), ("STOPPED", "max-time", 1), ("REFUSED", "bad-input", 2),
     ("STOPPED", "leaf-error", 3), ("STOPPED", "module-error", 3), ("STOPPED", "hung", 3), ("STOPPED", "base-lost", 3),
     ("STOPPED", "interrupted", 130)],
)  # fmt: skip
def test_the_exit_code_tells_how_a_run_ended(result: str, reason: str, code: int) -> None:
    assert RunResult(result=result, reason=reason).exit_code == code


@pytest.mark.parametrize(
    ("name", "unit"),
    [("max_speed_mps", "m/s"), ("drift_dps_per_sqrt_s", "°/s/√s"), ("distance_noise_m_per_sqrt_m", "m/√m"), ("counts_per_m", "counts/m"),
     ("rate_percent_per_s", "%/s"), ("beams", "")],
)  # fmt: skip
def test_the_name_of_a_parameter_says_its_unit(name: str, unit: str) -> None:
    assert unit_of(name) == unit


def test_every_parameter_of_a_robot_file_says_what_it_is() -> None:
    rows = describe(RobotFile)
    assert [row.name for row in rows if not row.doc] == []
    assert [row.kind for row in rows if "tuple" in row.kind or "pluto_bt" in row.kind] == [], "types stand in words"
