"""Stories of WallFollow: round houses, inside rooms, past doors, between people; and how a camera keeps its distance from the wall."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pluto_bt.bench.buildings import Building, camera_path, distances, kept
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.scenario import Play, Run
from tests.shared_data import shared_file

MISSION = '<root BTCPP_format="4"><BehaviorTree ID="main"><WallFollow {ports} reason="{{why}}"/></BehaviorTree></root>'
LONG = '<world name="long" seed="1">{more}<robot platform="{platform}" x="2" y="{y}" theta_deg="0"/>{script}</world>'
WALL = '<wall id="w">-5,0 40,0</wall>'


@pytest.fixture
def along(scenario: Play, tmp_path: Path) -> Any:
    """Follows a wall in a world given as text or by name."""

    def play(world: str, ports: str, **more: Any) -> Run:
        (tmp_path / "mission.xml").write_text(MISSION.format(ports=ports), encoding="utf-8")
        if world.startswith("<"):
            (tmp_path / "world.xml").write_text(world, encoding="utf-8")
            world = str(tmp_path / "world.xml")
        return scenario(world, mission=str(tmp_path / "mission.xml"), **more)

    return play


def long(more: str = WALL, platform: str = "atrv2", y: float = -1.6, script: str = "") -> str:
    return LONG.format(more=more, platform=platform, y=y, script=f"<script>{script}</script>" if script else "")


def camera_m(run: Run, platform: str = "atrv2", side: float = 1.0, edges: Any = ((-5.0, 0.0, 40.0, 0.0),)) -> Any:
    """The camera's true distance from the edges along the track."""
    wall = load_robot_file(platform).wall
    return distances(camera_path([point.pose for point in run.track], wall.camera_back_m, side * wall.camera_side_m), np.array(edges))[0]


@pytest.mark.parametrize("seed", [501, 502, 508])  # pioneer outside on the right, atrv2 inside on the right, atrv2 outside
def test_once_around_a_building_nobody_chose(along: Any, seed: int) -> None:
    building, platform, side = Building.for_seed(seed)
    run = along(building.text, f'side="{side}" length_m="{1.15 * building.way_m:.1f}"')
    assert (run.result, run.collisions, run.hit_by) == ("SUCCESS", 0, 0), run.text
    wall = load_robot_file(platform).wall
    keeps = kept(run.track, wall, side, building.edges, wall.distance_m)
    assert keeps.straight_m <= 0.15 and keeps.straight_share > 0.05
    assert keeps.corner_m <= 0.4
    headings = np.unwrap([point.pose[2] for point in run.track])
    assert abs(headings[-1] - headings[0]) > 0.75 * math.tau, "all the way around"


@pytest.mark.parametrize(
    ("platform", "side", "distance_m", "speed_mps"), [("atrv2", "left", 1.2, 0.9), ("atrv2", "right", 0.4, 0.5), ("pioneer", "left", 0.9, 1.2)]
)
def test_distance_side_and_speed_are_those_of_the_ports(along: Any, platform: str, side: str, distance_m: float, speed_mps: float) -> None:
    sign = 1.0 if side == "left" else -1.0
    ports = f'side="{side}" distance_m="{distance_m}" max_speed_mps="{speed_mps}" length_m="16"'
    run = along(long(platform=platform, y=-1.6 * sign), ports)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    there = [abs(away - distance_m) for point, away in zip(run.track, camera_m(run, platform, sign), strict=True) if point.pose[0] > 6.0]
    assert max(there) < 0.15
    fastest_mps = max(math.dist(a.pose[:2], b.pose[:2]) / (b.t_s - a.t_s) for a, b in zip(run.track, run.track[10:], strict=False) if b.t_s > a.t_s)
    assert 0.9 * speed_mps < fastest_mps < 1.05 * speed_mps


def test_the_wall_is_passed_over_doors_and_followed_round_its_thin_end(along: Any) -> None:
    pieces = [(0.0, 5.0), (6.4, 9.0), (9.9, 14.0)]
    run = along(long("".join(f'<wall id="w{i}">{a},0 {b},0</wall>' for i, (a, b) in enumerate(pieces))), 'length_m="25"')
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert max(point.pose[0] for point in run.track) > 15.0 and run.final_pose[1] > 0.5, "to the other side"
    near = camera_m(run, edges=[(a, 0.0, b, 0.0) for a, b in pieces])[60:]
    assert min(near) > 0.55 and max(near) < 1.25


def test_the_node_turns_the_wrist_to_the_wall_and_back(along: Any, tmp_path: Path, scenario: Play) -> None:
    mission = """<root BTCPP_format="4"><BehaviorTree ID="main"><Sequence>
      <Parallel success_count="2">
        <WallFollow side="right" length_m="3"/>
        <WaitFor topic="wrist/state" field="position.0" is="&lt;" value="-0.6" timeout_s="5"/>
      </Parallel>
      <WaitFor topic="wrist/state" field="position.0" is="&gt;" value="-0.05" timeout_s="5"/> </Sequence></BehaviorTree></root>"""
    (tmp_path / "wrist.xml").write_text(mission, encoding="utf-8")
    (tmp_path / "long.xml").write_text(long(y=1.6), encoding="utf-8")
    run = scenario(str(tmp_path / "long.xml"), mission=str(tmp_path / "wrist.xml"))
    assert run.result == "SUCCESS", run.text


@pytest.mark.parametrize(
    ("more", "ports", "reason"),
    [
        ("", 'length_m="5"', "no-wall"),
        (WALL, 'length_m="5" avoid="none"', "no-wall"),
        ('<wall id="a">0,-1.1 5,-1.1</wall><wall id="b">0,-2.1 5,-2.1</wall>', 'length_m="5"', "no-wall"),  # no room beside it
    ],
    ids=["none in reach", "no sensor is asked", "no room"],
)
def test_it_says_when_there_is_no_wall_to_follow(along: Any, more: str, ports: str, reason: str) -> None:
    run = along(long(more), ports)
    assert (run.result, run.reason, run.blackboard["why"]) == ("FAILURE", reason, reason), run.text
    assert run.distance_m < 0.05 and run.sim_time_s < 12.0


def test_a_wall_that_is_taken_away_is_lost(along: Any) -> None:
    run = along(long(script='<at t="12"><remove id="w"/></at>'), 'length_m="50"')
    assert (run.result, run.reason, run.collisions) == ("FAILURE", "wall-lost", 0), run.text
    assert run.sim_time_s < 25.0


def test_a_robot_that_sees_nothing_says_so(along: Any) -> None:
    run = along(long('<area id="m" kind="map">-5,-9 40,-9 40,9 -5,9</area>', platform="car"), "")
    assert (run.result, run.reason) == ("FAILURE", "no-device")


def test_who_comes_along_the_wall_is_awaited_and_then_it_goes_on(along: Any) -> None:
    people = '<actor id="one" r="0.25" speed="0.7" loop="true">16,-2.7 4,-2.7</actor>'
    people += '<actor id="two" r="0.25" speed="0.6" loop="true">9,-6 9,-0.6</actor>'
    run = along(long(WALL + people), 'length_m="20"')
    assert run.result == "SUCCESS", run.text
    assert run.collisions == 0


def test_the_rooms_of_the_office_are_not_entered_from_the_corridor(along: Any) -> None:
    run = along("office.xml", 'length_m="33"', platform="pioneer")
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert all(5.0 < point.pose[1] < 8.0 for point in run.track)
    assert math.dist(run.final_pose[:2], run.track[0].pose[:2]) < 4.0, "once around the corridor"


def test_along_the_buildings_of_a_real_yard(along: Any) -> None:
    run = along(str(shared_file("data", "worlds", "kth_yard.xml")), 'side="left" length_m="40"', start="98.5,183,-90", platform="atrv2")
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text


def test_one_seed_gives_one_trace_along_a_wall(along: Any) -> None:
    hashes = [along(long(), 'length_m="4"', seed=seed).trace_sha256 for seed in (3, 3, 4)]
    assert hashes[0] == hashes[1] != hashes[2]


def test_round_a_house_in_an_open_field_nobody_is_lost_where_half_a_scan_sees_nothing(along: Any) -> None:
    """Building 9333: behind its corners nothing comes back to half of the beams for seconds, and then another side of the house is in view."""
    building, platform, side = Building.for_seed(9333)
    run = along(building.text, f'side="{side}" length_m="20"', max_time_s=100.0)
    assert (run.result, run.said("lost")) == ("SUCCESS", []), (platform, run.text)
