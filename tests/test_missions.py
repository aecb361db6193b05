"""The shipped missions, played in the simulator with the whole robot software."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest


@pytest.mark.parametrize("seed", [1, 2])
def test_the_car_closes_the_loops_of_trip2_without_touching_anything(scenario: Any, seed: int) -> None:
    run = scenario("corridor.xml", mission="trip2.xml", platform="car", start="0.5,12,90", seed=seed, ports={"max_loops": 3})
    assert (run.result, run.blackboard["loops"], run.collisions) == ("SUCCESS", 3, 0)
    assert math.dist(run.final_pose[:2], run.estimated_pose[:2]) < 0.2


def test_a_patrol_reaches_its_goals_in_truth(scenario: Any) -> None:
    goals = [(8.0, 3.0), (13.5, 3.0), (8.0, 6.5)]
    run = scenario("yard.xml", mission="patrol.xml", seed=5, ports={"goals": ";".join(f"{x},{y}" for x, y in goals)})
    assert (run.result, run.blackboard["reached"], run.blackboard["recoveries"], run.collisions) == ("SUCCESS", 3, 0, 0)
    for x, y in goals:
        assert min(math.dist(point.pose[:2], (x, y)) for point in run.track) < 0.3


def test_a_patrol_tries_a_goal_twice_and_then_says_why_it_ends(scenario: Any) -> None:
    run = scenario("yard.xml", mission="patrol.xml", seed=5, ports={"goals": "8,3;10,4.2;2,3.5"})
    assert (run.result, run.reason, run.collisions) == ("FAILURE", "stuck", 0)
    assert (run.blackboard["reached"], run.blackboard["recoveries"]) == (1, 1)


def test_an_obstacle_in_the_way_ends_the_trip_with_hindered(scenario: Any, tmp_path: Any) -> None:
    corridor = (Path(__file__).resolve().parents[1] / "sim/worlds/corridor.xml").read_text(encoding="utf-8")
    world = tmp_path / "blocked.xml"
    world.write_text(corridor.replace("</world>", '<script><at t="40"><place id="box" x="0.7" y="11"/></at></script></world>'), encoding="utf-8")
    run = scenario(str(world), mission="trip2.xml", platform="car", start="0.5,12,90", seed=1)
    assert (run.result, run.reason) == ("FAILURE", "hindered")
