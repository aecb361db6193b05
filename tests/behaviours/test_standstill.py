"""For how long a robot has come nowhere: what counts as coming away, and what does not count at all."""

from __future__ import annotations

import math

import pytest

from pluto_bt.behaviours.standstill import MOVED_M, MOVED_RAD, Standstill
from pluto_bt.runtime import VirtualClock
from tests.behaviours.conftest import FakeRobot

STEP_S = 0.1


@pytest.fixture
def robot() -> FakeRobot:
    return FakeRobot(VirtualClock())


def stood(robot: FakeRobot, watch: Standstill, seconds: float, held: bool = False) -> float:
    """Seconds that the watch tells after so many more in which the robot stays where it is."""
    told_s = 0.0
    for _ in range(round(seconds / STEP_S)):
        robot.clock.advance(STEP_S)
        told_s = watch.step(robot, robot.clock.now_s(), held)
    return told_s


def watching(robot: FakeRobot) -> Standstill:
    robot.is_at(0.0, 0.0)
    watch = Standstill(robot.clock.now_s())
    stood(robot, watch, STEP_S)
    return watch


@pytest.mark.parametrize(
    ("x", "y", "theta", "is_away"),
    [(0.9 * MOVED_M, 0.0, 0.9 * MOVED_RAD, False), (0.0, 1.1 * MOVED_M, 0.0, True), (0.0, 0.0, -1.1 * MOVED_RAD, True), (0.0, 0.0, math.tau, False)],
    ids=["wavers", "moves aside", "turns", "has turned once round"],
)
def test_time_begins_anew_only_where_the_robot_comes_away(robot: FakeRobot, x: float, y: float, theta: float, is_away: bool) -> None:
    watch = watching(robot)
    assert stood(robot, watch, 2.0) == pytest.approx(2.0)
    robot.is_at(x, y, theta)
    assert stood(robot, watch, 1.0) == pytest.approx(1.0 - STEP_S if is_away else 3.0)


def test_who_creeps_away_bit_by_bit_does_not_stand(robot: FakeRobot) -> None:
    watch = watching(robot)
    for k in range(100):
        robot.is_at(0.4 * MOVED_M * k, 0.0)
        assert stood(robot, watch, STEP_S) <= 3 * STEP_S


def test_while_something_holds_the_robot_no_time_passes(robot: FakeRobot) -> None:
    watch = watching(robot)
    stood(robot, watch, 5.0)
    assert stood(robot, watch, 5.0, held=True) == 0.0
    assert stood(robot, watch, 1.0) == pytest.approx(1.0)


def test_without_dead_reckoning_nobody_knows_whether_it_stands(robot: FakeRobot) -> None:
    watch = Standstill(0.0)
    assert stood(robot, watch, 5.0) == 0.0
    robot.is_at(0.0, 0.0)
    assert stood(robot, watch, 1.0) == pytest.approx(1.0 - STEP_S)
    del robot.values["Localization/Dead-Reckoning"]
    assert stood(robot, watch, 1.0) == 0.0
