"""The mapped area holds a robot that sees nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.maps.world import Area, World
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.skills.limits import STILL
from pluto_bt.skills.map_area import MapArea
from pluto_bt.skills.map_hold import held_by_area
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
