"""Goals and paths as text: every form that a mission or a tree of Nav2 may hold, there and back."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.behaviours.destinations import Destination, Destinations
from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.maps.world import Goal, World

NUMBERS = st.floats(-1e6, 1e6)
NAMES = st.from_regex(r"[A-Za-z_][\w -]{0,12}[A-Za-z]", fullmatch=True)
PLACES = st.one_of(
    st.builds(lambda name: Destination(name=name), NAMES),
    st.builds(Destination, NUMBERS, NUMBERS, st.one_of(st.none(), NUMBERS)),
)
POSE = "1000000000;map;4;2;0;0;0;0.7071067811865476;0.7071067811865476"
JSON_POSE = {
    "header": {"stamp": {"sec": 1, "nanosec": 0}, "frame_id": "map"},
    "pose": {"position": {"x": 4, "y": 2, "z": 0}, "orientation": {"x": 0, "y": 0, "z": math.sqrt(0.5), "w": math.sqrt(0.5)}},
}


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("4;2", Destination(4.0, 2.0)),
        ("4,2", Destination(4.0, 2.0)),
        (" 4 ; -2.5e1 ", Destination(4.0, -25.0)),
        ("4;2;90", Destination(4.0, 2.0, 90.0)),
        ("dock", Destination(name="dock")),
        ("room 5", Destination(name="room 5")),
    ],
)
def test_a_goal_in_our_forms(text: str, place: Destination) -> None:
    assert Destination.from_text(text) == place


@pytest.mark.parametrize("text", [POSE, "json:" + json.dumps(JSON_POSE)])
def test_a_goal_in_the_forms_of_nav2(text: str) -> None:
    goal = Destination.from_text(text)
    assert (goal.x_m, goal.y_m, goal.stamp_ns, goal.frame) == (4.0, 2.0, 10**9, "map")
    assert goal.theta_deg == pytest.approx(90.0)


@pytest.mark.parametrize("text", ["", "4", "4;", "4;2;1;5", "4;x", "nan;2", "4;1e999", "json:{}", "json:", "json:[1]", "0;map;x;2;0;0;0;0;1"])
def test_what_is_no_goal(text: str) -> None:
    with pytest.raises(ValueError):
        Destination.from_text(text)


@given(PLACES)
def test_a_goal_reads_back_as_it_was_written(place: Destination) -> None:
    assert Destination.from_text(place.to_text()) == place


@given(st.lists(PLACES, max_size=5))
def test_goals_read_back_as_they_were_written(places: list[Destination]) -> None:
    goals = Destinations(tuple(places))
    assert Destinations.from_text(goals.to_text()) == goals


def test_goals_in_the_forms_of_nav2() -> None:
    text = f"5;map;{POSE};{POSE.replace('4;2', '6;7')}"
    goals = Destinations.from_text(text)
    assert [(goal.x_m, goal.y_m) for goal in goals] == [(4.0, 2.0), (6.0, 7.0)]
    assert (goals.stamp_ns, goals.frame) == (5, "map")
    again = Destinations.from_text(goals.to_text())
    assert [goal.theta_deg for goal in again] == pytest.approx([90.0, 90.0])
    assert len(Destinations.from_text("json:" + json.dumps({"header": {}, "goals": [JSON_POSE]}))) == 1


def test_a_name_is_looked_up_on_the_map() -> None:
    world = World("w", goals=(Goal("dock", 1.0, 2.0, math.pi / 2),), home=Goal("home", 3.0, 4.0))
    assert Destination(name="dock").on(world) == Destination(1.0, 2.0, 90.0)
    assert Destination(name="home").on(world) == Destination(3.0, 4.0)
    with pytest.raises(LookupError, match='no goal "dok"; it has dock, home'):
        Destination(name="dok").on(world)
    with pytest.raises(LookupError, match="it has none"):
        Destination(name="home").on(None)


def test_a_path_reads_back_as_it_was_written() -> None:
    path = MapPath.along(np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]), math.pi)
    again = MapPath.from_text(path.to_text())
    assert again.poses == pytest.approx(path.poses, abs=1e-3)
    assert again.length_m == pytest.approx(2.0) and again.end == (1.0, 1.0)
    assert MapPath.from_text("json:" + json.dumps({"header": {}, "poses": [JSON_POSE]})).end == (4.0, 2.0)
    assert len(MapPath.from_text("0;map")) == 0
    assert MapPath.from_text("1,2;3,4;").points.tolist() == [[1.0, 2.0], [3.0, 4.0]]


@pytest.mark.parametrize("text", ["", "1;2;3", "1,2;x", "1,2,3", "0;map;1", "json:{}", 'json:{"poses": 3}'])
def test_what_is_no_path(text: str) -> None:
    with pytest.raises(ValueError):
        MapPath.from_text(text)


def test_paths_are_equal_by_their_poses() -> None:
    points = np.array([(0.0, 0.0), (1.0, 0.0)])
    assert MapPath.along(points) == MapPath.along(points) and MapPath.along(points) != MapPath.along(points + 1.0)
    assert hash(MapPath.along(points)) == hash(MapPath.along(points))
    with pytest.raises(ValueError):
        MapPath.along(points).poses[0, 0] = 5.0
