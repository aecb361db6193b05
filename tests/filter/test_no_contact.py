"""Whatever the command: no contact by own motion with what stands and can be seen. The whole robot, with raw commands and A = 0."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pluto_bt.maps.world import Shape, World
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.skills.filter_parameters import FilterParameters
from tests.filter.whole_robot import WholeRobot, cluttered

FREE_M = {"atrv2": 1.1, "pioneer": 0.7, "jbot": 0.8}  # room to turn, as `assumed_clear_m` takes it to be


def hall(*more: Shape) -> World:
    return World("hall", shapes=(Shape("hall", "wall", np.array([(-6.0, -6.0), (6.0, -6.0), (6.0, 6.0), (-6.0, 6.0), (-6.0, -6.0)])), *more))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(("platform", "level"), [("atrv2", "drive"), ("atrv2", "filter"), ("pioneer", "drive"), ("pioneer", "filter")])
def test_random_commands_in_random_worlds_touch_nothing(platform: str, level: str, seed: int) -> None:
    rng = np.random.default_rng([seed, len(platform), len(level)])
    robot = WholeRobot(cluttered(rng, FREE_M[platform]), platform, (0.0, 0.0, float(rng.uniform(-3.0, 3.0))), seed, level)
    limits = robot.system.context.platform.limits
    while robot.now_s < 20.0:
        speed = rng.choice([-1.0, 0.0, 0.3, 1.0, 1.0]) * limits.max_speed_mps * rng.uniform(0.3, 1.2)
        turn_rate = rng.choice([-1.0, 0.0, 0.0, 1.0]) * math.radians(limits.max_turn_rate_dps) * rng.uniform(0.1, 1.1)
        robot.drive(speed, turn_rate, float(rng.uniform(0.3, 3.5)))
    simulator = robot.system.simulator
    assert simulator.collisions == []
    assert simulator.distance_m > 1.0, "it was not held for nothing"


@pytest.mark.parametrize("platform", ["atrv2", "pioneer"])
def test_full_speed_at_a_wall_ends_before_it_and_the_verdict_says_why(platform: str) -> None:
    robot = WholeRobot(hall(), platform, (0.0, 0.0, 0.0), level="filter")
    robot.drive(2.0, 0.0, 14.0)
    simulator = robot.system.simulator
    assert simulator.collisions == [] and abs(simulator.velocity[0]) < 1e-3
    assert 0.0 < simulator.clearance_m < 0.15
    assert (robot.verdict.reason, robot.verdict.element, robot.verdict.data[0]) == ("laser", (6,), pytest.approx(0.0, abs=0.02))
    assert "m from the outline" in robot.verdict.text and "2.00 m/s" in robot.verdict.text


def test_the_drive_shows_the_verdict_of_the_filter() -> None:
    robot = WholeRobot(hall(), "atrv2", (0.0, 0.0, 0.0))
    for _ in range(4):
        robot.drive(0.9, 0.0, 3.0)
    status = robot.value("drive/status")
    assert (status.reason, status.element[0]) == ("laser", 6)
    assert status.data == pytest.approx(robot.verdict.data)


def test_without_the_filter_the_wall_is_met() -> None:
    robot = WholeRobot(hall(), "atrv2", (0.0, 0.0, 0.0), level="filter", settings=["filter.enabled=false"])
    robot.drive(0.9, 0.0, 10.0)
    assert len(robot.system.simulator.collisions) >= 1


def test_it_backs_at_a_creep_where_nothing_was_seen_and_faster_where_it_came_from() -> None:
    robot = WholeRobot(hall(), "jbot", (0.0, 0.0, 0.0), level="filter")
    robot.drive(-0.5, 0.0, 8.0)
    slow = abs(robot.system.simulator.velocity[0])
    robot.drive(0.5, 0.0, 6.0)
    robot.drive(-0.5, 0.0, 2.5)
    assert slow <= FilterParameters().creep_mps + 0.01
    assert robot.system.simulator.velocity[0] < -0.4


def test_a_post_behind_that_was_never_seen_is_not_hit_harder_than_at_a_creep() -> None:
    robot = WholeRobot(hall(Shape("post", "circle", np.array([[-1.2, 0.0]]), 0.02)), "jbot", (0.0, 0.0, 0.0), level="filter")
    robot.drive(-0.9, 0.0, 22.0 + load_robot_file("jbot").filter.starter_s)  # as long as who started it may stand behind it, it hardly moves
    assert robot.system.simulator.collisions == []
    assert robot.system.simulator.hit_by, "no sensor of this robot looks behind: it creeps till it touches"


def test_a_post_that_was_seen_is_remembered_beside_and_behind_the_robot() -> None:
    """Past a thin post, then a turn on the spot: the corners of the outline would hit what no sensor sees any more."""
    robot = WholeRobot(hall(Shape("post", "circle", np.array([[1.5, 0.6]]), 0.02)), "atrv2", (0.0, 0.0, 0.0), level="filter")
    robot.drive(0.5, 0.0, 3.4)
    assert 1.2 < robot.system.simulator.pose[0] < 1.8
    robot.drive(0.0, 0.7, 4.0)
    robot.drive(0.0, -0.7, 8.0)
    assert robot.system.simulator.collisions == [] and robot.system.simulator.hit_by == []
    assert robot.verdict.reason in ("laser", "sonar")


def test_it_may_leave_and_slide_along_what_it_stands_close_to() -> None:
    robot = WholeRobot(hall(Shape("wall", "wall", np.array([(-3.0, 0.24), (5.0, 0.24)]))), "pioneer", (0.0, 0.0, 0.0), level="filter")
    robot.drive(0.3, 0.0, 4.0)
    assert robot.system.simulator.pose[0] > 0.5, "four centimetres beside a wall it goes on"
    robot.drive(0.2, -0.3, 5.0)
    assert robot.system.simulator.pose[2] < -0.3, "it turns away"
    assert robot.system.simulator.collisions == []


def test_the_car_has_no_eyes_and_passes() -> None:
    robot = WholeRobot(hall(), "car", (0.0, 0.0, 0.0), level="filter")
    robot.drive(0.5, 0.0, 2.0)
    assert robot.commanded == (0.5, 0.0)
    assert robot.verdict.reason == ""


def test_a_stopped_filter_lets_nothing_through() -> None:
    robot = WholeRobot(hall(), "atrv2", (0.0, 0.0, 0.0))
    robot.drive(0.5, 0.0, 1.0)
    robot.system.order_module("filter", False)
    robot.drive(0.5, 0.0, 1.0)
    assert robot.commanded == (0.0, 0.0)
    assert robot.system.inboxes["base"].post("tester", robot.value("ATRV2/Drive/Command")) == "wrong-state"
