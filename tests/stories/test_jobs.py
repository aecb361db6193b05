"""Stories of missions with MoveTo, Explore, Investigate: in streets, yards and rooms, round holes and people, with a rectangle, through a pause."""

from __future__ import annotations

import itertools
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pluto_bt.bench.towns import Town
from pluto_bt.bench.yards import Yard
from pluto_bt.blackboard.messages import LocalMapState
from pluto_bt.scenario import Play, Run
from tests.shared_data import shared_file

MISSION = '<root BTCPP_format="4"><BehaviorTree ID="main"><Sequence>{body}</Sequence></BehaviorTree></root>'
LANE = """<world name="lane" seed="1"><wall id="lane">0,0 30,0 30,8 0,8 0,0</wall> {more}
  <robot platform="{platform}" x="3" y="4" theta_deg="0" ideal="{ideal}"/>{script}</world>"""


@pytest.fixture
def tell(scenario: Play, tmp_path: Path) -> Any:
    """Plays a mission body in a world given as text."""

    def play(body: str, world: str, **more: Any) -> Run:
        (tmp_path / "mission.xml").write_text(MISSION.format(body=body), encoding="utf-8")
        (tmp_path / "world.xml").write_text(world, encoding="utf-8")
        return scenario(str(tmp_path / "world.xml"), mission=str(tmp_path / "mission.xml"), **more)

    return play


def lane(more: str = "", platform: str = "atrv2", ideal: bool = False, script: str = "") -> str:
    return LANE.format(more=more, platform=platform, ideal=str(ideal).lower(), script=f"<script>{script}</script>" if script else "")


@pytest.mark.parametrize("seed", [101, 102, 103])
def test_moveto_finds_its_way_through_a_town_it_has_never_seen(tell: Any, seed: int) -> None:
    town = Town.make(seed)
    run = tell(f'<MoveTo goal="{town.goal[0]};{town.goal[1]}" timeout_s="900"/>', town.text, max_time_s=1000.0)
    assert (run.result, run.reason, run.collisions) == ("SUCCESS", "", 0), run.text
    assert math.dist(run.final_pose[:2], town.goal) < 0.3 + 0.02 * run.distance_m
    assert run.distance_m < 2.5 * town.way_m + 20.0


def test_moveto_goes_end_to_end_of_a_street_of_three_hundred_metres(scenario: Play, tmp_path: Path) -> None:
    text = shared_file("data", "worlds", "kth_yard.xml").read_text(encoding="utf-8")
    robot = '<robot platform="atrv2" x="104" y="183" theta_deg="-90"/>'
    (tmp_path / "kth.xml").write_text(re.sub("<robot[^>]*/>", robot, text))
    (tmp_path / "mission.xml").write_text(MISSION.format(body='<MoveTo goal="5;36" max_speed_mps="0.9"/>'))
    run = scenario(str(tmp_path / "kth.xml"), mission=str(tmp_path / "mission.xml"), max_time_s=1200.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert math.dist(run.final_pose[:2], (5.0, 36.0)) < 0.3 + 0.01 * run.distance_m
    assert run.min_clearance_m > 0.8, "in the middle of the street"


def test_moveto_drives_round_a_hole_that_a_level_scan_does_not_see(tell: Any) -> None:
    run = tell('<MoveTo goal="20;4"/>', lane('<hole id="pit">9,2.8 11,2.8 11,5.2 9,5.2</hole>'))
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text


def test_moveto_drives_round_a_kerb_that_a_level_scan_passes_over(tell: Any) -> None:
    run = tell('<MoveTo goal="20;4"/>', lane('<polygon id="kerb" height="0.2">9,2.5 11,2.5 11,5 9,5</polygon>'))
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text


def low_things(seed: int, height_m: float) -> str:
    """A kerb with a gap, a plate and a box in the lane, the robot's straight way leading over each of them."""
    rng = np.random.default_rng(seed)
    at = [8.0 + 6.0 * k + float(rng.uniform(-1.0, 1.0)) for k in range(3)]
    kerb, plate, box = rng.permutation(at).tolist()
    low, high = (0.02, 5.0) if rng.random() < 0.5 else (3.0, 7.98)
    corners = f"{kerb:.2f},{low} {kerb + 0.25:.2f},{low} {kerb + 0.25:.2f},{high} {kerb:.2f},{high}"
    return (f'<polygon id="kerb" height="{height_m}">{corners}</polygon>'
            f'<circle id="plate" height="{height_m}" x="{plate:.2f}" y="{rng.uniform(3.4, 4.6):.2f}" r="0.3"/>'
            f'<polygon id="box" height="{height_m}">{box:.2f},3.4 {box + 0.8:.2f},3.6 {box + 0.6:.2f},4.6 {box - 0.2:.2f},4.4</polygon>')  # fmt: skip


@pytest.mark.parametrize(("seed", "height_m"), [(1, 0.12), (2, 0.12), (3, 0.15), (4, 0.15), (5, 0.3)])
def test_moveto_runs_into_none_of_the_low_things_on_its_way(tell: Any, seed: int, height_m: float) -> None:
    run = tell('<MoveTo goal="27;4"/>', lane(low_things(seed, height_m)), seed=seed, max_time_s=200.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text


def test_moveto_finds_the_way_round_what_it_only_feels(tell: Any) -> None:
    run = tell('<MoveTo goal="20;4"/>', lane('<polygon id="sill" height="0.04">12,3 12.3,3 12.3,5 12,5</polygon>'), max_time_s=200.0)
    assert run.result == "SUCCESS", run.text
    assert 1 <= run.collisions <= 4, "not again and again"


@pytest.mark.parametrize("platform", ["atrv2", "pioneer"])
def test_moveto_among_people_who_do_not_yield_waits_for_them_runs_into_nobody_and_arrives(tell: Any, platform: str) -> None:
    people = '<actor id="one" r="0.25" speed="1" loop="true">20,3 5,5</actor><actor id="other" r="0.25" speed="0.5" loop="true">12,2 16,6</actor>'
    run = tell('<MoveTo goal="22;4" timeout_s="600"/>', lane(people, platform), max_time_s=700.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert math.dist(run.final_pose[:2], (22.0, 4.0)) < 0.8
    assert run.sim_time_s < 300.0, "they hold it up, but not for ever"


def test_moveto_says_no_path_where_every_way_is_shut(tell: Any) -> None:
    run = tell('<MoveTo goal="20;4" reason="{why}"/>', lane('<wall id="shut">12,0 12,8</wall>'))
    assert (run.result, run.reason, run.collisions) == ("FAILURE", "no-path", 0)


@pytest.mark.parametrize("platform", ["car", "jbot"])
def test_a_robot_without_a_laser_says_so(tell: Any, platform: str) -> None:
    run = tell('<MoveTo goal="20;4"/>', lane('<area id="m" kind="map">0,0 30,0 30,8 0,8</area>', platform))
    assert (run.result, run.reason) == ("FAILURE", "no-device")


def test_a_mission_that_is_paused_goes_on_with_its_job(scenario: Play, tell: Any, tmp_path: Path) -> None:
    events = '<at t="12"><fault device="module:motion" kind="off" for="0.05"/></at>'
    run = tell('<RetryUntilSuccessful num_attempts="3"><MoveTo goal="20;4"/></RetryUntilSuccessful>', lane(script=events))
    assert run.result == "SUCCESS", run.text


@pytest.mark.parametrize("seed", [201, 202])
def test_explore_covers_a_yard_comes_home_and_never_leaves_its_rectangle(tell: Any, seed: int) -> None:
    yard = Yard.make(seed)
    b, h = yard.rectangle
    run = tell(f'<Explore rectangle="{b:.2f};{h:.2f}"/>', yard.text, max_time_s=1500.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert math.dist(run.final_pose[:2], yard.start[:2]) < 0.3 + 0.02 * run.distance_m
    assert all(-1e-3 <= p.pose[0] - yard.start[0] <= h and abs(p.pose[1] - yard.start[1]) <= b for p in run.track)
    shown = run.runner.system.board.newest("map/local").value
    assert isinstance(shown, LocalMapState)
    assert yard.covered_share(shown) > 0.9


def test_the_pioneer_explores_an_office(scenario: Play, tmp_path: Path) -> None:
    (tmp_path / "mission.xml").write_text(MISSION.format(body='<Explore rectangle="6;11"/>'))
    run = scenario("office.xml", mission=str(tmp_path / "mission.xml"), start="0.5,6.5,0", platform="pioneer", max_time_s=900.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    rooms = {"kitchen": (3.0, 3.0), "lab": (9.0, 3.0), "hall": (4.5, 10.0)}
    seen = {name: min(math.dist(p.pose[:2], place) for p in run.track) for name, place in rooms.items()}
    assert max(seen.values()) < 3.0, seen


@pytest.mark.parametrize(
    ("shape", "middle", "radius_m", "platform"),
    [
        ('<circle id="o" x="14" y="1" r="0.15"/>', (14.0, 1.0), 2.0, "atrv2"),
        ('<circle id="o" x="14" y="1" r="1.5"/>', (14.0, 1.0), 3.2, "atrv2"),
        ('<polygon id="o">12,0 15,0 15,1.2 12,1.2</polygon>', (13.5, 0.6), 3.2, "atrv2"),
        ('<polygon id="o">8,0 8.5,0 8.5,0.5 8,0.5</polygon>', (8.25, 0.25), 1.4, "pioneer"),
    ],
)
def test_investigate_circles_the_closest_object(tell: Any, shape: str, middle: Any, radius_m: float, platform: str) -> None:
    world = f"""<world name="field" seed="2"><wall id="w">-4,-14 26,-14 26,14 -4,14 -4,-14</wall>{shape}
      <robot platform="{platform}" x="3" y="0" theta_deg="0"/></world>"""
    run = tell(f'<Investigate radius_m="{radius_m}"/>', world)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    away = [(p.t_s, math.dist(p.pose[:2], middle), math.atan2(p.pose[1] - middle[1], p.pose[0] - middle[0])) for p in run.track]
    steps = [math.remainder(b[2] - a[2], math.tau) for a, b in itertools.pairwise(away)]
    turned = list(itertools.accumulate(reversed(steps)))  # from the end back
    first = next((k for k, turned_rad in enumerate(turned) if turned_rad > 0.95 * math.tau), None)
    assert first is not None, "a full circle"
    assert max(abs(distance - radius_m) for _, distance, _ in away[-first:]) < 0.2
    assert away[-1][0] - away[-first][0] < 2.0 * math.pi * radius_m / 0.3 + 8 * 6.0, "with eight looks"


def test_investigate_says_no_object_between_bare_walls(tell: Any) -> None:
    run = tell('<Investigate radius_m="2"/>', lane())
    assert (run.result, run.reason) == ("FAILURE", "no-object")


def test_set_rectangle_limits_what_follows_and_b_0_removes_it(tell: Any) -> None:
    body = """<SetRectangle rectangle="3;10" home="2.5;4;0"/>
      <Inverter><MoveTo goal="20;4" reason="{why}"/></Inverter>
      <SetRectangle rectangle="0;0"/> <MoveTo goal="20;4"/>"""
    run = tell(body, lane())
    assert (run.result, run.blackboard["why"]) == ("SUCCESS", "outside-rectangle"), run.text


def test_resume_explores_the_rectangle_that_is_set(tell: Any) -> None:
    run = tell('<SetRectangle rectangle="3;9" home="2.8;4;0"/> <Resume/>', lane())
    assert run.result == "SUCCESS", run.text
    assert math.dist(run.final_pose[:2], (2.8, 4.0)) < 0.6 and run.distance_m > 5.0


def test_one_seed_gives_one_trace_with_a_job_in_it(tell: Any) -> None:
    hashes = [tell('<MoveTo goal="12;4"/>', lane(), seed=seed).trace_sha256 for seed in (3, 3, 4)]
    assert hashes[0] == hashes[1] != hashes[2]
