"""Stories of following: behind a guide through a hall where somebody crosses, round a corner, and when there is nobody (any more)."""

from __future__ import annotations

import math
from typing import Any

import pytest

from pluto_bt.bench.guides import Guide
from pluto_bt.scenario import Play, Run

HALL = """<world name="hall" seed="1">
  <wall id="hall">-2,-6 20,-6 20,6 -2,6 -2,-6</wall> {parts}
  <robot platform="{platform}" x="0" y="0" theta_deg="0"/> {script}
</world>"""
GUIDE = '<actor id="guide" r="0.25" speed="0.45">3,0.5 3,0 12,0 14,3 14,5</actor>'
PASSER = '<actor id="passer" r="0.25" speed="0.9" loop="true">5,-4 5,4 9,4 9,-4</actor>'
POSTS = '<circle id="post" x="3" y="2.5" r="0.2"/> <polygon id="pillar">7,1.2 7.6,1.2 7.6,1.8 7,1.8</polygon>'
MISSION = """<root BTCPP_format="4"><BehaviorTree ID="T"><Follow distance_m="1.5" duration_s="{d}" max_speed_mps="0.7" reason="{why}"/></BehaviorTree>
<TreeNodesModel><SubTree ID="T"><input_port name="d" type="double" default="30.0"/></SubTree></TreeNodesModel></root>"""


@pytest.fixture
def follow(scenario: Play, tmp_path: Any) -> Any:
    """Follows in a hall with these things in it."""

    def play(parts: str, script: str = "", platform: str = "atrv2", **more: Any) -> Run:
        world, mission = tmp_path / "hall.xml", tmp_path / "follow.xml"
        world.write_text(HALL.format(parts=parts, script=f"<script>{script}</script>" if script else "", platform=platform), encoding="utf-8")
        mission.write_text(MISSION, encoding="utf-8")
        return scenario(str(world), mission=str(mission), max_time_s=90.0, **more)

    return play


@pytest.mark.parametrize(("platform", "seed"), [("atrv2", 1), ("atrv2", 2), ("pioneer", 3)])
def test_the_guide_is_followed_although_somebody_crosses_between(follow: Any, platform: str, seed: int) -> None:
    run = follow(GUIDE + PASSER + POSTS, platform=platform, seed=seed)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    x, y, _ = run.final_pose
    assert math.dist((x, y), (14.0, 4.4)) < 2.6 and x > 12.0, "near the end of the guide's way"


def test_round_a_corner_he_is_out_of_sight_and_found_again(follow: Any) -> None:
    corner = '<polygon id="block">4,1.2 9,1.2 9,6 4,6</polygon>'
    guide = '<actor id="guide" r="0.25" speed="0.75">3,0 10,0 10,3 17,3</actor>'
    run = follow(corner + guide, ports={"d": 28.0})
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    hidden = [point.t_s for point in run.track if is_hidden(point.pose, along(0.75 * point.t_s))]
    assert len(hidden) > 10, "for more than a second"
    assert math.dist(run.final_pose[:2], (17.0, 3.0)) < 2.4


def along(way_m: float) -> tuple[float, float]:
    """Where the guide is after so much way."""
    return (3.0 + way_m, 0.0) if way_m < 7.0 else (10.0, way_m - 7.0) if way_m < 10.0 else (min(way_m, 17.0), 3.0)


def is_hidden(robot: tuple[float, float, float], guide: tuple[float, float]) -> bool:
    """True if the block's corner at (9, 1.2) stands between robot and guide."""
    if not robot[0] < 9.0 < guide[0]:
        return False
    share = (9.0 - robot[0]) / (guide[0] - robot[0])
    return robot[1] + share * (guide[1] - robot[1]) > 1.2


@pytest.mark.parametrize(("seed", "others", "platform"), [(104, 0, "pioneer"), (105, 1, "atrv2"), (106, 2, "pioneer")])
def test_a_guide_nobody_chose_is_followed_round_sharp_turns_between_others_to_where_he_stops(
    scenario: Play, tmp_path: Any, seed: int, others: int, platform: str
) -> None:
    guide = Guide.make(seed, platform, others)
    world, mission = tmp_path / "hall.xml", tmp_path / "follow.xml"
    world.write_text(guide.text, encoding="utf-8")
    body = f'<Follow distance_m="1.5" duration_s="{guide.lasts_s + 6.0:.1f}" max_speed_mps="0.9"/>'
    mission.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="T">{body}</BehaviorTree></root>', encoding="utf-8")
    run = scenario(str(world), mission=str(mission), max_time_s=120.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert math.dist(run.final_pose[:2], guide.way[-1]) < 2.6, "it stands before the guide, who has stopped"
    assert guide.near_share([(point.t_s, point.pose) for point in run.track], 4.0) > 0.85


def test_one_who_stops_behind_a_corner_is_found_standing_there(follow: Any) -> None:
    corner = '<polygon id="block">4,1.2 9,1.2 9,6 4,6</polygon>'
    run = follow(corner + '<actor id="guide" r="0.25" speed="0.75">3,0 10,0 10,2.6</actor>', ports={"d": 26.0})
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert math.dist(run.final_pose[:2], (10.0, 2.6)) < 2.2


def test_a_guide_who_vanishes_is_given_up(follow: Any) -> None:
    run = follow(GUIDE, script='<at t="12"><remove id="guide"/></at>')
    assert (run.result, run.reason, run.collisions) == ("FAILURE", "target-lost", 0)
    assert run.sim_time_s == pytest.approx(20.0, abs=2.0)


def test_where_nobody_moves_there_is_no_object(follow: Any) -> None:
    run = follow(POSTS)
    assert (run.result, run.reason) == ("FAILURE", "no-object")
    assert run.distance_m < 0.01


def test_a_robot_without_a_laser_says_so(follow: Any) -> None:
    assert follow(GUIDE, platform="jbot").reason == "no-device"
