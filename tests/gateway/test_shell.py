"""The shell as a person or a script uses it: one command, one line, one exit code."""

from __future__ import annotations

import io
import itertools
import json
import math
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from pluto_bt.behaviours.catalogue import LEAVES
from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.port import RunState
from pluto_bt.gateway.shell.main import main
from pluto_bt.gateway.shell.table import ROWS, SUBSHELLS, help_text
from pluto_bt.gateway.shell.telling import as_json, brief
from pluto_bt.gateway.words import said_by

from .conftest import Running

RUNS = itertools.count(1, 2)  # the gateway of all these tests has seen the missions of each
PORTS = {leaf.__name__: set(leaf.INPUT_PORTS) for leaf in LEAVES}


@pytest.fixture
def running(lasting: Running) -> Running:
    lasting.renew()
    return lasting


def say(running: Running, *words: str) -> tuple[int, str]:
    """Exit code, and what was printed."""
    out = io.StringIO()
    return main([str(running.address), *words], out, out), out.getvalue()


def runs_end(running: Running, end: RunState) -> list[tuple[str, dict[str, str]]]:
    """Every node may be run and ends at once; what was run."""
    ran: list[tuple[str, dict[str, str]]] = []

    def run_node(node: str, ports: Mapping[str, str], deadline_s: float, source: str) -> str:
        ran.append((node, dict(ports)))
        running.robot.runs["r1"] = end
        return "r1"

    running.robot.run_node = run_node  # type: ignore[method-assign]
    return ran


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
    ("line", "node", "ports"),
    [
        ("goto 3 -4.5", "GoTo", {"goal": "3;-4.5"}),
        ("goto 234567.25 0", "GoTo", {"goal": "234567.25;0"}),
        ("maketurn -90", "MakeTurn", {"angle_deg": "-90"}),
        ("navigate dock", "NavigateTo", {"goal": "dock"}),
        ("navigate 1,2,90", "NavigateTo", {"goal": "1;2;90"}),
        ("do GoTo goal=1;2 tolerance_m=0.5", "GoTo", {"goal": "1;2", "tolerance_m": "0.5"}),
        ("moveto 1 2", "MoveTo", {"goal": "1;2"}),
        ("explore 5 10", "Explore", {"rectangle": "5;10"}),
        ("investigate", "Investigate", {}),
        ("investigate 3", "Investigate", {"radius_m": "3"}),
        ("wallfollow", "WallFollow", {"side": "left"}),
        ("wallfollow right 0.8", "WallFollow", {"side": "right", "distance_m": "0.8"}),
        ("follow nearest 2", "Follow", {"target": "nearest", "distance_m": "2"}),
        ("setpose 1 2 90", "SetPose", {"pose": "1;2;90"}),
        ("wrist point 30 -10", "PointWrist", {"pan_deg": "30", "tilt_deg": "-10"}),
        ("wrist sweep 40 10 2", "SweepWrist", {"pan_deg": "40", "tilt_deg": "10", "rounds": "2"}),
        ("wrist home", "PointWrist", {}),
        ("arm fold", "UnfoldArm", {"folded": "true"}),
        ("motion rectangle 5 10", "SetRectangle", {"rectangle": "5;10", "home": "0;0;0"}),
        ("motion resume", "Resume", {}),
    ],
)
def test_a_driving_command_runs_one_node_of_the_library(running: Running, line: str, node: str, ports: dict[str, str]) -> None:
    ran = runs_end(running, RunState("succeeded"))
    assert say(running, *line.split()) == (0, "succeeded\n")
    assert ran == [(node, ports)]
    assert set(ports) <= PORTS[node], "the library's node has these ports"
    assert "nobody drives" in say(running, "status")[1]


def test_a_failed_run_tells_reason_and_outputs(running: Running) -> None:
    runs_end(running, RunState("failed", "stuck", "a wall is near", (("reason", "stuck"), ("path", "1,2;3,4"))))
    assert say(running, "goto", "3", "4") == (1, "failed: stuck: a wall is near\n  path = 1,2;3,4\n")


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        (MapPath.along(np.column_stack((np.linspace(1.0, 8.0, 141), np.full(141, 2.0)))).to_text(), "1,2;1.05,2;…;8,2 (141 points)"),
        (";".join(f"{i},{2 * i}" for i in range(99)), "0,0;1,2;…;98,196 (99 points)"),
        ("a word;" * 40, f"{('a word;' * 40)[:160]}… (280 characters)"),
        ("1;map" + ";1;map;where;2;0;0;0;0;1" * 20, f"1;map{';1;map;where;2;0;0;0;0;1' * 6}{';1;map;where'[:11]}… (485 characters)"),
        (f"{'1' * 200},2", f"{'1' * 160}… (202 characters)"),
        ("1,2;3,4;5,6", "1,2;3,4;5,6"),
        ("", ""),
    ],
)
def test_a_long_output_is_shortened_for_a_person(text: str, shown: str) -> None:
    assert brief(text) == shown


def test_goto_while_a_mission_runs_says_how_to_mend_it(running: Running) -> None:
    running.robot.mission_now = m.MissionState(0.0, "patrol", 1, "running")
    assert say(running, "goto", "3", "4") == (1, "pluto shell: wrong-state: a mission is running; pause it first: `pause`\n")
    assert not [did for did in running.robot.did if did[0] in ("stop", "run")]


def test_who_is_refused_the_lease_is_told_and_stops_nobody(running: Running) -> None:
    with running.client(name="other") as other:
        other.lease("acquire", ttl_s=30.0)
        code, text = say(running, "goto", "3", "4")
        assert code == 1 and text.startswith("pluto shell: lease-held: the lease is held by other")
        assert not running.robot.did


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("goto 3", "goto: expected X Y, found 3; usage: goto X Y"),
        ("goto 3 4 5", "goto: expected X Y, found 3 4 5; usage: goto X Y"),
        ("goto 3 north", 'goto: Y: expected a number in m, at least -1e+06, at most 1e+06, found "north"; usage: goto X Y'),
        ("goto 3 1e400", 'goto: Y: expected a number in m, at least -1e+06, at most 1e+06, found "1e400"; usage: goto X Y'),
        ("goto 1_0 2", 'goto: X: expected a number in m, at least -1e+06, at most 1e+06, found "1_0"; usage: goto X Y'),
        ("maketurn nan", 'maketurn: DEG: expected a number in °, at least -3600, at most 3600, found "nan"; usage: maketurn DEG'),
        ("explore -1 2", 'explore: B: expected a number in m, at least 0, found "-1"; usage: explore B H'),
        ("wallfollow lft 1", 'wallfollow: SIDE: expected one of left, right, found "lft"; did you mean "left"?; '
                             "usage: wallfollow [left|right] [DISTANCE]"),
        ("pose now", "pose: expected nothing, found now; usage: pose"),
        ("stpo", 'unknown command "stpo"; did you mean "stop"?'),
        ("wrist pont 1 2", 'unknown command "pont"; did you mean "point"?'),
        ("drive", "drive: this command needs a keyboard: say it inside `pluto shell`, at a terminal; usage: drive [MPS]"),
        ("do GoTo goal", "do: expected inputs as NAME=VALUE, each once, found goal; usage: do NODE [NAME=VALUE …]"),
        ("run patrol.xml goals", "run: expected inputs as NAME=VALUE, each once, found goals; usage: run MISSION [NAME=VALUE …]"),
    ],
)
def test_what_is_not_understood_is_exit_2(running: Running, line: str, text: str) -> None:
    assert say(running, *line.split()) == (2, f"pluto shell: {text}\n")


def test_the_events_of_a_source_do_not_begin_with_it_twice_and_commands_are_offered_once(running: Running) -> None:
    assert said_by("anna", "anna stopped the robot") == "anna stopped the robot"
    assert said_by("base", "the wheels stop") == "base: the wheels stop"
    offered = say(running, "qqqqqq")[1].partition("one of: ")[2].strip().split(", ")
    assert len(offered) == len(set(offered)) > 20


@pytest.mark.parametrize(("result", "line"), [
    (RunState("preempted", "preempted", "anna began another run"), "preempted: anna began another run\n"),
    (RunState("failed", "stuck", "GoTo::1 (GoTo) failed: stuck: no way"), "failed: GoTo::1 (GoTo) failed: stuck: no way\n"),
    (RunState("failed", "stuck", "no way"), "failed: stuck: no way\n"),
])  # fmt: skip
def test_a_result_says_no_word_twice(running: Running, result: RunState, line: str) -> None:
    runs_end(running, result)
    assert say(running, "goto", "1", "2") == (1, line)


def test_numbers_in_the_rows_of_a_recorded_value_are_numbers() -> None:
    values = {"motion/status": '<element>3</element><status element="0" code="3" name="at-rest"/>',
              "tree": '<tick>1</tick><node path="a" depth="1" name="7" since_s="0.5"/>'}  # fmt: skip
    texts = [f'<value topic="{topic}" seq="1" stamp="1">{text}</value>' for topic, text in values.items()]
    status, tree = (json.loads(as_json(ElementTree.fromstring(text))) for text in texts)
    assert status["status"] == [{"element": 0, "code": 3, "name": "at-rest"}]
    (node,) = tree["nodes" if tree.get("nodes") else "node"]
    assert (node["depth"], node["name"], node["since_s"]) == (1, "7", 0.5)


def test_stop_with_a_name_stops_a_module_and_alone_it_is_the_stop(running: Running) -> None:
    assert say(running, "stop", "slam") == (0, "slam stopped\n")
    assert say(running, "start", "slam") == (0, "slam started\n")
    assert say(running, "slam", "start") == (0, "slam started\n")
    assert [did for did in running.robot.did if did[0] in ("module", "stop")] == [("module", "slam", op) for op in ("stop", "start", "start")]
    assert say(running, "start", "slem") == (1, 'pluto shell: unknown-module: unknown module "slem"\n')


def test_why_tells_the_first_cause_and_the_way_up(running: Running) -> None:
    code, text = say(running, "why")
    assert (code, text.splitlines()) == (0, [
        "not moving", "  because sensor: bumper since 4.0 s: front panel pressed", "          what would help: back off",
        "  mission: paused since 1.0 s: mission patrol paused",
    ])  # fmt: skip
    assert say(running, "why", "1e6")[0] == 1


def test_modules_events_and_the_state_of_a_device_are_shown(running: Running) -> None:
    running.robot.says("hello from the mission")
    running.robot.says("\x1b]0;gotcha\x07 words", "warning")
    running.robot.write("compass/state", m.CompassState(0.0, 1.5))
    assert "base" in say(running, "modules")[1]
    code, text = say(running, "events")
    assert code == 0 and "hello from the mission" in text and "\x1b" not in text and "gotcha" in text
    assert "hello" not in say(running, "events", "warning")[1]
    assert "heading_rad      1.5" in say(running, "compass", "state")[1]
    running.robot.write("wrist/state", m.ActuatorState(0.0, 0, (0.1 + 0.2, -1.0 / 3.0)))
    assert "position         0.3 -0.3333333\n" in say(running, "wrist", "state")[1]
    code, text = say(running, "gas", "state")
    assert code == 1 and "nobody writes it in this run, or not yet" in text


def test_watch_and_record_give_values_as_they_come(running: Running, tmp_path: Path) -> None:
    running.on_step = lambda: running.robot.write("compass/state", m.CompassState(running.robot.time_s, 1.5))
    code, text = say(running, "watch", "compass/state", "50", "0.3")
    assert code == 0 and text.count("compass/state") >= 3
    assert say(running, "record", "0.2", str(tmp_path / "values.jsonl"), "compass/*")[0] == 0
    values = [json.loads(line) for line in (tmp_path / "values.jsonl").read_text().splitlines()]
    assert values and all(value["topic"] == "compass/state" and value["heading_rad"] == 1.5 for value in values)
    assert say(running, "record", "0.2", str(tmp_path / "values.jsonl")) == (
        1, f'pluto shell: "{tmp_path / "values.jsonl"}" is there already; give another name\n')  # fmt: skip
    assert say(running, "watch", "compas/state") == (1, 'pluto shell: unknown-topic: unknown topic "compas/state"; did you mean "compass/state"?\n')


def test_raw_commands_say_what_the_link_above_says(running: Running) -> None:
    assert say(running, "avoid", "velocity", "0.2", "0", "1") == (1, "pluto shell: wrong-state: motion runs; stop the module motion first\n")
    code, text = say(running, "drive", "velocity", "0.2", "-10", "0.2")
    assert (code, text) == (0, "at rest\n")
    commands = [did for did in running.robot.did if did[0] == "command"]
    assert [did[1:3] for did in commands] == [("drive", 10), ("drive", 10)]
    assert commands[0][3] == pytest.approx((0.2, -0.17453), abs=1e-4) and commands[1][3] == (0.0, 0.0)


class Mission:
    """A robot that runs what it is told to: `order` is what the shell sent."""

    def __init__(self, running: Running, end: str) -> None:
        self.orders: list[tuple[object, ...]] = []
        self._running, self._end, self._run = running, end, next(RUNS)
        running.robot.mission_now = m.MissionState(0.0, "before", self._run, "succeeded")
        running.robot.mission = self.order  # type: ignore[method-assign]

    def order(self, op: str, name: str, text: str, source: str, ports: Mapping[str, str]) -> None:
        self.orders.append((op, name, text, *([dict(ports)] if ports else [])))
        if op == "start":
            running = self._running
            running.robot.mission_now = m.MissionState(running.robot.time_s, "m", self._run + 1, "running")
            running.robot.write("mission/state", running.robot.mission_now)
            over = m.MissionState(0.0, "m", self._run + 1, self._end, "why")
            threading.Timer(0.2, lambda: running.robot.write("mission/state", over)).start()


@pytest.mark.parametrize(("end", "expected"), [("succeeded", (0, "succeeded: why\n")), ("failed", (1, "failed: why\n"))])
def test_run_watches_a_mission_to_its_end(running: Running, end: str, expected: tuple[int, str]) -> None:
    mission = Mission(running, end)
    assert say(running, "run", "trip2") == expected
    assert mission.orders == [("load", "trip2.xml", ""), ("start", "", "")]


def test_run_gives_inputs_and_files_and_can_let_go(running: Running, tmp_path: Path) -> None:
    mission = Mission(running, "succeeded")
    file = tmp_path / "mine.xml"
    file.write_text('<?xml version="1.0"?>\n<root BTCPP_format="4"><BehaviorTree ID="Mine"><Say text="{what}"/></BehaviorTree></root>')
    assert say(running, "run", str(file), "&") == (0, f"{file} runs\n")
    assert mission.orders[0] == ("load", "mine.xml", file.read_text().partition("?>")[2])
    assert say(running, "run", str(file), "what=a<b", "&")[0] == 0
    assert mission.orders[2] == (*mission.orders[0], {"what": "a<b"})
    assert say(running, "run", "patrol", "goals=1,2;3,4", "&")[0] == 0
    assert mission.orders[4] == ("load", "patrol.xml", "", {"goals": "1,2;3,4"})
    file.write_text("<root>\n <oops></root>")
    code, text = say(running, "run", str(file))
    assert code == 1 and f"{file}:2:" in text


def test_ctrl_c_stops_the_robot_then_the_command_ends(running: Running) -> None:
    """How soon: `pluto bench console`."""
    begun, stopped = threading.Event(), threading.Event()

    def run_node(*_: object) -> str:
        begun.set()
        running.robot.runs["r1"] = RunState()
        return "r1"

    running.robot.run_node = run_node  # type: ignore[method-assign]
    running.robot.stop = lambda source: stopped.set()  # type: ignore[method-assign]
    shell = subprocess.Popen([sys.executable, "-m", "pluto_bt", "shell", str(running.address), "goto", "3", "4"], stdout=subprocess.PIPE, text=True)
    assert begun.wait(60.0)
    shell.send_signal(signal.SIGINT)
    assert stopped.wait(60.0)
    assert shell.wait(60.0) == 130 and "stopped" in shell.communicate()[0]


def test_a_script_stops_at_its_first_failure_and_says_where(running: Running, monkeypatch: pytest.MonkeyPatch) -> None:
    def play(text: str) -> tuple[int, str]:
        monkeypatch.setattr("sys.stdin", io.StringIO(text))
        return say(running)

    code, text = play("# a comment\nhelp\n\nstop\nstpo\nstop\n")
    assert code == 2 and "goto X Y" in text and text.count("stopped\n") == 1
    assert text.endswith("line 5: stpo: ended here, with exit code 2\n")
    runs_end(running, RunState("succeeded"))
    assert play("wrist>\nhome\nback\nstop\nquit\nstpo\n") == (0, "succeeded\nstopped\n")
    assert play('goto "3 4\n')[0] == 2


def test_no_robot_there_is_exit_1_and_a_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["127.0.0.1:9", "stop"]) == 1
    assert "no gateway at 127.0.0.1:9: " in capsys.readouterr().err


def test_every_row_has_help_and_no_two_of_a_shell_have_one_name(running: Running) -> None:
    for shell in ("", *SUBSHELLS):
        names = [row.name for row in ROWS if row.shell == shell]
        assert len(names) == len(set(names)) > 0, shell
        assert all(name in help_text(shell) for name in names)
    code, text = say(running, "help", "goto")
    assert code == 0 and "needs the lease" in text and "X: a number in m" in text
    assert "point PAN TILT" in say(running, "help", "wrist")[1]


def test_values_that_are_no_numbers_survive_as_text(running: Running) -> None:
    running.robot.write("mission/state", m.MissionState(0.0, "a b", 3, "running"))
    running.robot.write("drive/status", m.FVectorState(0.0, (math.inf, 0.5), (6,)))
    running.robot.write("tree", m.TreeState(0.0, 7))
    code, text = say(running, "record", "0.1", "-", "mission", "drive/status", "tree")
    assert code == 0
    told = {value["topic"]: value for value in map(json.loads, text.splitlines())}
    assert (told["drive/status"]["data"], told["drive/status"]["element"]) == ([None, 0.5], [6])
    assert told["drive/status"]["status"][0]["name"] == "laser-slow-stop" and (told["tree"]["tick"], told["tree"]["node"]) == (7, [])
    mission: dict[str, Any] = told["mission"]
    assert (mission["name"], mission["run"], mission["state"]) == ("a b", 3, "running")
