"""The shipped worlds and robots go together: the robot stands free where its world puts it, and can drive off."""

from __future__ import annotations

from pathlib import Path

import pytest
from sim_worlds import run, shipped

import sim.worlds
from pluto_bt.maps.load import load_world
from sim import Simulator

WORLDS = sorted(Path(sim.worlds.__file__).parent.glob("*.xml"))


@pytest.mark.parametrize("path", WORLDS, ids=lambda path: path.stem)
def test_the_robot_stands_free_at_its_start(path: Path) -> None:
    world = load_world(path)
    simulator = Simulator(world, shipped(world.robot.platform or "atrv2"), 0)
    run(simulator, 2.0)
    assert simulator.clearance_m > 0.0
    assert simulator.collisions == []
    run(simulator, 2.0, 0.3, 0.2)
    assert simulator.distance_m > 0.3
