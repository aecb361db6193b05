"""A black box in other forms: as a picture, as tables, as a log of CARMEN; and what somebody writes down who listens from outside."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.cli import main
from pluto_bt.record.box import Box, open_box
from pluto_bt.record.curves import Lane, goals_of, track_of, velocities, verdicts, work
from pluto_bt.scenario import Play, Run
from pluto_bt.source import Faults

MISSION = """<root BTCPP_format="4"><BehaviorTree ID="m"><Sequence><GoTo name="out" goal="4;0"/>
  <Timeout msec="1500"><GoTo name="too far" goal="9;3"/></Timeout></Sequence></BehaviorTree></root>"""
WORLD = """<world name="hall" seed="3"><wall id="f">-2,-4 12,-4 12,5 -2,5 -2,-4</wall>
  <script><at t="3"><fault device="laser" kind="off" for="2"/></at></script></world>"""


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Run]:
    folder = tmp_path_factory.mktemp("run")
    (folder / "m.xml").write_text(MISSION, encoding="utf-8")
    (folder / "w.xml").write_text(WORLD, encoding="utf-8")
    run = Play(folder)(
        str(folder / "w.xml"), mission=str(folder / "m.xml"), platform="pioneer", record=folder / "a.mcap", settings=["record.thinned_period_s=0.01"]
    )
    return folder / "a.mcap", run


def opened(path: Path) -> Box:
    box = open_box(path, str(path), Faults())
    assert box is not None
    return box


def lane(lanes: list[Lane], name: str) -> list[tuple[float, float, str]]:
    return [(round(span.begin_s, 1), round(span.end_s, 1), span.word) for span in next(one for one in lanes if one.name == name).spans]


def test_the_path_the_goals_and_the_speeds_are_those_of_the_run(recording: tuple[Path, Run]) -> None:
    path, run = recording
    box = opened(path)
    track = track_of(box)
    assert np.hypot(*(track[-1, :2] - run.final_pose[:2])) < 0.05 and len(track) > 80
    assert goals_of(box) == [(4.0, 0.0), (9.0, 3.0)]
    curves = {curve.label: curve for curve in velocities(box, 0)}
    assert set(curves) == {"asked of the drive", "given to the base", "driven"}
    way_m = float(np.sum(np.abs(curves["driven"].values[1:]) * np.diff(curves["driven"].t_s)))
    assert way_m == pytest.approx(run.distance_m, rel=0.05)
    assert np.nanmax(curves["given to the base"].values) <= np.nanmax(curves["asked of the drive"].values) + 1e-9


def test_complaints_and_leaves_stand_over_the_time_in_which_they_were_so(recording: tuple[Path, Run]) -> None:
    box = opened(recording[0])
    stale = [span for span in lane(verdicts(box), "filter") if span[2] == "laser-stale"]
    assert stale and 3.0 < stale[0][0] < 3.6 and 5.0 < stale[-1][1] < 5.6
    assert [name for name, _ in work(box, 9)] == ["out", "too far"]
    ((_, out_s, end),) = lane(work(box, 9), "out")
    assert end == "SUCCESS" and lane(work(box, 9), "too far") == [(out_s, pytest.approx(out_s + 1.5, abs=0.11), "")], "a halt is no end of its own"


def test_the_picture_has_every_panel(recording: tuple[Path, Run], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plot", str(recording[0]), "--output", str(tmp_path / "a.svg")]) == 0
    words = "".join(ElementTree.parse(tmp_path / "a.svg").getroot().itertext())  # matplotlib keeps the words in comments
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    for word in ("m.xml in hall", "FAILURE", "complaints", "laser-stale", "leaves", "too far", "given to the base", "time of the run (s)"):
        assert word in text, words
    assert main(["plot", str(recording[0]), "--world", "yard.xml", "--output", str(tmp_path / "a.png")]) == 0
    assert min(Image.open(tmp_path / "a.png").size) > 500


REFUSED = [
    (["plot", "{box}", "--output", "a.gif"], "--output does not write this format"),
    (["plot", "{box}", "--world", "nowhere.xml"], "no such world file"),
    (["plot", "none.mcap"], 'cannot read "none.mcap"'),
    (["export", "{box}", "--format", "csv"], "several topics make several tables"),
    (["export", "{box}", "--topic", "sick/scn"], 'did you mean "sick/scan"?'),
    (["export", "{box}", "--output", "nowhere/a.jsonl"], "the folder nowhere does not exist"),
    (["export", "{box}", "--format", "carmen", "--output", "a.txt"], "--output does not write this format"),
    (["record", "a.txt"], "FILE does not write this format"),
    (["record", "a.mcap", "--seconds", "-1"], "--seconds takes a number above 0"),
]


@pytest.mark.parametrize(("words", "told"), REFUSED)
def test_bad_requests_are_refused(words: list[str], told: str, recording: tuple[Path, Run], tmp_path: Path, monkeypatch: Any, capsys: Any) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([word.format(box=recording[0]) for word in words]) == 2
    assert told in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_json_has_every_message_and_csv_every_number(recording: tuple[Path, Run], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    box = opened(recording[0])
    assert main(["export", str(recording[0])]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert len(lines) == sum(1 for _ in box.file.lines())
    raw = box.samples(["ATRV2/Drive/Raw"])["ATRV2/Drive/Raw"]
    told = [line["value"]["velocity"][0] for line in lines if line["topic"] == "ATRV2/Drive/Raw"]
    assert told == [sample.value.velocity[0] for sample in raw if isinstance(sample.value, ActuatorState)]
    assert main(["export", str(recording[0]), "--format", "csv", "--output", str(tmp_path / "tables")]) == 0
    rows = list(csv.DictReader((tmp_path / "tables" / "ATRV2-Drive-Raw.csv").open(encoding="utf-8")))
    assert [float(row["velocity[0]"]) for row in rows] == told
    assert "sick-scan.csv" in {path.name for path in (tmp_path / "tables").iterdir()}


def test_xml_is_what_the_gateway_would_have_sent(recording: tuple[Path, Run], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", str(recording[0]), "--format", "xml", "--topic", "motion/status", "--topic", "events"]) == 0
    values = ElementTree.fromstring(capsys.readouterr().out)
    times = [float(value.get("stamp", "")) + float(value.get("age", "")) for value in values]
    assert times == sorted(times) and {value.get("topic") for value in values} == {"motion/status", "events"}


def test_a_log_of_carmen_has_the_scans_where_the_laser_was(recording: tuple[Path, Run], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The wall ahead of the robot stands at x = 12: what a scan's middle beam measured, laid where the line says that the laser was, ends there."""
    assert main(["export", str(recording[0]), "--format", "carmen", "--output", str(tmp_path / "a.log")]) == 0
    lines = [line.split() for line in (tmp_path / "a.log").read_text(encoding="utf-8").splitlines()]
    scans = [line for line in lines if line[0] == "FLASER"]
    assert len(scans) > 30 and [float(line[-1]) for line in lines] == sorted(float(line[-1]) for line in lines)
    for scan in scans:
        count = int(scan[1])
        ahead_m, (x, _, theta, *robot) = float(scan[2 + count // 2]), [float(word) for word in scan[2 + count : 8 + count]]
        if abs(theta) < 0.1:
            assert x + ahead_m * math.cos(theta) == pytest.approx(12.0, abs=0.1)
        assert math.hypot(robot[0] - x, robot[1]) < 1.0
    assert sum(line[0] == "ODOM" for line in lines) > 300
