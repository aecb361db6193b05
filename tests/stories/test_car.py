"""Stories of the car's trip: it closes its loop wherever the markers hang, and something in its way ends the trip."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

import sim.worlds
from pluto_bt.bench import trips
from pluto_bt.bench.trip_faults import MUD, TROUBLES, blame
from pluto_bt.record.box import open_box
from pluto_bt.record.curves import goals_of
from pluto_bt.scenario import Play, Run
from pluto_bt.source import Faults
from pluto_bt.trees.why_box import why_at

CORRIDOR = (Path(sim.worlds.__file__).parent / "corridor.xml").read_text(encoding="utf-8")
ROBOT = '<robot name="car"'
MARKERS = {  # where they hang: x, y
    "in two dense rows": [(x, 0.25 + 0.5 * i) for i in range(39) for x in (0.8, 2.3)],
    "far apart": [(1.565, 1.5 + 2.5 * i) for i in range(8)],
    "along both walls": [(0.05 if i % 2 else 3.08, 0.5 + i) for i in range(20)],
    "along one wall": [(0.05, 0.5 + 1.5 * i) for i in range(13)],
}


@pytest.fixture
def corridor(tmp_path: Path) -> Path:
    """The shipped corridor, for changing."""
    path = tmp_path / "corridor.xml"
    path.write_text(CORRIDOR, encoding="utf-8")
    return path


def trip(scenario: Play, world: Path, loops: int, seed: int) -> Run:
    ports = {"max_loops": loops}
    return scenario(str(world), mission="trip2.xml", platform="car", start="0.5,12,90", ports=ports, seed=seed, max_time_s=90.0 * loops)


@pytest.mark.parametrize("seed", [8, 21])
def test_the_trip_closes_its_loop_again_and_again_with_a_gyro_that_drifts(seed: int) -> None:
    """`pluto bench trips` has 40 seeds and 100 loops."""
    run = trips.trip(seed, 3)
    assert (run.result, run.reason, run.collisions) == ("SUCCESS", "", 0), run.text
    assert run.blackboard["loops"] == 3
    assert run.min_clearance_m > 0.2
    assert run.final_pose is not None and run.estimated_pose is not None
    assert math.dist(run.final_pose[:2], run.estimated_pose[:2]) < 0.15


@pytest.mark.parametrize("seed", [0, 1])
def test_the_markers_may_hang_anywhere_and_point_anywhere(seed: int) -> None:
    run = trips.trip(seed, 2, anywhere=True)
    assert (run.result, run.collisions, run.blackboard["loops"]) == ("SUCCESS", 0, 2), run.text


@pytest.mark.parametrize("trouble", [*TROUBLES, MUD])
def test_whatever_befalls_it_the_trip_claims_no_wrong_place_and_ends_for_the_right_reason(trouble: str) -> None:
    """`pluto bench trips` has eight seeds of each, and two loops."""
    assert blame(trouble, trips.trip(3, 1, trouble=trouble)) == ""


@pytest.mark.parametrize("where", MARKERS)
def test_the_markers_may_hang_elsewhere(scenario: Play, corridor: Path, where: str) -> None:
    bare = "\n".join(line for line in CORRIDOR.splitlines() if "<marker" not in line)
    hung = "".join(f'<marker id="{i}" x="{x}" y="{y:g}" theta_deg="90"/>' for i, (x, y) in enumerate(MARKERS[where]))
    corridor.write_text(bare.replace(ROBOT, hung + ROBOT), encoding="utf-8")
    run = trip(scenario, corridor, 2, 5)
    assert (run.result, run.collisions, run.blackboard["loops"]) == ("SUCCESS", 0, 2), run.text


@pytest.mark.parametrize(("t_s", "x_m", "y_m"), [(5, 0.5, 16), (20, 0.6, 9), (44, 0.5, 7)])
def test_something_put_in_its_way_ends_the_trip(scenario: Play, corridor: Path, t_s: int, x_m: float, y_m: float) -> None:
    script = f'<script><at t="{t_s}"><place id="box" x="{x_m}" y="{y_m}"/></at></script>'
    corridor.write_text(CORRIDOR.replace(ROBOT, script + ROBOT), encoding="utf-8")
    run = trip(scenario, corridor, 3, 1)
    assert (run.result, run.reason, run.exit_code) == ("FAILURE", "hindered", 1)
    assert run.collisions == 1, "it has no sensor that could see the box: it drives up to it once, and not again"
    met_s = run.contacts[0]["t_s"]
    assert run.sim_time_s - met_s < 5.0
    assert math.dist(run.at(met_s + 0.1).pose[:2], run.final_pose[:2]) < 0.05
    assert run.runner.system.simulator.velocity == pytest.approx((0.0, 0.0), abs=1e-3)


BARE = re.sub(r"<marker.*?/>", "", CORRIDOR)
ROOM_ASIDE = re.sub(r'(<area id="floor".*?>).*?</area>', r"\g<1>0,0 1,0 1,16 3.13,16 3.13,19.78 0,19.78</area>", CORRIDOR)
HELD = CORRIDOR.replace(ROBOT, '<script><at t="1"><fault device="base" kind="blocked"/></at></script>' + ROBOT)
CLAUSES = [  # what, the leaf, the world, result and reason, at what time at the latest, how far it may have driven
    ("a goal outside the map is refused", '<CarGoTo goal="4;12"/>', CORRIDOR, "FAILURE outside-map", 0.1, 0.0),
    ("a way out of the map is not begun", '<CarGoTo goal="2.8;17"/>', ROOM_ASIDE, "FAILURE outside-map", 0.3, 0.0),
    ("without an accepted marker it does not start", '<CarGoTo goal="0.5;17"/>', BARE, "FAILURE no-pose", 5.2, 0.0),
    ("a turn needs no marker", '<MakeTurn angle_deg="90"/>', BARE, "SUCCESS ", 10.0, 3.0),
    ("wheels that are held end a goto", '<CarGoTo goal="0.5;17"/>', HELD, "FAILURE hindered", 4.5, 0.2),
    ("a turn is given up after 30 s", '<MakeTurn angle_deg="180"/>', HELD, "FAILURE timeout", 30.2, 0.3),
    ("0 is done at once", '<MakeTurn angle_deg="0"/>', CORRIDOR, "SUCCESS ", 0.1, 0.0),
    ("so is a whole turn", '<MakeTurn angle_deg="-360"/>', CORRIDOR, "SUCCESS ", 0.1, 0.0),
]


@pytest.mark.parametrize(("leaf", "world", "ends", "latest_s", "farthest_m"), [row[1:] for row in CLAUSES], ids=[row[0] for row in CLAUSES])
def test_clauses_of_goto_and_maketurn(
    scenario: Play, corridor: Path, leaf: str, world: str, ends: str, latest_s: float, farthest_m: float
) -> None:
    corridor.write_text(world, encoding="utf-8")
    mission = corridor.with_name("leaf.xml")
    mission.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="main">{leaf}</BehaviorTree></root>', encoding="utf-8")
    run = scenario(str(corridor), mission=str(mission), platform="car", start="0.5,12,90", max_time_s=60.0)
    assert f"{run.result} {run.reason}" == ends, run.text
    assert run.sim_time_s <= latest_s
    assert run.distance_m <= farthest_m
    assert run.runner.system.simulator.velocity == pytest.approx((0.0, 0.0), abs=2e-3)


@pytest.mark.parametrize("angle_deg", [90.0, -90.0, 170.0, -45.0])
@pytest.mark.parametrize("platform", ["car", "atrv2", "pioneer", "jbot"])
def test_maketurn_is_relative_and_clockwise_on_every_robot(scenario: Play, corridor: Path, platform: str, angle_deg: float) -> None:
    corridor.write_text('<world name="field"><robot platform="car" x="0" y="0" theta_deg="30"/></world>', encoding="utf-8")
    mission = corridor.with_name("turn.xml")
    mission.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="main"><MakeTurn angle_deg="{angle_deg}"/></BehaviorTree></root>', encoding="utf-8")
    run = scenario(str(corridor), mission=str(mission), platform=platform, start="0,0,30", max_time_s=60.0)
    assert run.result == "SUCCESS", run.text
    turned_deg = -math.degrees(math.remainder(run.final_pose[2] - math.radians(30.0), math.tau))
    off_deg = 45.0 if platform == "car" else 10.0  # a car rolls on for half a metre, and nobody steers it any more
    assert abs(math.remainder(turned_deg - angle_deg, 360.0)) < off_deg
    assert platform == "car" or run.distance_m < 0.05, "in place"


# for twenty seconds of the second step: device, kind, and the word with which the trip ends ("" = it goes on)
FAULTS = [
    ("marker", "off", ""), ("marker", "frozen", ""), ("marker", "nan", ""), ("marker", "garbage", ""), ("marker", "late", ""),
    ("speed", "off", "speed-stale"), ("speed", "nan", "speed-stale"), ("speed", "stuck", ""),
    ("imu", "off", "gyro-stale"), ("imu", "nan", "gyro-stale"), ("base", "blocked", "hindered"), ("base", "off", "base-lost"),
]  # fmt: skip


@pytest.mark.parametrize(("device", "kind", "ends"), FAULTS)
def test_a_fault_of_its_own_sensors_never_drives_it_into_a_wall(scenario: Play, corridor: Path, device: str, kind: str, ends: str) -> None:
    more = ' delay="2"' if kind == "late" else ""
    script = f'<script><at t="20"><fault device="{device}" kind="{kind}"{more} for="20"/></at></script>'
    corridor.write_text(CORRIDOR.replace(ROBOT, script + ROBOT), encoding="utf-8")
    run = trip(scenario, corridor, 1, 2)
    assert run.collisions == 0
    assert run.reason == ends, run.text
    assert run.exit_code == {"": 0, "base-lost": 3}.get(ends, 1)


@pytest.mark.parametrize("at_s", [5.0, 13.0, 20.0, 38.0])  # the first leg, on the bend at the top, down the corridor, on the bend below
@pytest.mark.parametrize(("device", "for_s", "word"), [("imu", 2.8, "gyro-stale"), ("speed", 3.5, "speed-stale")])
def test_it_stands_while_a_sensor_is_silent_and_goes_on_when_it_speaks_again(
    scenario: Play, corridor: Path, device: str, for_s: float, word: str, at_s: float
) -> None:
    script = f'<script><at t="{at_s}"><fault device="{device}" kind="off" for="{for_s}"/></at></script>'
    corridor.write_text(CORRIDOR.replace(ROBOT, script + ROBOT), encoding="utf-8")
    run = trip(scenario, corridor, 1, 2)
    assert (run.result, run.reason, run.collisions) == ("SUCCESS", "", 0), run.text
    stood = [point for point in run.track if at_s + for_s - 0.3 < point.t_s < at_s + for_s]
    assert math.dist(stood[0].pose[:2], stood[-1].pose[:2]) < 0.01, word
    assert math.dist(run.final_pose[:2], run.estimated_pose[:2]) < 0.15
    assert not run.said("gyro-drift"), "a turn that the gyro missed is none of its drift"


def test_wheels_that_stand_against_a_wall_are_told_at_once_and_a_turn_ends_with_that_cause(scenario: Play, corridor: Path) -> None:
    mission = corridor.with_name("m.xml")
    mission.write_text('<root BTCPP_format="4"><BehaviorTree ID="m"><MakeTurn angle_deg="-170"/></BehaviorTree></root>', encoding="utf-8")
    run = scenario(str(corridor), mission=str(mission), start="0.5,12,90", record=corridor.with_name("a.mcap"))
    assert (run.result, run.reason, run.collisions) == ("FAILURE", "timeout", 1)
    assert run.sim_time_s < 30.2
    assert "hindered: told to drive" in run.text
    met_s = run.contacts[0]["t_s"]
    box = open_box(corridor.with_name("a.mcap"), "a.mcap", Faults())
    assert box is not None
    answer = why_at(box, met_s + 1.7)
    assert (answer.is_moving, answer.first.code) == (False, "hindered")


def test_the_goals_of_a_trip_are_drawn(scenario: Play, corridor: Path) -> None:
    run = scenario(str(corridor), mission="trip2.xml", start="0.5,12,90", ports={"max_loops": 1}, record=corridor.with_name("a.mcap"))
    goals = [(0.5, 18.5), (0.7, 17.0), (0.6, 11.0), (0.5, 6.0), (0.5, 9.0)]
    assert list(run.runner.goals()) == goals
    box = open_box(corridor.with_name("a.mcap"), "a.mcap", Faults())
    assert box is not None and goals_of(box) == goals
    assert run.runner.system.board.newest("map/path").value.points_m == (), "at the end it drives to none"


def test_a_car_that_sees_no_marker_for_long_says_so_and_how_sure_it_is(scenario: Play, corridor: Path) -> None:
    script = '<script><at t="3"><fault device="marker" kind="off"/></at></script>'
    corridor.write_text(CORRIDOR.replace(ROBOT, script + ROBOT), encoding="utf-8")
    run = trip(scenario, corridor, 1, 2)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert len(run.said("marker-stale")) == 1
    board = run.runner.system.board
    assert board.newest("Localization/Check").value.reason == "marker-stale"
    pose = board.newest("Localization/Pose").value
    sigma_m = math.sqrt(pose.covariance[0] + pose.covariance[4])
    off_m = math.dist(run.final_pose[:2], run.estimated_pose[:2])
    assert 0.1 < sigma_m < 0.5 and off_m < 3.0 * sigma_m


@pytest.mark.parametrize(
    ("kind", "result", "reason"),
    [('kind="jump" value="0.3"', "SUCCESS", ""), ('kind="jump" value="-0.05"', "SUCCESS", ""), ('kind="stuck"', "FAILURE", "lost"),
     ('kind="garbage"', "FAILURE", "lost")],
)  # fmt: skip
def test_a_gyro_that_lies_is_found_out_by_the_markers(scenario: Play, corridor: Path, kind: str, result: str, reason: str) -> None:
    """What the markers agree upon puts the heading right; then it stands, and finds the gyro's new bias; a gyro that makes no sense stops it."""
    script = f'<script><at t="7"><fault device="imu" {kind}/></at></script>'
    corridor.write_text(CORRIDOR.replace(ROBOT, script + ROBOT), encoding="utf-8")
    run = trip(scenario, corridor, 1, 3)
    assert (run.result, run.reason, run.collisions) == (result, reason, 0), run.text
    assert math.dist(run.final_pose[:2], run.estimated_pose[:2]) < 0.3
    assert run.said("gyro-drift") or run.said("gyro-refused")
    assert bool(run.said("gyro-refused")) is (reason == "lost")


CAR_PARK = """<world name="car park" seed="4"><wall id="rim">0,0 12,0 12,8 0,8 0,0</wall>
<area id="mapped" kind="map">0.3,0.3 11.7,0.3 11.7,7.7 0.3,7.7</area>
<marker id="1" x="2" y="2"/><marker id="2" x="6" y="2"/><marker id="3" x="10" y="2"/>
<marker id="4" x="2" y="6"/><marker id="5" x="6" y="6"/><marker id="6" x="10" y="6"/>
<robot platform="car" x="2" y="3" theta_deg="0"/><script><at t="5"><place id="robot" x="9" y="6" theta_deg="{theta_deg}"/></at></script></world>"""


@pytest.mark.parametrize("theta_deg", [180, -120])
def test_a_car_that_is_carried_off_and_turned_is_put_right_by_several_markers(scenario: Play, tmp_path: Path, theta_deg: int) -> None:
    """The gate refuses each of them, for the gyro did not turn."""
    (tmp_path / "w.xml").write_text(CAR_PARK.format(theta_deg=theta_deg), encoding="utf-8")
    mission = tmp_path / "m.xml"
    legs = "".join(f'<CarGoTo goal="{goal}" timeout_s="60"/>' for goal in ("6;4", "3;4"))
    mission.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="m"><Sequence>{legs}</Sequence></BehaviorTree></root>', encoding="utf-8")
    run = scenario(str(tmp_path / "w.xml"), mission=str(mission))
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert run.said("pose-jump")
    assert math.dist(run.final_pose[:2], run.estimated_pose[:2]) < 0.3
    assert abs(math.remainder(run.final_pose[2] - run.estimated_pose[2], math.tau)) < math.radians(10.0)


def test_markers_that_are_all_off_by_two_metres_are_told(scenario: Play, corridor: Path) -> None:
    script = '<script><at t="10"><fault device="marker" kind="jump" value="2"/></at></script>'
    corridor.write_text(CORRIDOR.replace(ROBOT, script + ROBOT), encoding="utf-8")
    run = trip(scenario, corridor, 1, 3)
    assert run.result == "FAILURE", "blind, it drives where they say, and there is no corridor"
    assert run.reason in {"hindered", "outside-map"}
    assert "moves the position by 2.8 m" in run.said("pose-jump")[0]
