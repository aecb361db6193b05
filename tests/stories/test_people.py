"""People who walk past, from ahead, and round behind the robot, and yield to nobody: it may be hit, but it runs into nobody."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pluto_bt.bench.courses import Course
from pluto_bt.bench.patrols import Drive, drive
from pluto_bt.maps.world import Actor, Shape, World
from pluto_bt.modules.robot_file import load_robot_file

FENCE = Shape("fence", "wall", np.array([(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0), (-9.0, -9.0)]))


def among(platform: str, goal: tuple[float, float], speed_mps: float, walk: list[tuple[float, float]], max_time_s: float = 100.0) -> Drive:
    """From the middle of a field, looking east, to a goal, while one person walks."""
    person = Actor("person", 0.25, speed_mps, False, np.array(walk))
    course = Course((0.0, 0.0, 0.0), (goal,), math.hypot(*goal))
    return drive("field", World("field", shapes=(FENCE,), actors=(person,)), load_robot_file(platform), course, 1, max_time_s)


def touches(one: Drive) -> list[float]:
    """The robot's own speed at each collision."""
    return [contact["speed_mps"] for contact in one.runner.result.contacts if contact["kind"] == "collision"]


@pytest.mark.parametrize(("bearing_deg", "speed_mps"), [(-180, 1.0), (146, 1.3), (-180, 1.3), (-123, 0.8), (100, 0.6)])
def test_the_tail_does_not_swing_into_somebody_who_came_round_from_ahead(bearing_deg: int, speed_mps: float) -> None:
    """He walks past on the left or the right, is seen, and comes back to the tail, which no laser sees, while the robot turns round."""
    side, bearing = math.copysign(1.0, bearing_deg), math.radians(bearing_deg)
    behind = (1.8 * math.cos(bearing), 1.8 * abs(math.sin(bearing)) * side)
    one = among("atrv2", (-5.0, 0.8 * side), speed_mps, [(2.2, -1.2 * side), (0.0, -1.5 * side), behind, (0.0, 0.0), (6.0, -6.0)], 60.0)
    assert touches(one) == []


@pytest.mark.parametrize(("bearing_deg", "speed_mps"), [(-55, 1.3), (-39, 1.0), (-39, 1.3), (8, 1.0), (39, 1.3), (55, 1.3)])
def test_four_sonars_in_front_hear_who_comes_from_ahead_in_time(bearing_deg: int, speed_mps: float) -> None:
    bearing = math.radians(bearing_deg)
    one = among("jbot", (6.0, 0.0), speed_mps, [(1.5 + 4.0 * math.cos(bearing), 4.0 * math.sin(bearing)), (1.5, 0.0), (-6.0, -6.0)], 60.0)
    assert touches(one) == []


@pytest.mark.parametrize("platform", ["atrv2", "pioneer"])
def test_the_laser_sees_who_comes_from_ahead_and_the_goal_is_reached_behind_him(platform: str) -> None:
    one = among(platform, (6.0, 0.0), 1.0, [(5.3, 1.3), (1.5, 0.0), (-6.0, -6.0)])
    assert touches(one) == []
    assert one.runner.result.result == "SUCCESS", one.runner.result.text


def test_when_everybody_is_gone_it_drives_as_ever() -> None:
    alone = among("atrv2", (5.0, 5.0), 1.0, [(8.0, -8.0), (8.0, -8.5)])
    passed = among("atrv2", (5.0, 5.0), 1.2, [(2.5, -2.0), (2.5, -8.5)])
    assert passed.runner.result.result == "SUCCESS"
    assert passed.runner.result.sim_time_s < alone.runner.result.sim_time_s + 25.0
