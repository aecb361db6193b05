"""The mapped area holds a robot that sees nothing."""

from __future__ import annotations

import numpy as np
import pytest

from pluto_bt.maps.world import Area, World
from pluto_bt.skills.limits import STILL
from pluto_bt.skills.map_area import MapArea
from pluto_bt.skills.map_hold import held_by_area
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
        ("nobody knows where it is", None, (0.5, 0.0), True),
    ],
)
def test_what_the_area_lets_through(name: str, pose: tuple[float, float, float] | None, twist: tuple[float, float], passes: bool) -> None:
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
