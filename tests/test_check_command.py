"""`pluto check` as a program: formats, files of every kind, models, missions in worlds."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pluto_bt.platforms
from pluto_bt.cli import main
from pluto_bt.commands.fault_formats import as_github, as_sarif
from pluto_bt.inputs.ways_in_world import Ways, inner_radius_m
from pluto_bt.maps.world import Shape, World
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.source import Fault

PLATFORMS = Path(pluto_bt.platforms.__file__).parent
MISSION = """<root BTCPP_format="4"><BehaviorTree ID="Main"><Sequence>
{body}
</Sequence></BehaviorTree></root>
"""
WORLD = """<world name="w">
  <wall>0,0 20,0 20,10 0,10 0,0</wall>
  <polygon id="block">8,3 10,3 10,7 8,7</polygon> <polygon id="cell">14,6 19,6 19,7 15,7 15,9.5 14,9.5</polygon> <wall id="lid">14,9.5 14,10</wall>
  <wall id="bar">19,6 20,6</wall>
  <area id="pond" kind="forbidden">2,7 6,7 6,9.5 2,9.5</area> <area id="lawn" kind="named">0,0 3,0 3,3</area>
  <goal id="gate" x="12" y="2"/> <actor id="walker" r="0.3" speed="1">5,5 6,5</actor>
  {more}
  <robot platform="{platform}" x="2" y="5" theta_deg="0"/>
</world>
"""


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def checked(capsys: pytest.CaptureFixture[str], body: str, *options: str, more: str = "", platform: str = "atrv2") -> tuple[list[str], Any]:
    """The faults of a mission in the world as "line:column severity code", and the whole answer."""
    Path("m.xml").write_text(MISSION.format(body=body), encoding="utf-8")
    Path("w.xml").write_text(WORLD.format(more=more, platform=platform), encoding="utf-8")
    code = main(["check", "m.xml", "--world", "w.xml", "--format", "json", *options])
    answer = json.loads(capsys.readouterr().out)
    assert code == (2 if any(fault["severity"] == "error" for fault in answer["faults"]) else 0)
    return [f"{fault['line']}:{fault['column']} {fault['severity']} {fault['code']}" for fault in answer["faults"]], answer


LEGS = [
    # what it shows                      mission                                                          faults
    ("a free way", '<GoTo goal="6;5"/>', []),
    ("an actor is no wall", '<GoTo goal="7;5"/>', []),
    ("a wall in between, and a way round", '<GoTo goal="12;5"/>', ["2:13 warning leg-blocked"]),
    ("who looks for a way finds it", '<MoveTo goal="12;5"/>', []),
    ("inside a thing", '<GoTo goal="9;5"/>', ["2:13 error goal-blocked"]),
    ("too near to a wall for the body", '<MoveTo goal="7.9;5"/>', ["2:15 error goal-blocked"]),
    ("near enough counts as there", '<GoTo goal="7.3;5" tolerance_m="0.5"/>', []),
    ("a planned way round", '<NavigateTo goal="12;5"/>', []),
    ("a goal by its name", '<NavigateTo goal="gate"/>', []),
    ("what is planned is judged where it is planned", '<ComputePathToPose goal="17;8.5" path="{p}"/>', ["2:26 error no-way"]),
    ("who only plans stays where it is", '<PlanPath goal="12;8" path="{p}"/><GoTo goal="12;5"/>', ["2:47 warning leg-blocked"]),
    ("from a place of its own it may find a way", '<PlanPath goal="17;8.5" start="17;9" path="{p}"/>', []),
    ("a name that is no goal to plan to", '<ComputePathToPose goal="gtae" path="{p}"/>', ["2:26 error unknown-goal"]),
    ("a name that is no goal, in an entry", '<SubTree ID="Go" place="gtae"/></Sequence></BehaviorTree>\n'
     '<BehaviorTree ID="Go"><Sequence><ComputePathToPose goal="{place}" path="{p}"/>', ["3:58 error unknown-goal"]),
    ("a name that is no goal", '<NavigateTo goal="gtae"/>', ["2:19 error unknown-goal"]),
    ("home, which this world has not", '<NavigateTo goal="home"/>', ["2:19 error unknown-goal"]),
    ("one goal after the other", '<NavigateThroughPoses goals="6,5;gate;9,5"/>', ["2:30 error goal-blocked"]),
    ("planned, no way in", '<NavigateTo goal="17;8.5"/>', ["2:19 error no-way"]),
    ("no way in", '<MoveTo goal="17;8.5"/>', ["2:15 error no-way"]),
    ("after what cannot be reached nothing is known", '<Sequence><MoveTo goal="17;8.5"/><GoTo goal="12;5"/></Sequence>', ["2:25 error no-way"]),
    ("beyond the yard", '<MoveTo goal="40;5"/>', ["2:15 error no-way"]),
    ("into what is forbidden", '<GoTo goal="4;8"/>', ["2:13 error forbidden"]),
    ("through what is forbidden", '<Sequence><GoTo goal="1;8"/><GoTo goal="7;8.2"/></Sequence>', ["2:41 error forbidden"]),
    ("round what is forbidden", '<Sequence><GoTo goal="1;8"/><MoveTo goal="7;8.2"/></Sequence>', []),
    ("the second leg begins where the first ended", '<Sequence><GoTo goal="6;1.5"/><GoTo goal="12;1.5"/><GoTo goal="12;8"/></Sequence>', []),
    ("after an unknown drive nothing is known", '<Sequence><DriveVelocity duration_s="3"/><GoTo goal="12;5"/></Sequence>', []),
    ("a turn leaves it where it is", '<Sequence><MakeTurn angle_deg="90"/><GoTo goal="12;5"/></Sequence>', ["2:49 warning leg-blocked"]),
    ("an entry that keeps its value", '<SubTree ID="Go" place="9;5"/></Sequence></BehaviorTree>\n'
     '<BehaviorTree ID="Go"><Sequence><GoTo goal="{place}"/>', ["3:45 error goal-blocked"]),
    ("an unknown area", '<InsideArea area="lwan"/>', ["2:19 error unknown-area"]),
    ("a known area", '<InsideArea area="lawn"/>', []),
]  # fmt: skip


@pytest.mark.parametrize(("body", "faults"), [row[1:] for row in LEGS], ids=[row[0] for row in LEGS])
def test_legs_in_a_world(body: str, faults: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert checked(capsys, body)[0] == faults


def test_distance_and_time_of_each_leg_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    body = '<GoTo name="out" goal="6;5" max_speed_mps="0.5"/><Fallback><GoTo name="on" goal="6;2"/><GoTo name="else" goal="3;3"/></Fallback>'
    _, answer = checked(capsys, body)
    out, on, otherwise = answer["legs"]
    assert (out["leg"], out["start"], out["goal"], out["distance_m"]) == ('GoTo "out"', [2.0, 5.0], [6.0, 5.0], 4.0)
    assert 4.0 / 0.5 < out["time_s"] < 4.0 / 0.5 + 2.0
    assert (on["start"], on["distance_m"]) == ([6.0, 5.0], 3.0)
    assert (otherwise["start"], otherwise["distance_m"], otherwise["time_s"]) == (None, None, None)
    assert main(["check", "m.xml", "--world", "w.xml"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith('GoTo "out": 2;5 → 6;5: 4.0 m, about 9 s')
    assert lines[-1].startswith("2 legs, 7.0 m, about ") and lines[-1].endswith("1 more of unknown length")


GAPS = [(0.3, True), (0.9, False), (2.0, False)]


@pytest.mark.parametrize(("gap_m", "is_cut_off"), GAPS)
@pytest.mark.parametrize("angle_deg", [0, 17, 45])
def test_a_way_is_called_missing_only_where_nothing_of_the_robots_width_passes(gap_m: float, is_cut_off: bool, angle_deg: float) -> None:
    """Two half-planes with a gap, turned against the cells of the grid; the robot is 0.85 m wide."""
    robot, turn = load_robot_file("atrv2"), complex(math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg)))

    def wall(name: str, *corners: complex) -> Shape:
        return Shape(name, "wall", np.array([[(turn * corner).real, (turn * corner).imag] for corner in corners]))

    def at(corner: complex) -> tuple[float, float]:
        return (turn * corner).real, (turn * corner).imag

    box = wall("box", -8 - 8j, 8 - 8j, 8 + 8j, -8 + 8j, -8 - 8j)
    world = World("w", shapes=(box, wall("left", -8, -gap_m / 2), wall("right", gap_m / 2, 8)))
    start, goal = at(3 - 4j), at(-3 + 4j)
    width_m = 2.0 * inner_radius_m(np.array(robot.body.outline_m))
    assert (gap_m < width_m) is is_cut_off
    ways = Ways(world, robot, robot.plan, [start, goal])
    assert ways.is_cut_off(start, goal) is is_cut_off
    length_m = ways.length_m(start, goal, 0.3)
    assert length_m is None if gap_m < ways.width_m else length_m == pytest.approx(abs(3 - 4j) * 2, rel=0.1)


def test_a_way_round_is_longer_than_the_straight_one(capsys: pytest.CaptureFixture[str]) -> None:
    (leg,) = checked(capsys, '<MoveTo goal="12;5"/>')[1]["legs"]
    assert math.hypot(6.0, 2.3) + math.hypot(2.0, 2.3) < leg["distance_m"] < 13.0  # past the corners of the block, and not along the yard's wall


def test_a_loop_over_a_list_is_a_leg_for_each_element_and_a_round_ends_at_its_beginning(capsys: pytest.CaptureFixture[str]) -> None:
    body = '<Repeat num_cycles="2"><LoopString queue="6,5;6,2" value="{g}"><GoTo name="go" goal="{g}"/></LoopString></Repeat>'
    found, answer = checked(capsys, body)
    assert found == []
    assert [leg["goal"] for leg in answer["legs"]] == [[6.0, 5.0], [6.0, 2.0], [6.0, 5.0]]
    assert [leg["start"] for leg in answer["legs"]] == [[2.0, 5.0], [6.0, 5.0], [6.0, 2.0]]


def test_a_world_whose_script_opens_ways_makes_a_missing_way_a_warning(capsys: pytest.CaptureFixture[str]) -> None:
    script = '<script><at t="5"><remove id="lid"/></at></script>'
    assert checked(capsys, '<MoveTo goal="17;8.5"/>', more=script)[0] == ["2:15 warning no-way"]
    assert checked(capsys, '<MoveTo goal="9;5"/>', more=script)[0] == ["2:15 warning goal-blocked"]
    assert checked(capsys, '<MoveTo goal="4;8"/>', more=script)[0] == ["2:15 error forbidden"]


def test_a_robot_with_eyes_may_leave_the_mapped_area_on_its_way(capsys: pytest.CaptureFixture[str]) -> None:
    area = '<area kind="map">1,1 12,1 12,9 11,9 11,2.5 7,2.5 7,9 1,9</area>'
    assert checked(capsys, '<GoTo goal="11.5;5"/>', more=area)[0] == ["2:13 warning outside-map"]
    assert checked(capsys, '<GoTo goal="13;5"/>', more=area)[0] == ["2:13 error outside-map"]


def test_the_car_has_no_eyes_and_a_mapped_area(capsys: pytest.CaptureFixture[str]) -> None:
    area = '<area kind="map">1,1 12,1 12,9 11,9 11,2.5 7,2.5 7,9 1,9</area>'
    assert checked(capsys, '<CarGoTo goal="6;5"/>', more=area, platform="car")[0] == []
    assert checked(capsys, '<CarGoTo goal="13;5"/>', more=area, platform="car")[0] == ["2:16 error outside-map"]
    assert checked(capsys, '<CarGoTo goal="11.5;5"/>', more=area, platform="car")[0] == ["2:16 error outside-map"]
    assert checked(capsys, '<CarGoTo goal="12;5"/>', platform="car")[0] == ["2:16 error leg-blocked"]


@pytest.mark.parametrize(
    ("edges", "platform", "settings", "warns"),
    [
        (("0,0 20,0 20,10 0,10",), "car", "", ["3:5 0.00 m"]),  # in line 3 the first: at the walls, and with the block in its middle
        (("0.3,0.3 7.7,0.3 7.7,4.7 0.3,4.7",), "car", "", []),
        (("0.3,0.3 7.8,0.3 7.8,4.7 0.3,4.7",), "car", "", ["3:5 0.20 m"]),
        (("0,0 7,0 7,2 0,2", "0.3,2 7.7,2 7.7,4 0.3,4"), "car", "", ["3:5 0.00 m"]),  # where two meet is no edge
        (("0,0 20,0 20,10 0,10",), "pioneer", "", []),  # it sees the walls
        (("0,0 7.7,0 7.7,4.7 0,4.7",), "keeping.toml", "[filter]\narea_margin_m = 0.28\n", []),
        (("0,0 7.9,0 7.9,4.7 0,4.7",), "keeping.toml", "[filter]\narea_margin_m = 0.1\n", ["3:5 0.10 m"]),
    ],
)
def test_a_mapped_area_that_lets_a_blind_robot_touch_something_is_warned_of(
    edges: tuple[str, ...], platform: str, settings: str, warns: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    areas = "\n    ".join(f'<area id="a{i}" kind="map">{edge}</area>' for i, edge in enumerate(edges))
    Path("w.xml").write_text(f'''<world name="w"><wall id="rim">0,0 20,0 20,10 0,10 0,0</wall>
    <polygon id="block">8,3 10,3 10,7 8,7</polygon>
    {areas}</world>''', encoding="utf-8")
    Path("keeping.toml").write_text((PLATFORMS / "car.toml").read_text(encoding="utf-8") + settings, encoding="utf-8")
    assert main(["check", "w.xml", "--platform", platform, "--format", "json"]) == 0
    faults = json.loads(capsys.readouterr().out)["faults"]
    assert [f"{one['line']}:{one['column']} {one['found']}" for one in faults if one["code"] == "area-near-wall"] == warns


def test_a_map_of_cells_counts_like_walls(capsys: pytest.CaptureFixture[str]) -> None:
    from PIL import Image

    cells = np.full((100, 100), 254, dtype=np.uint8)
    cells[:, 80:82] = 0
    Image.fromarray(cells).save("m.png")
    of_cells = "image: m.png\nresolution: 0.1\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.2\nnegate: 0\n"
    Path("m.yaml").write_text(of_cells, encoding="utf-8")
    for edge_m, n_warnings in ((7.9, 1), (7.7, 0)):
        area = f'<area id="a" kind="map">1,1 {edge_m},1 {edge_m},9 1,9</area>'
        Path("w.xml").write_text(f'<world name="w"><map src="m.yaml"/>{area}</world>', encoding="utf-8")
        assert main(["check", "w.xml", "--platform", "car", "--format", "json"]) == 0
        faults = json.loads(capsys.readouterr().out)["faults"]
        assert [one["code"] for one in faults] == ["area-near-wall"] * n_warnings, faults


def test_a_leaf_that_the_worlds_script_names_must_be_there(capsys: pytest.CaptureFixture[str]) -> None:
    fault = '<script><at t="5"><fault device="leaf:{}" kind="raise"/></at></script>'
    for known in ("out", "GoTo"):
        assert checked(capsys, '<GoTo name="out" goal="6;5"/>', more=fault.format(known))[0] == []
    found, answer = checked(capsys, '<GoTo name="out" goal="6;5"/>', more=fault.format("outt"))
    assert found == ["7:21 error unknown-leaf"]
    assert (answer["faults"][0]["file"], answer["faults"][0]["mend"]) == ("w.xml", 'did you mean "out"?')
    assert main(["run", "m.xml", "--world", "w.xml"]) == 2


@pytest.mark.parametrize("body", ['<NavigateTo goal="gtae"/>', '<PlanPath goal="gtae" path="{p}"/>', '<InsideArea area="lwn"/>'])
def test_run_warns_of_names_that_its_map_does_not_have(body: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The leaf fails with a reason, which the mission may be ready for; so it runs."""
    (fault,) = checked(capsys, body)[1]["faults"]
    assert fault["code"] in ("unknown-goal", "unknown-area")
    assert main(["run", "m.xml", "--world", "w.xml", "--max-time", "5", "--json"]) == 1
    run = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert run["result"] == "FAILURE" and run["faults"] == [fault | {"severity": "warning"}]


@pytest.mark.parametrize("name", ["yard.xml", "yard", "t01_say_hello.xml", "t01_say_hello", "atrv2", "car"])
def test_shipped_files_are_checked_by_name(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", name]) == 0
    assert "1 checked, 0 errors, 0 warnings" in capsys.readouterr().err


def test_a_name_that_is_nothing_is_told_with_what_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "yrd.xml"]) == 2
    out = capsys.readouterr().out
    assert "no shipped mission, world or platform" in out and 'did you mean "yard.xml"?' in out


def test_run_refuses_a_node_that_is_only_modelled_by_its_name(capsys: pytest.CaptureFixture[str]) -> None:
    model = '<TreeNodesModel><Action ID="Grasp"/></TreeNodesModel>'
    text = MISSION.format(body="<Grasp/>").replace("</root>", f"{model}</root>").replace("<root ", '<root main_tree_to_execute="Main" ')
    Path("m.xml").write_text(text)
    assert main(["check", "m.xml", "--model", "m.xml"]) == 0
    assert main(["run", "m.xml"]) == 2
    err = capsys.readouterr().err
    assert "m.xml:2:1: error: unknown node <Grasp>" in err and "no implementation" in err


def test_a_model_that_cannot_be_read_is_a_fault(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "t01_say_hello.xml", "--model", "nope.xml"]) == 2
    assert 'there is no file "nope.xml"' in capsys.readouterr().out


FAULT = Fault("my dir/m,1.xml", 3, 7, "error", "unknown-port", 'unknown port "a%b"', "one of: goal", "a%b", "line\nfeed")
OPTION = Fault("--port x", 0, 0, "warning", "bad-port", "an input has the form NAME=VALUE")


def test_workflow_commands_escape_what_github_would_take_for_its_own() -> None:
    first, second = as_github([FAULT, OPTION]).splitlines()
    assert first == ('::error file=my dir/m%2C1.xml,line=3,col=7,title=unknown-port::unknown port "a%25b"%0Aexpected: one of: goal'
                     "%0Afound: a%25b%0Amend: line%0Afeed")  # fmt: skip
    assert second == "::warning title=bad-port::--port x: an input has the form NAME=VALUE"


def test_sarif_holds_what_the_standard_asks_for() -> None:
    """The parts of the SARIF 2.1.0 schema that apply: required members, types, and no others."""
    log = json.loads(as_sarif([FAULT, OPTION]))
    assert set(log) == {"$schema", "version", "runs"} and log["version"] == "2.1.0"
    (run,) = log["runs"]
    driver = run["tool"]["driver"]
    assert run["columnKind"] == "unicodeCodePoints" and driver["name"] == "pluto check"
    assert [rule["id"] for rule in driver["rules"]] == ["bad-port", "unknown-port"]
    (first,) = run["results"]
    assert (first["ruleId"], first["level"]) == ("unknown-port", "error") and driver["rules"][first["ruleIndex"]]["id"] == first["ruleId"]
    (location,) = first["locations"]
    assert location == {"physicalLocation": {"artifactLocation": {"uri": "my%20dir/m%2C1.xml"}, "region": {"startLine": 3, "startColumn": 7}}}
    (call,) = run["invocations"]
    (note,) = call["toolConfigurationNotifications"]
    assert note["message"]["text"].startswith("--port x: ") and driver["rules"][note["associatedRule"]["index"]]["id"] == "bad-port"
    assert call["executionSuccessful"] is (OPTION.severity != "error")


URIS = [("a/b c.xml", "a/b%20c.xml"), ("./m.xml", "m.xml"), ("{here}/m.xml", "m.xml"), ("/else where/m.xml", "file:///else%20where/m.xml")]


@pytest.mark.parametrize(("file", "uri"), URIS)
def test_sarif_names_files_as_seen_from_the_working_folder(file: str, uri: str) -> None:
    fault = replace(FAULT, file=file.format(here=Path.cwd()))
    (result,) = json.loads(as_sarif([fault]))["runs"][0]["results"]
    assert result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == uri


def test_an_empty_sarif_log_is_a_log(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "t01_say_hello.xml", "--format", "sarif"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["results"] == []
    assert main(["check", "t01_say_hello.xml", "--format", "github"]) == 0
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(("body", "platform", "faults"), [
    ('<MoveTo goal="6;5"/>', "jbot", ["2:1 error no-device"]),
    ('<Fallback><Follow/><GoTo goal="6;5"/></Fallback>', "jbot", ["2:11 warning no-device"]),
    ('<RoundRobin><Follow/><GoTo goal="6;5"/></RoundRobin>', "jbot", ["2:13 warning no-device"]),
    ('<Precondition if="1 == 2" else="SUCCESS"><Follow/></Precondition>', "jbot", ["2:42 warning no-device"]),
    ('<Parallel failure_count="2"><Follow/><Say text="a"/></Parallel>', "jbot", ["2:29 warning no-device"]),
    ('<Parallel><Follow/><Say text="a"/></Parallel>', "jbot", ["2:11 error no-device"]),
    ('<Delay delay_msec="10"><Timeout msec="900"><Follow/></Timeout></Delay>', "jbot", ["2:44 error no-device"]),
    ('<Follow _skipIf="1 == 2"/>', "jbot", ["2:1 warning no-device"]),
    ('<WallFollow/>', "jbot", []),
    ('<WallFollow/>', "car", ["2:1 error no-device"]),
    ('<PointWrist pan_deg="10"/>', "pioneer", ["2:1 error no-device"]),
    ('<SweepWrist optional="true"/><UnfoldArm optional="{=}"/>', "pioneer", []),
    ('<MakeTurn angle_deg="90"/>', "jbot", []),
    ('<MoveTo goal="6;5"/>', "pioneer", []),
])  # fmt: skip
@pytest.mark.parametrize("with_world", [True, False])
def test_a_leaf_whose_device_the_robot_does_not_have(
    capsys: pytest.CaptureFixture[str], body: str, platform: str, faults: list[str], with_world: bool
) -> None:
    Path("m.xml").write_text(MISSION.format(body=body), encoding="utf-8")
    Path("w.xml").write_text(f'<world name="w"><area kind="map">0,0 20,0 20,10 0,10</area><robot platform="{platform}" x="2" y="5"/></world>')
    main(["check", "m.xml", "--format", "json", *(["--world", "w.xml"] if with_world else ["--platform", platform])])
    found = [fault for fault in json.loads(capsys.readouterr().out)["faults"] if fault["code"] in ("no-device", "unknown-platform")]
    assert [f"{fault['line']}:{fault['column']} {fault['severity']} {fault['code']}" for fault in found] == faults


def test_a_map_without_a_start_says_nothing_of_the_first_way_and_start_gives_one(capsys: pytest.CaptureFixture[str]) -> None:
    pixels = np.full((60, 120), 254, np.uint8)
    pixels[[0, -1], :] = pixels[:, [0, -1]] = 0  # a room of 12 m by 6 m, whose corner is the origin
    Path("room.pgm").write_bytes(b"P5 120 60 255\n" + pixels.tobytes())
    Path("room.yaml").write_text("image: room.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n")
    body = '<NavigateTo goal="9;3"/>'
    faults, answer = checked(capsys, body, "--world", "room.yaml")
    assert (faults, answer["legs"][0]["start"], answer["legs"][0]["distance_m"]) == ([], None, None)
    faults, answer = checked(capsys, body, "--world", "room.yaml", "--start", "3,3,0")
    assert (faults, answer["legs"][0]["start"]) == ([], [3.0, 3.0]) and answer["legs"][0]["distance_m"] == pytest.approx(6.0, abs=0.3)
    faults, _ = checked(capsys, body, "--world", "room.yaml", "--start", "0,0,0")
    assert "0:0 error start-blocked" in faults
    assert checked(capsys, '<NavigateTo goal="6;5"/>', "--start", "3;3")[0] == ["0:0 error bad-value"]


def test_a_leg_begins_where_the_one_to_a_named_goal_ended(capsys: pytest.CaptureFixture[str]) -> None:
    body = '<NavigateTo goal="gate"/><NavigateTo goal="6;5"/><NavigateTo goal="gate"/>'
    _, answer = checked(capsys, body)
    assert [leg["start"] for leg in answer["legs"]] == [[2, 5], [12, 2], [6, 5]] and all(leg["distance_m"] for leg in answer["legs"])


def test_a_tree_that_is_used_twice_is_told_by_the_worse_use(capsys: pytest.CaptureFixture[str]) -> None:
    visit = '<SubTree ID="Visit"/>'
    text = MISSION.format(body=f"<Sequence><Fallback>{visit}<AlwaysSuccess/></Fallback>{visit}</Sequence>")
    Path("m.xml").write_text(text.replace("</root>", '<BehaviorTree ID="Visit"><Follow/></BehaviorTree></root>'), encoding="utf-8")
    main(["check", "m.xml", "--format", "json", "--platform", "jbot"])
    found = [fault for fault in json.loads(capsys.readouterr().out)["faults"] if fault["code"] == "no-device"]
    assert [fault["severity"] for fault in found] == ["error"]


@pytest.mark.parametrize(("fault", "platform", "found"), [
    ('device="laser" kind="nan" beams="900-950"', "atrv2", ["no-beam"]),
    ('device="laser" kind="nan" beams="300-360"', "atrv2", []),
    ('device="sonar" kind="nan" beams="12"', "atrv2", ["no-beam"]),
    ('device="laser" kind="off"', "jbot", ["no-device"]),
    ('device="wrist" kind="blocked"', "pioneer", ["no-device"]),
    ('device="imu" kind="off"', "atrv2", []),
    ('device="base" kind="blocked"', "jbot", []),
])  # fmt: skip
def test_a_fault_that_means_nothing_on_the_robot(capsys: pytest.CaptureFixture[str], fault: str, platform: str, found: list[str]) -> None:
    Path("w.xml").write_text(f'<world name="w"><robot platform="{platform}" x="2" y="5"/><script><at t="1">\n<fault {fault}/></at></script></world>')
    assert main(["check", "w.xml", "--format", "json"]) == 0
    faults = json.loads(capsys.readouterr().out)["faults"]
    assert [one["code"] for one in faults] == found and all(one["line"] == 2 and one["severity"] == "warning" for one in faults)


@pytest.mark.parametrize("words", ["b.xml --format json a.xml", "--format json b.xml a.xml", "--format=json -- b.xml a.xml"])
def test_options_may_stand_between_files(capsys: pytest.CaptureFixture[str], words: str) -> None:
    for name in ("a.xml", "b.xml"):
        Path(name).write_text("<world/", encoding="utf-8")
    assert main(["check", *words.split()]) == 2
    assert [fault["file"] for fault in json.loads(capsys.readouterr().out)["faults"]] == ["b.xml", "a.xml"]


def test_what_is_like_no_file_is_not_taken_for_one(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "nofile.xml"]) == 2 and "did you mean" not in capsys.readouterr().err
    assert main(["diff", "yard.xml", "patrol.xml"]) == 2 and "found     a shipped world\n" in capsys.readouterr().err
    assert main(["run", "patol.xml"]) == 2 and 'did you mean "patrol.xml"?' in capsys.readouterr().err


def test_numbers_that_are_none_are_told_as_what_they_are(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "patrol.xml", "--port", "goals=4,3", "--set", "drive.max_speed_mps=nan"]) == 2
    told = capsys.readouterr().err
    assert "got str" not in told and "NaN" in told and "a number >= 0" in told


def test_more_faults_than_can_be_told_are_not_counted_as_all(capsys: pytest.CaptureFixture[str]) -> None:
    Path("m.xml").write_text(MISSION.format(body="<Foo/>\n" * 1500), encoding="utf-8")
    assert main(["check", "m.xml"]) == 2
    told = capsys.readouterr()
    assert told.err == "1 checked, more than 999 errors, 0 warnings\n" and "there are more errors than can be told" in told.out[-200:]


def test_nodes_by_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["nodes", "GoTo"]) == 0
    told = capsys.readouterr().out
    assert told.startswith("GoTo ") and "goal" in told and "NavigateTo" not in told
    assert main(["nodes", "Goto"]) == 2 and 'did you mean "GoTo"?' in capsys.readouterr().err
