"""Runs repeat bit for bit, seeds differ, and what one sensor draws is no other sensor's business."""

from __future__ import annotations

from typing import Any

import msgspec
import pytest
from sim_worlds import at, box, plain, points, room, run, shipped

from drivers.records import Record
from pluto_bt.maps.platform import Platform
from pluto_bt.maps.script import FaultAction
from pluto_bt.maps.world import Actor, Marker, World
from sim import Simulator


def yard() -> World:
    """Things to see, somebody who walks, something that fails."""
    walker = Actor("person", 0.25, 1.0, True, points((3.0, 3.0), (-3.0, 3.0), (-3.0, -4.0)))
    script = (at(0.5, FaultAction("sonar", "garbage", for_s=0.5)),)
    return room(box("crate", 2.5, -1.0, 0.5, 0.7), actors=(walker,), markers=(Marker(1, 0.0, 0.0, 0.0),), script=script)


def everything_read(platform: Platform, seed: int) -> dict[str, list[Any]]:
    """All records of a short drive, as plain data, by device."""
    sim = Simulator(yard(), platform, seed)
    records: dict[str, list[Record]] = {name: [] for name in sim.devices}

    def read() -> None:
        for name, device in sim.devices.items():
            records[name] += device.read()

    run(sim, 3.0, 0.5, 0.4, each=read)
    return {name: [plain(record) for record in found] for name, found in records.items()} | {"truth": [sim.pose, sim.min_clearance_m]}


@pytest.mark.parametrize("name", ["atrv2", "car", "jbot", "pioneer"])
def test_the_same_seed_gives_the_same_bits_and_another_seed_does_not(name: str) -> None:
    first, second, other = (everything_read(shipped(name), seed) for seed in (4, 4, 5))
    assert first == second
    assert all(first[device] != other[device] for device in first if device not in ("wrist", "truth"))


def test_a_sensor_that_is_taken_away_changes_nothing_for_the_others() -> None:
    whole = shipped("atrv2")
    full = everything_read(whole, 7)
    for gone in ("laser", "sonar", "dmu", "gps", "compass", "bumpers"):
        fewer = everything_read(msgspec.structs.replace(whole, devices=msgspec.structs.replace(whole.devices, **{gone: None})), 7)
        assert {name: fewer[name] for name in fewer if name != "base"} == {name: full[name] for name in fewer if name != "base"}
        kinds = {record[0] for record in fewer["base"]}
        assert fewer["base"] == [record for record in full["base"] if record[0] in kinds]


def test_the_size_of_the_calls_does_not_matter() -> None:
    fine, coarse = (Simulator(yard(), shipped("atrv2"), 1) for _ in range(2))
    for sim, step_s in ((fine, 0.01), (coarse, 0.05)):
        for i in range(round(4.0 / step_s) + 1):
            sim.step(i * step_s)
            if i * step_s in (0.0, 0.25, 0.5, 0.75, 1.0):
                sim.devices["base"].drive(0.6, 0.3)  # type: ignore[attr-defined]
    assert fine.pose == coarse.pose
    assert [plain(r) for r in fine.devices["laser"].read()] == [plain(r) for r in coarse.devices["laser"].read()]


def test_time_between_ticks_waits_for_the_next_tick() -> None:
    sim = Simulator(yard(), shipped("pioneer"), 0)
    sim.step(0.0199)
    assert sim.time_s == 0.01
    sim.step(0.02)
    assert sim.time_s == 0.02
