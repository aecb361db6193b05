"""Each fault of the list with its outcome: what becomes of the mission, how soon the robot is told to stand, which word is given."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from pluto_bt.bench.fault_plays import Play
from pluto_bt.bench.faults import play_pair
from pluto_bt.bench.why_score import ASKED_AFTER_S
from pluto_bt.blackboard.codes import LinkStatus, Setter
from pluto_bt.blackboard.messages import Pose
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.record.box import open_box
from pluto_bt.runner import Runner
from pluto_bt.source import Faults
from pluto_bt.trees.why_box import why_at
from tests.fault_cases import CASES, GOES_ON, HALL, T_S, FaultCase

GOAL = (4.0, 0.5)
SUCCESS_WITHIN_M = 0.8  # of the true goal: tolerance 0.3 m, and what is not put right


def played(case: FaultCase, folder: Path) -> Play:
    script = f'<at t="{T_S:g}">{case.script}</at>'
    (folder / "hall.xml").write_text(HALL.format(platform=case.platform, script=script), encoding="utf-8")
    ports = [f"goals={GOAL[0]},{GOAL[1]}", "timeout_s=60"]
    return Play(read_inputs(Request("patrol.xml", world=str(folder / "hall.xml"), port=ports)), max_time_s=120.0, record=folder / "a.mcap")


def first_cause(folder: Path, at_s: float | None) -> str:
    """The code of the first cause that `why` gives for the recorded run."""
    box = open_box(folder / "a.mcap", "a.mcap", Faults())
    first = None if box is None else why_at(box, at_s).first
    return "" if first is None else first.code


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_a_fault_has_the_outcome_that_stands_beside_it(case: FaultCase, tmp_path: Path) -> None:
    play = played(case, tmp_path)
    result = play.result
    assert f"{result.result} {result.reason}".strip() == case.outcome, result.text
    assert play.complaints(SUCCESS_WITHIN_M) == []
    assert case.zero_within_s == GOES_ON or play.zero_after_s(T_S) <= case.zero_within_s
    assert not case.said or case.said in play.words or case.said in [event.code for event in play.events]
    if result.result == "SUCCESS":
        assert math.dist(result.final_pose[:2], GOAL) < SUCCESS_WITHIN_M, "and it is really there"
    if case.asked:
        assert first_cause(tmp_path, T_S + ASKED_AFTER_S if result.result == "SUCCESS" else None) == case.asked


def test_a_fatal_laser_shows_status_7_and_the_mission_only_waits(tmp_path: Path) -> None:
    case = next(case for case in CASES if case.name.startswith("laser fatal"))
    play = played(case, tmp_path)
    assert T_S < play.codes[LinkStatus.LASER_FATAL] < T_S + 0.6
    standing = [point for point in play.runner.system.track.points if T_S + 2.0 < point.t_s < T_S + 19.0]
    assert math.dist(standing[0].pose[:2], standing[-1].pose[:2]) < 0.01


@pytest.mark.parametrize("seed", range(100, 108))
def test_two_faults_at_once_in_a_place_drawn_at_random_do_no_harm_and_are_told(seed: int) -> None:
    pair = play_pair(seed)
    assert pair.complaints == [], pair.text
    assert [one.text for one in pair.asked if not one.is_right] == [], pair.text


def told_where_it_is(script: str, at_s: float, off_m: float, folder: Path) -> Play:
    """A patrol whose pose is posted at `at_s`: where it really is, and `off_m` to its left."""

    def tell(runner: Runner) -> None:
        system, done = runner.system, list[bool]()

        def post() -> None:
            if system.simulator.time_s < at_s or done:
                return
            done.append(True)
            x, y, theta = system.simulator.pose
            x, y = x - off_m * math.sin(theta), y + off_m * math.cos(theta)
            assert system.context.posts.post("somebody", Pose(at_s, (x, y, 0.0, theta, 0.0, 0.0), setter=Setter.JUST_SET)) == ""

        system.board.on_change("world/state", post)

    (folder / "hall.xml").write_text(HALL.format(platform="atrv2", script=script), encoding="utf-8")
    ports = [f"goals={GOAL[0]},{GOAL[1]}", "timeout_s=60"]
    return Play(read_inputs(Request("patrol.xml", world=str(folder / "hall.xml"), port=ports)), max_time_s=120.0, before=tell)


@pytest.mark.parametrize("off_m", [0.0, -2.0, 0.8])
def test_a_pose_that_jumps_is_believed_and_nothing_is_touched(off_m: float, tmp_path: Path) -> None:
    """Whoever posts poses is trusted: it drives on to the goal as it now believes it to lie, if that is not in the wall."""
    play = told_where_it_is("", 6.0, off_m, tmp_path)
    assert play.complaints(abs(off_m) + 0.2) == []
    believed = play.result.estimated_pose
    assert play.result.result == "SUCCESS" and believed is not None and math.dist(believed[:2], GOAL) < 0.4


def test_a_kidnapped_robot_that_is_told_where_it_is_goes_on(tmp_path: Path) -> None:
    play = told_where_it_is(f'<at t="{T_S:g}"><place id="pluto" x="-3" y="-2.5" theta_deg="70"/></at>', T_S + 2.0, 0.0, tmp_path)
    assert play.result.result == "SUCCESS", play.result.text
    assert math.dist(play.result.final_pose[:2], GOAL) < SUCCESS_WITHIN_M
    assert [event.code for event in play.events if event.code in ("lost", "found")] == ["lost", "found"]
    assert "lost" in play.words
