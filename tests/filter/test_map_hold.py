"""The mapped area holds a robot that sees nothing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.maps.world import Area, World
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.scenario import Play
from pluto_bt.skills.limits import STILL
from pluto_bt.skills.map_area import MapArea
from pluto_bt.skills.map_hold import Braking, held_at_edge, held_by_area
from pluto_bt.skills.stop_filter import FilterSenses, StopFilter
from pluto_bt.skills.verdict import ALL_WELL
from tests.filter.whole_robot import WholeRobot

SQUARE = ((-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0))


@pytest.mark.parametrize(
    ("name", "pose", "twist", "passes"),
    [
        ("inside everything passes", (0.0, 0.0, 0.0), (0.5, 0.0), True),
        ("at the edge too: the next arc may turn away", (1.99, 0.0, 0.0), (0.5, 0.0), True),
        ("outside, farther out", (2.2, 0.0, 0.0), (0.5, 0.0), False),
        ("outside, back the way it came", (2.2, 0.0, 0.0), (-0.5, 0.0), True),
        ("outside, round an arc that comes back", (2.2, 0.0, 1.5), (0.5, 0.6), True),
        ("outside, along the edge", (2.2, 0.0, 1.5708), (0.5, 0.0), False),
    ],
)
def test_what_the_area_lets_through(name: str, pose: tuple[float, float, float], twist: tuple[float, float], passes: bool) -> None:
    out, verdict = held_by_area(MapArea((SQUARE,)), twist, pose, 0.5, ALL_WELL)
    assert (out, verdict.reason) == ((twist, "") if passes else (STILL, "outside-map"))


BRAKING = Braking(0.25, 0.28)


@pytest.mark.parametrize("speed_mps", [0.05, 0.3, 0.9, -0.5])
def test_the_speed_from_which_it_stops_in_time_is_that_of_the_way(speed_mps: float) -> None:
    assert BRAKING.speed_mps(BRAKING.way_m(speed_mps)) == pytest.approx(abs(speed_mps))


@pytest.mark.parametrize(
    ("name", "pose", "twist", "share"),
    [
        ("far from the edge", (0.0, 0.0, 0.0), (0.5, 0.0), 1.0),
        ("near, straight at it", (1.8, 0.0, 0.0), (0.5, 0.0), BRAKING.speed_mps(0.2) / 0.5),
        ("near, away from it", (1.8, 0.0, 3.1416), (0.5, 0.0), 1.0),
        ("near, backwards at it", (-1.8, 0.0, 0.0), (-0.5, 0.0), BRAKING.speed_mps(0.2) / 0.5),
        ("near, on an arc that turns in time", (1.8, 0.0, 1.2), (0.5, 0.6), 1.0),
        ("at it", (1.999, 0.0, 0.0), (0.5, 0.0), 0.0),
        ("outside, farther out", (2.2, 0.0, 0.0), (0.5, 0.0), 0.0),
        ("outside, back the way it came", (2.2, 0.0, 0.0), (-0.5, 0.0), 1.0),
    ],
)
def test_the_edge_is_kept_by_who_shall_keep_it(name: str, pose: tuple[float, float, float], twist: tuple[float, float], share: float) -> None:
    out, verdict = held_at_edge(MapArea((SQUARE,)), twist, pose, BRAKING, ALL_WELL)
    assert out == pytest.approx((share * twist[0], share * twist[1]), abs=0.03)
    assert verdict.reason == ("" if share == 1.0 else "outside-map")


@given(st.floats(0.01, 3.0), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_a_smaller_area_is_that_far_from_the_edge(margin_m: float, x: float, y: float) -> None:
    room_m = 2.0 - max(abs(x), abs(y))
    assume(abs(room_m - margin_m) > 1e-6)
    assert MapArea((SQUARE,)).shrunk(margin_m).has_point(x, y) is (room_m > margin_m)


def test_where_two_areas_meet_is_no_edge_and_a_hole_in_the_middle_is_one() -> None:
    left, right = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)), ((2.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 2.0))
    area = MapArea((left, right)).shrunk(0.5)
    assert area.has_line(0.6, 1.0, 3.4, 1.0) and not area.has_point(2.0, 0.4)
    ring = [((0.0, 0.0), (9.0, 0.0), (9.0, 3.0), (0.0, 3.0)), ((0.0, 6.0), (9.0, 6.0), (9.0, 9.0), (0.0, 9.0)),
            ((0.0, 0.0), (3.0, 0.0), (3.0, 9.0), (0.0, 9.0)), ((6.0, 0.0), (9.0, 0.0), (9.0, 9.0), (6.0, 9.0))]  # fmt: skip
    area = MapArea(ring).shrunk(0.5)
    assert area.has_line(1.0, 1.0, 8.0, 1.0) and area.has_point(2.4, 4.5)
    assert not area.has_point(2.6, 4.5) and not area.has_point(4.5, 4.5) and not area.has_line(1.0, 4.5, 8.0, 4.5)


def test_who_keeps_from_the_edge_touches_no_wall_on_it(scenario: Play, tmp_path: Path) -> None:
    """The middle of the car would be let out to the wall."""
    markers = "".join(f'<marker id="{i}" x="{1 + 2 * (i % 4)}" y="{1 + 2 * (i // 4)}"/>' for i in range(16))
    (tmp_path / "w.xml").write_text(f"""<world name="hall" seed="1"><wall id="b">0,0 8,0 8,8 0,8 0,0</wall>
        <area id="floor" kind="map">0,0 8,0 8,8 0,8</area>{markers}<robot platform="car" x="4" y="5" theta_deg="90"/></world>""", encoding="utf-8")
    (tmp_path / "m.xml").write_text('<root BTCPP_format="4"><BehaviorTree ID="m"><CarGoTo goal="4;7.9" tolerance_m="0.1"/></BehaviorTree></root>',
                                    encoding="utf-8")  # fmt: skip
    as_point = scenario(str(tmp_path / "w.xml"), mission=str(tmp_path / "m.xml"))
    keeping = scenario(str(tmp_path / "w.xml"), mission=str(tmp_path / "m.xml"), settings=["filter.area_margin_m=0.35"])
    assert (as_point.collisions, keeping.collisions) == (1, 0)
    assert (keeping.result, keeping.reason) == ("FAILURE", "outside-map"), keeping.text
    assert keeping.min_clearance_m > 0.05


def test_without_a_mapped_area_everything_passes() -> None:
    assert held_by_area(MapArea(()), (0.5, 0.0), (99.0, 0.0, 0.0), 0.5, ALL_WELL) == ((0.5, 0.0), ALL_WELL)


def test_the_car_stops_just_outside_its_area() -> None:
    world = World("open", areas=(Area("floor", "map", np.array(SQUARE)),))
    robot = WholeRobot(world, "car", (0.0, 0.0, 0.0), level="filter")
    robot.drive(0.5, 0.0, 9.0)
    assert robot.verdict.reason == "outside-map"
    assert 2.0 < robot.system.simulator.pose[0] < 2.8


CAR = load_robot_file("car")


@pytest.mark.parametrize(
    ("name", "area", "stamp_s", "word"),
    [
        ("a fresh pose", (SQUARE,), 9.9, ""),
        ("an old pose", (SQUARE,), 9.7, "no-pose"),
        ("no pose at all", (SQUARE,), None, "no-pose"),
        ("no pose, and no limit that it could pass", (), None, ""),
    ],
)
def test_the_area_is_only_kept_by_who_knows_where_he_is(name: str, area: tuple[Any, ...], stamp_s: float | None, word: str) -> None:
    skill = StopFilter(CAR, CAR.filter, MapArea(area))
    place = None if stamp_s is None else (stamp_s, (0.0, 0.0, 0.0))
    out = skill.step((0.3, 0.0), 10.0, FilterSenses(ActuatorState(10.0), None, place))
    assert (out, skill.verdict.reason) == (STILL if word else (0.3, 0.0), word)


def test_the_car_stops_in_its_area_when_localisation_falls_silent() -> None:
    robot = WholeRobot(World("open", areas=(Area("floor", "map", np.array(SQUARE)),)), "car", (0.0, 0.0, 0.0), level="filter")
    robot.drive(0.3, 0.0, 1.0)
    assert (robot.verdict.reason, robot.commanded[0]) == ("", 0.3)
    robot.system.order_module("local", False)
    robot.drive(0.3, 0.0, 0.35)
    assert (robot.verdict.reason, robot.commanded[0]) == ("no-pose", 0.0)
    robot.system.order_module("local", True)
    robot.drive(0.3, 0.0, 0.3)
    assert (robot.verdict.reason, robot.commanded[0]) == ("", 0.3)
