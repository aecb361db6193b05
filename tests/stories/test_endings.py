"""A mission that cannot go on ends in the promised time (`WAITING`) with the right word, whatever job it is at; what passes ends nothing."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from pluto_bt.behaviours.reasons import OUTAGE_S, WAITING
from pluto_bt.record.box import open_box
from pluto_bt.scenario import Play, Run
from pluto_bt.source import Faults
from pluto_bt.trees.why_box import why_at

COURT = """<world name="court" seed="1"><wall id="fence">0,0 24,0 24,14 0,14 0,0</wall>
  <polygon id="shed">9,3.5 11.5,3.5 11.5,6 9,6</polygon> <circle id="drum" x="6.5" y="9.8" r="0.45"/> {more}
  <robot name="pluto" x="3" y="{y}"/> <script><at t="{at_s}">{fault}</at></script></world>"""
PERSON = '<actor id="person" r="0.25" speed="0.4" loop="true">5,7 15,7 15,11 5,11</actor>'
JOBS = {
    "moveto": '<MoveTo goal="20;3"/>', "explore": '<Explore rectangle="5;18"/>', "investigate": '<Investigate radius_m="2"/>',
    "wall follow": '<WallFollow side="left" length_m="40"/>', "follow": '<Follow duration_s="60"/>', "navigate": '<NavigateTo goal="20;3"/>',
    "goto": '<GoTo goal="20;8"/>',
}  # fmt: skip
NOTICE_S = 1.0  # till a sensor is found to be too old, a position lost, and so on
LOOKING_S, DRIVING_S = 2.0, 10.0  # moveto and explore look around at first; then they drive


def fault(device: str, kind: str, more: str = "") -> str:
    return f'<fault device="{device}" kind="{kind}" {more}/>'


FAULTS = {  # what breaks for ever → the word with which it ends, and for how long it is waited beyond `WAITING`
    "laser off": (fault("laser", "off"), "laser-stale", 0.0), "laser stuck": (fault("laser", "stuck"), "laser-stale", 0.0),
    "laser NaN": (fault("laser", "nan"), "laser-stale", 0.0), "laser 400 ms late": (fault("laser", "late", 'delay="0.4"'), "laser-stale", 0.0),
    "sonar off": (fault("sonar", "off"), "sonar-stale", 0.0), "bumpers off": (fault("bumpers", "off"), "bumper-stale", 0.0),
    "bumper stuck": (fault("bumpers", "stuck", 'value="1"'), "bumper", 0.0), "odometry frozen": (fault("odometry", "frozen"), "no-pose", 0.0),
    "no localisation": (fault("module:local", "off"), "no-pose", 0.0), "base blocked": (fault("base", "blocked"), "odometry-frozen", 0.5),
    "avoidance gone": (fault("module:avoid", "off"), "chain-stopped", 0.0), "wrist silent": (fault("wrist", "off"), "wrist-stale", 1.0),
    "kidnapped": ('<place id="pluto" x="21" y="11.5" theta_deg="130"/>', "lost", 2.0),
}  # fmt: skip
AT_REST_TOO = ("laser off", "laser stuck", "laser NaN", "laser 400 ms late", "wrist silent", "bumper stuck", "bumpers off", "no localisation",
               "kidnapped")  # fmt: skip
CASES = [
    *(("moveto", name, DRIVING_S) for name in FAULTS),
    *(("explore", name, DRIVING_S) for name in ("laser NaN", "wrist silent", "bumper stuck", "base blocked", "kidnapped")),
    *(("moveto", name, LOOKING_S) for name in AT_REST_TOO),
    *((job, name, LOOKING_S) for job in ("explore", "investigate") for name in ("laser off", "wrist silent", "kidnapped")),
    *((job, name, DRIVING_S) for job in ("wall follow", "follow", "navigate", "goto") for name in ("laser off", "no localisation")),
]  # fmt: skip


@pytest.fixture
def play(scenario: Play, tmp_path: Path) -> Callable[..., Run]:
    """Plays a job in the court, where something happens at a time."""

    def play(job: str, happens: str, at_s: float, max_time_s: float, record: Path | None = None) -> Run:
        more = PERSON if job == "follow" else ""
        world = COURT.format(more=more, y=12 if job == "wall follow" else 7, at_s=at_s, fault=happens)
        (tmp_path / "court.xml").write_text(world, encoding="utf-8")
        (tmp_path / "m.xml").write_text(f'<root BTCPP_format="4"><BehaviorTree ID="m">{JOBS[job]}</BehaviorTree></root>', encoding="utf-8")
        return scenario(tmp_path / "court.xml", mission=tmp_path / "m.xml", max_time_s=max_time_s, record=record)

    return play


@pytest.mark.parametrize(("job", "name", "at_s"), CASES, ids=[f"{job}, {name} at {at_s:g} s" for job, name, at_s in CASES])
def test_what_no_second_try_can_cure_ends_a_job_at_once_with_its_word(play: Callable[..., Run], job: str, name: str, at_s: float) -> None:
    happens, word, longer_s = FAULTS[name]
    limit_s = at_s + WAITING[word] + NOTICE_S + longer_s
    run = play(job, happens, at_s, limit_s + 1.0)
    assert (run.result, run.reason) == ("FAILURE", word), run.text
    assert run.sim_time_s <= limit_s and run.collisions == 0


OUTAGES = [*((job, DRIVING_S, OUTAGE_S) for job in JOBS), ("moveto", LOOKING_S, OUTAGE_S), ("goto", DRIVING_S, OUTAGE_S - 0.15)]


@pytest.mark.parametrize(("job", "at_s", "for_s"), OUTAGES)
def test_an_outage_of_the_laser_that_passes_in_time_ends_no_job(play: Callable[..., Run], job: str, at_s: float, for_s: float) -> None:
    run = play(job, fault("laser", "off", f'for="{for_s}"'), at_s, at_s + 14.0)
    assert (run.result, run.reason, run.collisions) == ("STOPPED", "max-time", 0), run.text
    meanwhile, later = (run.at(at_s + 1.5), run.at(at_s + for_s)), run.at(at_s + 14.0)
    assert meanwhile[0].distance_to(*meanwhile[1].pose[:2]) < 0.01, "it stands while it is blind"
    assert job == "investigate" or meanwhile[1].distance_to(*later.pose[:2]) > 0.3, "and then drives on"


@pytest.mark.parametrize("job", ["moveto", "wall follow", "follow", "goto"])
def test_an_outage_that_lasts_longer_ends_every_job_alike(play: Callable[..., Run], job: str) -> None:
    run = play(job, fault("laser", "off", f'for="{OUTAGE_S + 3.0}"'), DRIVING_S, 40.0)
    assert (run.result, run.reason) == ("FAILURE", "laser-stale"), run.text
    assert run.sim_time_s - DRIVING_S == pytest.approx(WAITING["laser-stale"], abs=NOTICE_S)


@pytest.mark.parametrize("device", ["sonar", "bumpers"])
def test_the_same_limit_holds_for_the_other_sensors(play: Callable[..., Run], device: str) -> None:
    run = play("goto", fault(device, "off", f'for="{OUTAGE_S}"'), DRIVING_S, DRIVING_S + 10.0)
    assert (run.result, run.reason) == ("STOPPED", "max-time"), run.text


def test_a_laser_that_reboots_lets_follow_look_for_its_target_afterwards(play: Callable[..., Run]) -> None:
    run = play("follow", fault("laser", "fatal", 'for="6"'), DRIVING_S, DRIVING_S + 20.0)
    assert run.reason == "max-time", "in 6 s nobody is lost who cannot be seen"


def test_a_look_around_waits_for_a_pose_that_comes_back_and_goes_on(play: Callable[..., Run]) -> None:
    run = play("moveto", fault("module:local", "off", 'for="2"'), LOOKING_S, 16.0)
    assert run.reason == "max-time", run.text
    assert run.at(16.0).distance_to(3.0, 7.0) > 0.5


def test_why_tells_for_what_a_job_stands_while_it_looks_around(play: Callable[..., Run], tmp_path: Path) -> None:
    play("moveto", fault("wrist", "off"), LOOKING_S, LOOKING_S + 3.0, record=tmp_path / "a.mcap")
    box = open_box(tmp_path / "a.mcap", "a.mcap", Faults())
    first = None if box is None else why_at(box, LOOKING_S + 2.0).first
    assert first is not None and (first.layer, first.code) == ("sensor", "wrist-stale")
    assert "the wrist is silent" in first.text and "wrist" in first.unblock


LANE = """<world name="lane" seed="1"><wall id="lane">0,0 12,0 12,7 0,7 0,0</wall> <polygon id="sill" height="0.04">7,3 7.3,3 7.3,5 7,5</polygon>
  <robot platform="atrv2" x="3" y="4"/><script>{script}</script></world>"""
INTO_IT = """<root BTCPP_format="4" main_tree_to_execute="m"><BehaviorTree ID="m"><Sequence>
  <Inverter><DriveVelocity speed_mps="{speed}" distance_m="10" reason="{{why}}"/></Inverter> <SubTree ID="FreeBumper"/>
</Sequence></BehaviorTree></root>"""


def test_explore_backs_off_what_only_the_bumper_feels_and_explores_the_rest(scenario: Play, tmp_path: Path) -> None:
    (tmp_path / "lane.xml").write_text(LANE.format(script=""), encoding="utf-8")
    mission = '<root BTCPP_format="4"><BehaviorTree ID="m"><Explore rectangle="3;8.5"/></BehaviorTree></root>'
    (tmp_path / "m.xml").write_text(mission, encoding="utf-8")
    run = scenario(tmp_path / "lane.xml", mission=tmp_path / "m.xml", max_time_s=400.0)
    assert (run.result, run.reason) == ("SUCCESS", ""), run.text
    assert 1 <= run.collisions <= 4 and run.at(run.sim_time_s).distance_to(3.0, 4.0) < 0.6, "it ran into the sill, and came home all the same"


STUCK = '<at t="3"><fault device="bumpers" kind="stuck" value="1"/></at>'


@pytest.mark.parametrize(("script", "speed", "result"), [("", 0.4, "SUCCESS"), (STUCK, 0.4, "FAILURE")], ids=["a sill", "a panel that sticks"])
def test_the_tree_that_frees_a_bumper_says_whether_it_did(scenario: Play, tmp_path: Path, script: str, speed: float, result: str) -> None:
    (tmp_path / "lane.xml").write_text(LANE.format(script=script), encoding="utf-8")
    (tmp_path / "m.xml").write_text(INTO_IT.format(speed=speed), encoding="utf-8")
    run = scenario(tmp_path / "lane.xml", mission=tmp_path / "m.xml", max_time_s=60.0)
    assert (run.result, run.blackboard["why"]) == (result, "bumper"), run.text
    assert result == "FAILURE" or run.final_pose[0] < 6.2, "0.4 m back from the sill"
