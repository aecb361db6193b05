"""Stories of robots that navigate: through rooms with doors, on real maps, around what closes a door, with trees as Nav2 users write them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from pluto_bt.scenario import Play, Run
from tests.shared_data import shared_file
from tests.stories.rooms import House

MISSION = '<root BTCPP_format="4"><BehaviorTree ID="main"><Sequence>{body}</Sequence></BehaviorTree></root>'
LIKE_NAV2 = Path(__file__).resolve().parents[2] / "missions" / "navigate.xml"


@pytest.fixture
def tell(scenario: Play, tmp_path: Path) -> Any:
    """Plays a mission (its text, or the nodes of a sequence) in a world given as text."""

    def play(mission: str, world: str, **more: Any) -> Run:
        (tmp_path / "mission.xml").write_text(mission if "<root" in mission else MISSION.format(body=mission), encoding="utf-8")
        (tmp_path / "world.xml").write_text(world, encoding="utf-8")
        return scenario(str(tmp_path / "world.xml"), mission=str(tmp_path / "mission.xml"), **more)

    return play


def closing(house: House, rooms: tuple[int, int], door_m: float) -> str:
    """A door leaf that is not there yet, in the door between two rooms."""
    x, y = house.doors[rooms]
    w, h = (0.05, door_m / 2) if rooms[1] - rooms[0] == 1 else (door_m / 2, 0.05)
    return f'<polygon id="leaf" absent="true">{x - w},{y - h} {x + w},{y - h} {x + w},{y + h} {x - w},{y + h}</polygon>'


@pytest.mark.parametrize(("platform", "door_m", "seed"), [("pioneer", 0.9, 1), ("atrv2", 1.4, 2), ("jbot", 1.2, 3)])
def test_a_robot_visits_rooms_and_comes_home_through_the_doors(tell: Any, platform: str, door_m: float, seed: int) -> None:
    house = House.make(seed, platform, door_m)
    run = tell('<NavigateTo goal="room5" path="{path}"/><NavigateTo goal="3;9;90"/>', house.text, max_time_s=300.0)
    assert (run.result, run.reason, run.collisions) == ("SUCCESS", "", 0), run.text
    assert math.dist(run.final_pose[:2], house.middles[3]) < 0.35
    assert math.degrees(run.final_pose[2]) == pytest.approx(90.0, abs=8.0) or platform == "jbot"


@pytest.mark.parametrize("how", ["NavigateTo", "Nav2"])
def test_a_door_that_is_closed_on_the_way_is_found_closed_and_another_way_taken(tell: Any, how: str) -> None:
    plain = House.make(5, "pioneer", 0.9)
    leaf = closing(plain, (4, 5), 0.9)
    house = House.make(5, "pioneer", 0.9, more=leaf, script='<at t="1"><place id="leaf"/></at>')
    if how == "Nav2":
        run = tell(LIKE_NAV2.read_text(encoding="utf-8"), house.text, ports={"goal": "room5"}, max_time_s=300.0)
    else:
        run = tell('<NavigateTo goal="room5"/>', house.text, max_time_s=300.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert math.dist(run.final_pose[:2], house.middles[5]) < 0.35
    seen_at_the_door = min(math.dist(point.pose[:2], house.doors[4, 5]) for point in run.track)
    assert 0.5 < seen_at_the_door < 6.0, "it went there, and turned round"


def test_a_robot_that_is_locked_in_waits_and_then_says_so(tell: Any) -> None:
    plain = House.make(5, "pioneer", 0.9, columns=2, rows=1)
    house = House.make(5, "pioneer", 0.9, columns=2, rows=1, more=closing(plain, (0, 1), 0.9), script='<at t="1"><place id="leaf"/></at>')
    run = tell('<NavigateTo goal="room1" reason="{why}"/>', house.text, max_time_s=120.0)
    assert (run.result, run.reason, run.collisions) == ("FAILURE", "no-path", 0)
    assert "blocked by something that the map does not show" in run.text
    opened = house.text.replace("</script>", '<at t="7"><remove id="leaf"/></at></script>')
    run = tell('<NavigateTo goal="room1"/>', opened, max_time_s=120.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), "somebody opened in time"


def test_who_is_carried_off_on_its_way_is_lost_and_says_so_with_that_word(tell: Any) -> None:
    house = House.make(5, "pioneer", 0.9, script='<at t="9"><place id="robot" x="9" y="9" theta_deg="130"/></at>')
    run = tell('<NavigateTo goal="room5" reason="{why}"/>', house.text, max_time_s=60.0)
    assert (run.result, run.reason, run.collisions) == ("FAILURE", "lost", 0), run.text
    assert run.sim_time_s < 20.0


@pytest.mark.parametrize(
    ("goal", "word", "sentence"),
    [
        ("dock", "no-path", 'the map has no goal "dock"'),
        ("9;0;0", "no-path", "no room for the robot at the goal"),
        ("40;3", "no-path", "the map has no way"),
    ],
)
def test_a_goal_that_cannot_be_reached_is_refused_before_anything_moves(tell: Any, goal: str, word: str, sentence: str) -> None:
    run = tell(f'<NavigateTo goal="{goal}" tolerance_m="0.1"/>', House.make(1, "pioneer", 0.9).text, max_time_s=60.0)
    assert (run.result, run.reason) == ("FAILURE", word) and sentence in run.text
    assert run.distance_m < 0.05


def test_forbidden_ground_is_driven_around(tell: Any) -> None:
    world = """<world name="field" seed="1"><wall id="fence">0,0 20,0 20,12 0,12 0,0</wall><area id="lawn" kind="forbidden">8,2 12,2 12,10 8,10</area>
      <robot platform="atrv2" x="3" y="6" ideal="true"/></world>"""
    run = tell('<NavigateTo goal="17;6"/>', world, max_time_s=120.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert not any(8.0 < point.pose[0] < 12.0 and 2.0 < point.pose[1] < 10.0 for point in run.track)


def test_plan_then_follow(tell: Any) -> None:
    body = '<PlanPath goal="room4" path="{p}"/><FollowPath path="{p}" max_speed_mps="0.4"/><PlanPath goal="home" path="{p}" reason="{why}"/>'
    run = tell(body, House.make(2, "pioneer", 0.9).text, max_time_s=120.0)
    assert (run.result, run.reason) == ("FAILURE", "no-path") and 'the map has no goal "home"' in run.text
    assert math.dist(run.final_pose[:2], (9.0, 9.0)) < 0.35


MAPS = [
    # map, platform, start, goal
    ("maps/nav2_tb3_sandbox.yaml", "pioneer", "-2,-0.5,0", "1.8;0.8"),
    ("maps/nav2_depot.yaml", "pioneer", "4,4,90", "26;11.5;180"),
    ("maps/aria_office.map", "pioneer", None, "17;12"),
]


@pytest.mark.parametrize(("name", "platform", "start", "goal"), MAPS, ids=lambda value: str(value))
def test_real_maps(scenario: Play, tmp_path: Path, name: str, platform: str, start: str | None, goal: str) -> None:
    path = shared_file("data", *name.split("/"))
    (tmp_path / "mission.xml").write_text(MISSION.format(body='<NavigateTo goal="{goal}"/>'), encoding="utf-8")
    run = scenario(str(path), mission=str(tmp_path / "mission.xml"), platform=platform, start=start, ports={"goal": goal}, max_time_s=400.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    x, y = (float(part) for part in goal.split(";")[:2])
    assert math.dist(run.estimated_pose[:2], (x, y)) < 0.35
