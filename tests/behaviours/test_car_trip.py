"""trip2 on an exact car: it closes its loop for ever, never leaves the corridor, and stops when it is hindered."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pluto_bt.maps.world import Area, World

TRIP2 = str(Path(__file__).resolve().parents[2] / "missions" / "trip2.xml")
CORRIDOR = World("corridor", areas=(Area("floor", "map", np.array([[0, 0], [3.13, 0], [3.13, 19.78], [0, 19.78]], dtype=float)),))
START = (0.5, 12.0, math.pi / 2)


def drive(stage: Any, car: Any, mission: Any, until: Any, limit_s: float = 2000.0) -> str:
    while True:
        car.advance(0.1)
        status = stage.tick(mission)
        if status != "RUNNING" or until(mission) or stage.clock.now_s() > limit_s:
            return str(status)


@pytest.mark.parametrize("seed", range(6))
def test_trip2_closes_its_loop(make_car: Any, seed: int) -> None:
    stage, car = make_car(seed, START, CORRIDOR)
    mission = stage.load(TRIP2, ports={"max_loops": "4"})
    assert drive(stage, car, mission, lambda m: False) == "SUCCESS"
    assert mission.blackboard["loops"] == 4
    assert car.box[0] > 0.0 and car.box[2] < 3.13 and car.box[1] > 0.0 and car.box[3] < 19.78
    assert stage.robot.commands[-1].velocity == (0.0, 0.0)


def test_trip2_runs_for_ever_unless_told_otherwise(make_car: Any) -> None:
    stage, car = make_car(1, START, CORRIDOR)
    mission = stage.load(TRIP2)
    assert drive(stage, car, mission, lambda m: m.blackboard["loops"] >= 2) == "RUNNING"


def test_a_car_that_is_held_is_hindered_and_the_trip_ends(make_car: Any) -> None:
    stage, car = make_car(2, START, CORRIDOR)
    mission = stage.load(TRIP2)
    drive(stage, car, mission, lambda m: car.y > 14.0)
    car.is_held, since_s = True, stage.clock.now_s()
    assert drive(stage, car, mission, lambda m: False) == "FAILURE"
    assert stage.clock.now_s() - since_s < 4.0
    assert stage.robot.commands[-1].velocity == (0.0, 0.0)
    assert "hindered" in _outputs(mission)


def test_between_motion_leaves_the_car_does_not_stop(make_car: Any) -> None:
    stage, car = make_car(3, START, CORRIDOR)
    mission = stage.load('<Sequence><CarGoTo goal="0.5;14"/><CarGoTo goal="0.5;17"/></Sequence>')
    slowest = []
    while (car.advance(0.1), stage.tick(mission))[1] == "RUNNING":
        if stage.clock.now_s() > 2.0:
            slowest.append(car.speed)
    assert min(slowest) > 0.45


def _outputs(mission: Any) -> str:
    return " ".join(str(getattr(node, "feedback", node)) for node in mission.node_states())
