"""What the jobs of motion share: how often a way that was shut is tried again, and what the coarse map takes while nobody asks it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pluto_bt.behaviours.surroundings import MOST_TRIES, Surroundings
from pluto_bt.blackboard.messages import LaserScan, Pose, read_only
from pluto_bt.runtime import VirtualClock
from pluto_bt.skills.motion_parameters import MotionParameters
from pluto_bt.skills.sight import ScanView
from tests.behaviours.conftest import SKID, FakeRobot

GOAL = (12.0, 0.0)


def in_a_yard_with_one_gate() -> Surroundings:
    """The robot stands in a yard of 12 m with a gate in front of it."""
    around = Surroundings(SKID, MotionParameters(), 0.1)
    map = around.map
    for x, y in ((-6.0, None), (6.0, None), (None, -6.0), (None, 6.0)):
        for k in np.arange(-6.0, 6.1, 0.5 * map.cell_m).tolist():
            at = (k if x is None else x, k if y is None else y)
            if not (x == 6.0 and abs(k) < 1.5):
                map.evidence[map.cell(*at)] = 6
    map.changed_around(0.0, 0.0, 10.0)
    map.refresh(0.0)
    return around


def shut_the_gate(around: Surroundings, now_s: float) -> None:
    around.map.shut(6.0, 0.0, 1.6, now_s)
    around.map.refresh(now_s)


def tries(around: Surroundings, goal: tuple[float, float] | None) -> int:
    """How often a way through the gate is found that proves to be shut each time."""
    for k in range(50):
        shut_the_gate(around, 1.0 + k)
        assert around.find(goal) is None
        if around.find_once_more(goal) is None:
            return k
    raise AssertionError("it never gives up")


def test_a_gate_that_is_the_only_way_to_the_goal_is_tried_again_some_times_in_a_job() -> None:
    around = in_a_yard_with_one_gate()
    assert tries(around, GOAL) == MOST_TRIES
    around.begin(None)
    assert tries(around, GOAL) == MOST_TRIES, "another job begins"


def test_new_ground_behind_a_gate_is_worth_one_more_try() -> None:
    around = in_a_yard_with_one_gate()
    i, j = around.map.cell(-6.0, -6.0)
    k, m = around.map.cell(6.0, 6.0)
    around.map.covered[i : k + 1, j : m + 1] = 1
    assert tries(around, None) == 1


@pytest.fixture
def robot() -> FakeRobot:
    return FakeRobot(VirtualClock())


def a_scan(stamp_s: float, tilt_rad: float = 0.0) -> ScanView:
    ranges = read_only(np.full(181, 3.0))
    return ScanView(LaserScan(stamp_s, -math.pi / 2, math.radians(1.0), ranges, 181), (0.0, 0.0, 0.0), tilt_rad)


def test_who_navigates_enters_each_scan_into_the_fine_map_and_one_a_second_into_the_coarse_one(robot: FakeRobot) -> None:
    around = Surroundings(SKID, MotionParameters(), 0.1)
    entered = {"coarse": 0, "fine": 0}
    coarse, fine = around.map.add, around.fine.add

    def count(name: str, add: object) -> object:
        def adding(*args: object) -> None:
            entered[name] += 1
            add(*args)  # type: ignore[operator]

        return adding

    around.map.add, around.fine.add = count("coarse", coarse), count("fine", fine)  # type: ignore[method-assign, assignment]
    for topic in ("Localization/Dead-Reckoning", "Localization/Pose"):
        robot.values[topic] = Pose(0.0, (0.0,) * 6, (0.0,) * 9)
    for k in range(10):
        robot.views = [a_scan(0.2 * k)]
        assert around.look(robot, 0.2 * k, only_finely=True)
    assert entered == {"coarse": 2, "fine": 10}
    robot.views = [a_scan(2.0, tilt_rad=0.2)]
    around.look(robot, 2.0, only_finely=True)
    assert entered == {"coarse": 3, "fine": 11}, "one that looks down goes into both"
    robot.views = [a_scan(2.1)]
    around.look(robot, 2.1)
    assert entered == {"coarse": 4, "fine": 12}, "somebody asks the coarse map"
