"""Stories of narrow places: a door that is just wide enough is passed, one that is not is told with its width, and who is in a slot backs out."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from pluto_bt.scenario import Play, Run

DOOR = """<world name="door" seed="{seed}"><wall id="rim">0,0 14,0 14,8 0,8 0,0</wall><wall id="low">{low}</wall><wall id="high">{high}</wall>
  <robot platform="{platform}" x="1.7" y="1.6" theta_deg="90"/></world>"""
SLOT = """<world name="slot" seed="{seed}"><wall id="rim">0,0 12,0 12,6 0,6 0,0</wall>
  <wall id="s1">5,0 5,{low} 11,{low}</wall><wall id="s2">5,6 5,{high} 11,{high}</wall><wall id="end">11,{low} 11,{high}</wall>
  <robot platform="{platform}" x="{x}" y="3" theta_deg="{theta_deg}"/></world>"""
MISSION = '<root BTCPP_format="4"><BehaviorTree ID="main">{}</BehaviorTree></root>'


def door(width_m: float, platform: str, seed: int, foot_x: float, head_x: float) -> str:
    """Two rooms with a wall from (foot_x, 0) to (head_x, 8), and a door in it whose place hangs on the seed."""
    length_m = math.hypot(head_x - foot_x, 8.0)
    shares = [(0.5 + 0.016 * seed) + side * 0.5 * width_m / length_m for side in (-1.0, 1.0)]
    jambs = [f"{foot_x + share * (head_x - foot_x):.3f},{8.0 * share:.3f}" for share in shares]
    return DOOR.format(seed=seed, platform=platform, low=f"{foot_x},0 {jambs[0]}", high=f"{jambs[1]} {head_x},8")


def slot(width_m: float, platform: str, x: float, theta_deg: float, seed: int = 1) -> str:
    """A room with a slot of 6 m in its east, closed at its end."""
    return SLOT.format(seed=seed, platform=platform, x=x, theta_deg=theta_deg, low=3.0 - 0.5 * width_m, high=3.0 + 0.5 * width_m)


def play(scenario: Play, folder: Path, body: str, world: str) -> Run:
    (folder / "mission.xml").write_text(MISSION.format(body), encoding="utf-8")
    (folder / "world.xml").write_text(world, encoding="utf-8")
    return scenario(str(folder / "world.xml"), mission=str(folder / "mission.xml"), max_time_s=250.0)


@pytest.mark.parametrize("seed", [0, 1, 4])
@pytest.mark.parametrize(("foot_x", "head_x"), [(6.0, 6.0), (4.6, 7.6), (8.5, 3.5)], ids=["straight", "oblique", "slanting"])
def test_moveto_takes_a_door_that_leaves_the_robot_its_margin(scenario: Play, tmp_path: Path, foot_x: float, head_x: float, seed: int) -> None:
    run = play(scenario, tmp_path, '<MoveTo goal="11.5;6" timeout_s="200"/>', door(1.35, "atrv2", seed, foot_x, head_x))
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert run.sim_time_s < 70.0


@pytest.mark.parametrize("width_m", [0.8, 1.0])
def test_moveto_says_how_wide_the_widest_gap_is_and_how_wide_it_has_to_be(scenario: Play, tmp_path: Path, width_m: float) -> None:
    run = play(scenario, tmp_path, '<MoveTo goal="11.5;6" timeout_s="200"/>', door(width_m, "atrv2", 2, 6.0, 6.0))
    assert (run.result, run.reason) == ("FAILURE", "no-path"), run.text
    words = run.text.split("the widest gap on the way, at ")[1]
    x_m, y_m = (float(part) for part in words.split(",")[0].split(";"))
    told_m = float(words.split("is about ")[1].split(" m wide")[0])
    assert math.dist((x_m, y_m), (6.0, 8.0 * 0.532)) < 0.7 and abs(told_m - width_m) < 0.21, run.text
    assert "the robot takes one of 1.35 m" in run.text


@pytest.mark.parametrize(
    ("platform", "width_m", "x", "theta_deg"),
    [("atrv2", 1.3, 10.25, 3.0), ("atrv2", 1.2, 10.25, -3.0), ("pioneer", 0.65, 10.25, 3.0)],
)
def test_goto_backs_out_of_a_slot_in_which_the_robot_was_started(
    scenario: Play, tmp_path: Path, platform: str, width_m: float, x: float, theta_deg: float
) -> None:
    run = play(scenario, tmp_path, '<GoTo goal="2;3.4" timeout_s="200"/>', slot(width_m, platform, x, theta_deg))
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert run.distance_m < 9.5, "straight out, and on"
    headings = [point.pose[2] for point in run.track if point.pose[0] > 6.0]
    assert max(abs(heading) for heading in headings) < math.radians(20.0), "inside it only backs"


@pytest.mark.parametrize(("platform", "width_m"), [("atrv2", 1.3), ("pioneer", 0.7)])
def test_goto_backs_out_of_a_slot_into_which_it_has_driven(scenario: Play, tmp_path: Path, platform: str, width_m: float) -> None:
    body = '<Sequence><GoTo goal="10;3" timeout_s="100"/><GoTo goal="2;3.4" timeout_s="100"/></Sequence>'
    run = play(scenario, tmp_path, body, slot(width_m, platform, 2.0, 0.0))
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert run.distance_m < 17.5


def test_a_robot_that_is_blind_behind_does_not_back_where_it_never_was(scenario: Play, tmp_path: Path) -> None:
    run = play(scenario, tmp_path, '<GoTo goal="2;3.4" timeout_s="200"/>', slot(0.75, "jbot", 10.25, 0.0))
    assert (run.result, run.reason, run.collisions) == ("FAILURE", "stuck", 0), run.text
    assert math.dist(run.final_pose[:2], run.estimated_pose[:2]) < 0.3, "it knows where it is"


@pytest.mark.parametrize(("platform", "width_m"), [("atrv2", 1.3), ("pioneer", 0.65)])
def test_escape_is_free_only_where_it_can_turn_round(scenario: Play, tmp_path: Path, platform: str, width_m: float) -> None:
    run = play(scenario, tmp_path, '<SubTree ID="Escape"/>', slot(width_m, platform, 10.25, 0.0))
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert run.final_pose[0] < 5.2, "out of the slot"
