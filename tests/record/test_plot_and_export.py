"""A black box in other forms: as a picture, as tables, as a log of CARMEN; and what somebody writes down who listens from outside."""

from __future__ import annotations

import csv
import gzip
import json
import math
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from drivers.carmen_log import BadLine, Odometry, Scan, read_log
from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.cli import main
from pluto_bt.commands.boxes import read_box
from pluto_bt.record.box import Box, open_box
from pluto_bt.record.curves import VELOCITIES, Lane, goals_of, seen_of, track_of, velocities, verdicts, work
from pluto_bt.scenario import Play, Run
from pluto_bt.source import Faults
from tests.shared_data import shared_file

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
    curves = {VELOCITIES[curve.topic]: curve for curve in velocities(box, 0)}
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


def test_a_log_of_carmen_is_read_as_it_was_written(recording: tuple[Path, Run], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log, box = tmp_path / "a.log", opened(recording[0])
    assert main(["export", str(recording[0]), "--format", "carmen", "--output", str(log)]) == 0
    (tmp_path / "b.log.gz").write_bytes(gzip.compress(log.read_bytes()))
    again = read_box(str(tmp_path / "b.log.gz"), needs_ticks=False)
    scans, before = ([sample.value for sample in one.samples(["sick/scan"])["sick/scan"]] for one in (again, box))
    begin_s = float(log.read_text(encoding="utf-8").split(maxsplit=8)[7])
    assert len(scans) > 30
    for scan in scans:
        was = next(one for one in before if one.stamp_s == pytest.approx(scan.stamp_s + begin_s, abs=1e-5))
        assert np.allclose(scan.ranges_m, was.ranges_m, atol=6e-4) and scan.angle_step_rad == pytest.approx(was.angle_step_rad, rel=0.01)
    assert np.hypot(*(track_of(again)[-1, :2] - track_of(box)[-1, :2])) < 0.5, "the laser stands ahead of the robot's middle"
    assert np.percentile(np.abs(seen_of(again)[:, 0]), 99) < 12.2, "what was seen is the hall"
    for command in (["info"], ["plot"], ["export", "--topic", "sick/scan", "--format", "csv"]):
        assert main([command[0], str(log), *command[1:]]) == 0
    assert main(["replay", str(log)]) == 2 and "topics, but no ticks" in capsys.readouterr().err


LINES = [
    ("ODOM 1 2 0.5 0.25 0.1 0 10.5 host 0.5", Odometry(10.5, (1.0, 2.0, 0.5), (0.25, 0.1))),
    ("FLASER 3 1 2 81.83 4 5 0.5 6 7 0.25 11 host 1", Scan(11.0, -math.pi / 2, math.pi / 2, (1.0, 2.0, 81.83), (4.0, 5.0, 0.5), (6.0, 7.0, 0.25))),
    ("FLASER 180" + 180 * " 1" + " 0 0 0 0 0 0 11 host 1", Scan(11.0, -math.pi / 2, math.radians(1), 180 * (1.0,), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))),
    ("ROBOTLASER1 0 -1.5 3 0.75 50 0.01 0 2 1.5 2.5 1 9 1 2 3 4 5 6 0.3 0.1 0 0 0 12 host 2",
     Scan(12.0, -1.5, 0.75, (1.5, 2.5), (1.0, 2.0, 3.0), (4.0, 5.0, 6.0))),
    ("PARAM robot_max_t_vel 0.5 nohost 0", None),
    ("# message formats defined: PARAM SYNC ODOM FLASER", None),
    ("", None),
    ("ODOM 1 2 0.5 0.25 0.1 10.5 host 0.5", BadLine(1, "ODOM with x y theta tv rv accel, time, host, time", "5 numbers in place of 6")),
    ("ODOM 1 2 x 0 0 0 10.5 host 0.5", BadLine(1, "ODOM with x y theta tv rv accel, time, host, time", "could not convert string to float: 'x'")),
    ("FLASER 9999999999 1", BadLine(1, "FLASER with n, n ranges, two poses, time, host, time", "9999999999 beams")),
    ("FLASER", BadLine(1, "FLASER with n, n ranges, two poses, time, host, time", "0 words")),
    ("ODOM nan 2 0.5 0.25 0.1 0 10.5 host 0.5", BadLine(1, "ODOM with x y theta tv rv accel, time, host, time", "a number that is not finite")),
]  # fmt: skip


@pytest.mark.parametrize(("line", "record"), LINES)
def test_lines_of_carmen(line: str, record: object) -> None:
    (found,) = [*read_log([line])] or [None]
    if isinstance(found, Scan) and isinstance(record, Scan):
        assert found.angle_step_rad == pytest.approx(record.angle_step_rad)
        found = found._replace(angle_step_rad=record.angle_step_rad)
    assert found == record


def test_a_bad_log_is_told_line_by_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.log").write_text("ODOM 1 2 0 0 0 0 5 h 5\nODOM 1\nODOM 3 2 0 0 0 0 4 h 4\n", encoding="utf-8")
    assert main(["info", str(tmp_path / "a.log")]) == 0
    out, err = capsys.readouterr()
    assert "a.log:2:1: warning: this line of the log makes no sense" in err and "Localization/Dead-Reckoning" in out
    (tmp_path / "b.log").write_text("hello\n", encoding="utf-8")
    (tmp_path / "c.log.gz").write_text("hello\n", encoding="utf-8")
    for name, told in (("b.log", "is no log of CARMEN"), ("c.log.gz", "cannot read"), ("none.log", "cannot read")):
        assert main(["plot", str(tmp_path / name)]) == 2
        assert told in capsys.readouterr().err


def test_logs_of_real_robots_are_read(capsys: pytest.CaptureFixture[str]) -> None:
    for path in sorted(shared_file("data", "carmen_corrected").glob("*.gz"))[:2]:
        assert main(["info", str(path), "--json"]) == 0
        facts = json.loads(capsys.readouterr().out)
        assert facts["topics"]["sick/scan"]["messages"] > 100 and facts["topics"]["Localization/Dead-Reckoning"]["messages"] > 1000
