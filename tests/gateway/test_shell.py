"""The shell as a person or a script uses it: one command, one line, one exit code."""

from __future__ import annotations

import io

import pytest

from pluto_bt.blackboard import messages as m
from pluto_bt.gateway import shell
from pluto_bt.gateway.port import RunState
from pluto_bt.gateway.shell import main

from .conftest import Running


def say(running: Running, *words: str) -> tuple[int, str]:
    """Exit code, and what was printed."""
    out = io.StringIO()
    return main([str(running.address), *words], out, out), out.getvalue()


def test_stop_pose_tree_and_status_print_one_answer(running: Running) -> None:
    running.robot.write("Localization/Pose", m.Pose(0.0, (1.0, -2.5, 0.0, 3.141592653589793 / 2, 0.0, 0.0)))
    running.robot.write("tree", m.TreeState(0.0, 1))
    running.robot.mission_now = m.MissionState(0.0, "patrol", 1, "paused", "stopped", "Patrol/GoTo")
    assert say(running, "stop") == (0, "stopped\n")
    code, line = say(running, "pose")
    assert code == 0 and line.startswith("x 1.000 m   y -2.500 m   theta 90.0°   (age ")
    assert say(running, "tree") == (0, "Sequence\n  GoTo <3;4>\n")
    assert say(running, "status") == (0, "mission patrol: paused (stopped) at Patrol/GoTo; nobody drives\n")


@pytest.mark.parametrize(
    ("end", "expected"),
    [(RunState("succeeded"), (0, "succeeded\n")), (RunState("failed", "stuck", "a wall is near"), (1, "failed: stuck: a wall is near\n"))],
)
def test_goto_takes_the_lease_drives_and_lets_go(running: Running, end: RunState, expected: tuple[int, str]) -> None:
    running.on_step = lambda: running.robot.runs.update(dict.fromkeys(running.robot.runs, end))
    assert say(running, "goto", "3", "-4.5") == expected
    assert running.robot.did == [("run", "GoTo", {"goal": "3;-4.5"}, 0.0)]
    assert "nobody drives" in say(running, "status")[1]


def test_goto_while_a_mission_runs_says_how_to_mend_it(running: Running) -> None:
    running.robot.mission_now = m.MissionState(0.0, "patrol", 1, "running")
    code, text = say(running, "goto", "3", "4")
    assert (code, text) == (1, 'pluto shell: wrong-state: a mission is running; pause it first: <mission op="pause"/>\n')


def test_ctrl_c_stops_the_robot(running: Running, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("pluto_bt.gateway.commands._follow", interrupted)
    assert say(running, "goto", "3", "4") == (130, "stopped\n")
    assert ("stop", "shell") in running.robot.did


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["goto", "3"], "expected 2 numbers, found 3; usage: goto X Y"),
        (["goto", "3", "north"], "expected numbers, found 3 north; usage: goto X Y"),
        (["maketurn", "nan"], "expected 1 numbers, found nan; usage: maketurn DEG"),
        (["stpo"], 'unknown command "stpo"; did you mean "stop"?'),
    ],
)
def test_what_is_not_understood_is_exit_2(running: Running, words: list[str], text: str) -> None:
    assert say(running, *words) == (2, f"pluto shell: {text}\n")


def test_why_tells_the_first_cause_and_the_way_up(running: Running) -> None:
    code, text = say(running, "why")
    assert (code, text.splitlines()) == (0, [
        "not moving", "  because sensor: bumper since 4.0 s: front panel pressed", "          what would help: back off",
        "  mission: paused since 1.0 s: mission patrol paused",
    ])  # fmt: skip


def test_a_script_talks_through_a_pipe(running: Running, monkeypatch: pytest.MonkeyPatch) -> None:
    out = io.StringIO()
    monkeypatch.setattr(shell.sys, "stdin", io.StringIO("help\nstop\n\nstpo\n"))
    assert main([str(running.address)], out, out) == 2
    assert "goto X Y" in out.getvalue() and "stopped\n" in out.getvalue()
