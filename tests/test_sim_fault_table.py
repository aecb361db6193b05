"""Every row of the table of faults does something to the robot it is about, and stops doing so."""

from __future__ import annotations

from typing import Any

import pytest
from sim_worlds import at, everything, plain, room, run

from pluto_bt.maps.fault_table import FAULTS, NAMED, FaultRow
from pluto_bt.maps.script import FaultAction
from pluto_bt.maps.world import Marker
from sim import Simulator, WristDevice

ROWS = [row for row in FAULTS if row.device not in NAMED]
GIVEN: dict[str, Any] = {"value": 0.6, "rate": 0.4, "delay_s": 0.25}


def records_of_a_busy_run(*faults: FaultAction) -> dict[str, list[tuple[Any, ...]]]:
    """A run in which everything changes: it turns, pans its laser, and meets a wall while the fault (1 to 4 s) lasts."""
    sim = Simulator(room(script=(at(1.0, *faults),), markers=(Marker(1, 3.0, 0.0, 0.0),)), everything(), 0, start=(3.2, 0.0, 0.1))
    wrist = sim.devices["wrist"]
    assert isinstance(wrist, WristDevice)
    found: dict[str, list[tuple[Any, ...]]] = {name: [] for name in sim.devices} | {"truth": []}

    def read() -> None:
        for name, device in sim.devices.items():
            found[name] += [plain(record) for record in device.read()]
        found["truth"].append(sim.pose)

    wrist.move(-1.0, 0.2, 0.2, 1.0)
    run(sim, 3.0, 0.4, -0.1, each=read)
    run(sim, 2.0, 0.2, 0.0, each=read)
    return found


HEALTHY = records_of_a_busy_run()


@pytest.mark.parametrize("row", ROWS, ids=[f"{row.device} {row.kind}" for row in ROWS])
def test_the_row_shows_in_what_the_robot_sees_or_does(row: FaultRow) -> None:
    attributes = {"delay_s" if name == "delay" else name for name in row.needs}
    fault = FaultAction(row.device, row.kind, for_s=3.0, **{name: GIVEN[name] for name in sorted(attributes)})
    spoilt = records_of_a_busy_run(fault)
    device = {"sonar": "base", "bumpers": "base", "odometry": "base"}.get(row.device, row.device)
    assert spoilt[device] != HEALTHY[device]
    if row.device not in ("base", "odometry", "wrist"):
        others = [name for name in HEALTHY if name not in (device, "dmu")]
        assert [spoilt[name] for name in others] == [HEALTHY[name] for name in others]
    assert spoilt[device][-1][1] == HEALTHY[device][-1][1]  # after it, fresh readings again


@pytest.mark.parametrize("row", [row for row in ROWS if "value" in row.takes or "rate" in row.takes], ids=lambda row: f"{row.device} {row.kind}")
def test_what_may_be_given_makes_a_difference(row: FaultRow) -> None:
    name = "value" if "value" in row.takes else "rate"
    without = records_of_a_busy_run(FaultAction(row.device, row.kind, for_s=3.0))
    assert records_of_a_busy_run(FaultAction(row.device, row.kind, for_s=3.0, **{name: GIVEN[name]})) != without
