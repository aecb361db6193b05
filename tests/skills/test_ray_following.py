"""One ray followed over hand-made maps."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.skills.local_map import LocalMap
from pluto_bt.skills.motion_parameters import MotionParameters
from pluto_bt.skills.outline import Planar
from pluto_bt.skills.ray_following import GO, LOST, REPLAN_S, TURN, RayFollowing
from pluto_bt.skills.rays import Openings
from pluto_bt.skills.ways import Way

LEAST_M, ROOM_M = 0.675, 0.87


def doorway(half_width_m: float) -> LocalMap:
    """A wall along x = 0 with a door around y = 0."""
    map = LocalMap(MotionParameters())
    for y_m in np.arange(-8.0, 8.0, 0.5 * map.cell_m).tolist():
        if abs(y_m) > half_width_m:
            map.evidence[map.cell(0.0, y_m)] = 6
    map.changed_around(0.0, 0.0, 10.0)
    map.refresh(0.0)
    return map


def line(a: tuple[float, float], b: tuple[float, float]) -> Way:
    return Way(np.linspace(a, b, 1 + math.ceil(math.dist(a, b) / 0.25)))


def second_thoughts(map: LocalMap, robot: Planar, later: Way | None) -> str:
    """What a robot does on its way from (-3, 0) to (3, 0) when, at `robot`, it would now go another way."""
    following = RayFollowing(map, LEAST_M, ROOM_M, Openings(map))
    following.begin(line((-3.0, 0.0), (3.0, 0.0)), lambda: later, 0.0, (-3.0, 0.0, 0.0))
    return following.step(REPLAN_S, robot, 0.3, None).kind


def test_a_robot_in_a_doorway_goes_on_to_where_it_can_turn_back() -> None:
    back = line((0.0, 0.0), (-3.0, 0.0))
    assert second_thoughts(doorway(0.75), (0.0, 0.0, 0.0), back) == GO
    assert second_thoughts(doorway(0.75), (0.0, 0.0, 0.0), None) == GO
    assert second_thoughts(doorway(2.0), (0.0, 0.0, 0.0), back) == TURN
    assert second_thoughts(doorway(2.0), (0.0, 0.0, 0.0), None) == LOST


def test_what_leads_on_is_taken_in_a_doorway_too() -> None:
    map = doorway(0.75)
    following = RayFollowing(map, LEAST_M, ROOM_M, Openings(map))
    following.begin(line((-3.0, 0.0), (3.0, 0.0)), lambda: line((0.0, 0.0), (2.0, 2.0)), 0.0, (-3.0, 0.0, 0.0))
    advice = following.step(REPLAN_S, (0.0, 0.0, 0.0), 0.3, None)
    assert advice.kind == GO and advice.point[1] > 0.5


def test_where_the_old_way_is_blocked_a_robot_in_a_doorway_turns() -> None:
    map = doorway(0.75)
    map.shut(2.5, 0.0, 0.4, 1.0)
    map.refresh(1.0)
    assert second_thoughts(map, (0.0, 0.0, 0.0), line((0.0, 0.0), (-3.0, 0.0))) == TURN
