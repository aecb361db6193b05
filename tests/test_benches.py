"""The benchmarks: all that the command names are there, and the simulator alone drives."""

from __future__ import annotations

from importlib import import_module

import pytest

from pluto_bt.bench.sim_step import STEP_S, Round, robot
from pluto_bt.commands.bench import BENCHES


@pytest.mark.parametrize("name", BENCHES)
def test_every_benchmark_is_there(name: str) -> None:
    module = import_module(f"pluto_bt.bench.{name.replace('-', '_')}")
    assert module.__doc__ and callable(module.run)


@pytest.mark.parametrize("scans", [True, False])
def test_the_simulator_alone_drives_with_the_shipped_robot(scans: bool) -> None:
    drive = Round(robot(scans))
    for _ in range(round(2.0 / STEP_S)):
        drive.step()
    assert drive.simulator.distance_m > 0.5 and ("laser" in drive.simulator.devices) == scans
