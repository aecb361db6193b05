"""Scripts and faults: what happens at a time, on entering a place, and what each fault does to a device."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from sim_worlds import at, box, cart, everything, of_type, points, room, run, shipped

from drivers.records import (
    BumperRecord,
    CompassRecord,
    GpsRecord,
    InertialRecord,
    MarkerRecord,
    OdometryRecord,
    Record,
    ScanRecord,
    SonarRecord,
    SpeedRecord,
    WristRecord,
)
from pluto_bt.maps.script import Carry, FaultAction, Put, Remove, SetTopic, When
from pluto_bt.maps.world import Area, Marker, Terrain, World
from sim import Simulator, WristDevice

SQUARE = points((1.0, -1.0), (2.0, -1.0), (2.0, 1.0), (1.0, 1.0))


def with_fault(fault: FaultAction, start_s: float = 1.0) -> Simulator:
    """A robot in a room whose script has one fault. Marker readings are poor now and then by nature, so there it is the ideal robot."""
    world = room(script=(at(start_s, fault),), markers=(Marker(1, 0.0, 0.0, 0.0),))
    return Simulator(world, everything(), 0, ideal=fault.device == "marker")


def readings(sim: Simulator, kind: type[Record], device: str, seconds: float, speed: float = 0.0) -> list[Any]:
    """Records of one type while driving, read as they come."""
    found: list[Any] = []
    run(sim, seconds, speed, each=lambda: found.extend(of_type(sim.devices[device].read(), kind)))
    return found


STREAMS: dict[str, tuple[type[Record], str, Callable[[Any], float], float]] = {
    # device of the script: record, device of the robot, a number of the record, its value for a robot at rest at the origin
    "laser": (ScanRecord, "laser", lambda r: float(r.ranges_m[9]), 4.7),
    "sonar": (SonarRecord, "base", lambda r: r.ranges_m[0], 4.6),
    "bumpers": (BumperRecord, "base", lambda r: float(r.front), 0.0),
    "odometry": (OdometryRecord, "base", lambda r: r.distance_m, 0.0),
    "imu": (InertialRecord, "imu", lambda r: r.turn_rates_radps[2], 0.0),
    "compass": (CompassRecord, "compass", lambda r: r.heading_rad, 0.0),
    "gps": (GpsRecord, "gps", lambda r: r.x_m, 0.0),
    "wrist": (WristRecord, "wrist", lambda r: r.pan_rad, 0.0),
    "marker": (MarkerRecord, "marker", lambda r: r.x_m, 0.0),
    "speed": (SpeedRecord, "speed", lambda r: r.speed_mps, 0.0),
}


@pytest.mark.parametrize("device", list(STREAMS))
@pytest.mark.parametrize("kind", ["off", "frozen", "drop"])
def test_silence_and_frozen_readings_end_with_the_fault(device: str, kind: str) -> None:
    record, source, _, _ = STREAMS[device]
    sim = with_fault(FaultAction(device, kind, for_s=1.0))
    stamps = [reading.stamp_s for reading in readings(sim, record, source, 3.0)]
    during = [stamp for stamp in stamps if 1.0 <= stamp < 2.0]
    assert during == []
    assert [stamp for stamp in stamps if stamp < 1.0] and [stamp for stamp in stamps if stamp >= 2.0]
    repeated = len(stamps) - len(dict.fromkeys(stamps))
    assert (repeated >= 4) == (kind == "frozen")


@pytest.mark.parametrize("device", [device for device in STREAMS if device != "bumpers"])
@pytest.mark.parametrize(
    ("kind", "value", "check"),
    [
        ("nan", None, lambda number, healthy: math.isnan(number)),
        ("bias", 0.5, lambda number, healthy: number == pytest.approx(healthy + 0.5)),
        ("garbage", None, lambda number, healthy: abs(number - healthy) > 1.0),
        ("noise", 3.0, lambda number, healthy: number != healthy),
        ("stuck", 0.25, lambda number, healthy: number == 0.25),
    ],
)
def test_spoiled_numbers(device: str, kind: str, value: float | None, check: Callable[[float, float], bool]) -> None:
    record, source, number, healthy = STREAMS[device]
    sim = with_fault(FaultAction(device, kind, for_s=1.0, value=value))
    found = readings(sim, record, source, 3.0)
    during = [number(reading) for reading in found if 1.0 <= reading.stamp_s < 2.0]
    assert len(during) >= 5
    assert all(check(value, healthy) for value in during)
    assert all(number(reading) == pytest.approx(healthy) for reading in found if not 1.0 <= reading.stamp_s < 2.0)


@pytest.mark.parametrize(("device", "value"), [("bumpers", 1.0)])
def test_a_stuck_bumper_is_pressed_or_open(device: str, value: float) -> None:
    found = readings(with_fault(FaultAction(device, "stuck", for_s=1.0, value=value)), BumperRecord, "base", 3.0)
    assert {(r.front, r.back) for r in found if 1.0 <= r.stamp_s < 2.0} == {(True, True)}
    assert {(r.front, r.back) for r in found if not 1.0 <= r.stamp_s < 2.0} == {(False, False)}


def test_a_stuck_reading_keeps_its_number_and_not_its_stamp() -> None:
    found = readings(with_fault(FaultAction("odometry", "stuck", for_s=1.0)), OdometryRecord, "base", 3.0, 0.5)
    during = [reading for reading in found if 1.0 <= reading.stamp_s < 2.0]
    assert len({reading.distance_m for reading in during}) == 1
    assert len({reading.stamp_s for reading in during}) == len(during) == 50
    assert found[-1].distance_m == pytest.approx(3.0 * 0.5, abs=0.1)


def test_late_readings_keep_their_order() -> None:
    found = readings(with_fault(FaultAction("imu", "late", for_s=1.0, delay_s=0.3)), InertialRecord, "imu", 3.0)
    arrivals, stamps = [r.arrival_s for r in found], [r.stamp_s for r in found]
    assert stamps == sorted(stamps) and arrivals == sorted(arrivals)
    assert all(r.arrival_s == pytest.approx(r.stamp_s + 0.3) for r in found if 1.0 <= r.stamp_s < 2.0)
    assert all(r.arrival_s == r.stamp_s for r in found if r.stamp_s < 1.0 or r.stamp_s > 2.3)


def test_a_slow_device_sends_at_its_rate() -> None:
    found = readings(with_fault(FaultAction("laser", "slow", rate=2.0)), ScanRecord, "laser", 5.0)
    assert [r.stamp_s for r in found if r.stamp_s >= 1.0] == pytest.approx([1.0, 1.6, 2.2, 2.8, 3.4, 4.0, 4.6])  # the next scan after half a second


def test_half_the_readings_are_dropped() -> None:
    found = readings(with_fault(FaultAction("imu", "drop", rate=0.5), 0.0), InertialRecord, "imu", 20.0)
    assert len(found) == pytest.approx(500, abs=60)


def test_a_fatal_laser_sends_minus_one_for_twenty_seconds() -> None:
    found = readings(with_fault(FaultAction("laser", "fatal")), ScanRecord, "laser", 23.0)
    fatal = [r.stamp_s for r in found if (r.ranges_m == -1.0).all()]
    assert fatal == pytest.approx([1.0 + 0.2 * i for i in range(100)])
    assert all((r.ranges_m > 0).all() for r in found if r.stamp_s not in fatal)


def test_a_fault_may_name_its_beams() -> None:
    found = readings(with_fault(FaultAction("laser", "stuck", value=0.5, beams=(3, 7))), ScanRecord, "laser", 2.0)
    assert np.flatnonzero(found[-1].ranges_m == 0.5).tolist() == [3, 4, 5, 6, 7]


def test_a_blocked_base_stands_and_its_encoders_too() -> None:
    sim = with_fault(FaultAction("base", "blocked", for_s=1.0))
    readings(sim, OdometryRecord, "base", 1.0, 0.5)
    x = sim.pose[0]
    found = readings(sim, OdometryRecord, "base", 0.9, 0.5)
    assert sim.pose[0] == pytest.approx(x, abs=0.011)
    assert found[-1].distance_m == pytest.approx(found[2].distance_m)
    assert found[-1].speed_mps == 0.0
    run(sim, 1.0, 0.5)
    assert sim.pose[0] > x + 0.3


def test_slipping_wheels_count_what_the_body_does_not_drive() -> None:
    sim = with_fault(FaultAction("base", "slip", value=0.75), 0.0)
    found = readings(sim, OdometryRecord, "base", 3.0, 0.5)
    assert sim.distance_m == pytest.approx(0.25 * found[-1].distance_m, rel=0.01)


@pytest.mark.parametrize("kind", ["off", "hang"])
def test_a_base_that_is_lost_is_silent_and_stops(kind: str) -> None:
    sim = with_fault(FaultAction("base", kind))
    found = readings(sim, OdometryRecord, "base", 3.0, 0.5)
    assert found[-1].stamp_s < 1.0
    assert sim.velocity == (0.0, 0.0)
    assert sim.pose[0] == pytest.approx(0.5 + 0.5 * 0.28, abs=0.1)  # the dead-man: 0.3 s after the last command it heard


def test_a_stuck_wrist_does_not_move() -> None:
    sim = with_fault(FaultAction("wrist", "stuck", for_s=1.0))
    wrist = sim.devices["wrist"]
    assert isinstance(wrist, WristDevice)
    run(sim, 1.1)
    wrist.move(0.5, 0.0, 1.0, 2.0)
    run(sim, 0.8)
    assert wrist.pan.angle_rad == 0.0
    run(sim, 2.0)
    assert wrist.pan.angle_rad == 0.5


def test_faults_of_software_are_handed_up_with_their_end() -> None:
    fault, leaf = FaultAction("module:pose", "hang", for_s=0.5), FaultAction("leaf:GoTo", "raise")
    told: list[tuple[float, str, bool]] = []
    sim = Simulator(World("w", script=(at(1.0, fault, leaf),)), cart(), 0)
    sim.on_software_fault = lambda action, begins: told.append((sim.time_s, action.device, begins))
    run(sim, 3.0)
    assert told == [(1.0, "module:pose", True), (1.0, "leaf:GoTo", True), (1.5, "module:pose", False)]


def test_a_fault_of_a_device_that_the_robot_does_not_have_changes_nothing() -> None:
    faulty = Simulator(room(script=(at(0.5, FaultAction("gps", "off"), FaultAction("wrist", "stuck")),)), cart(), 0)
    assert run(faulty, 1.0, 0.5).pose == run(Simulator(room(), cart(), 0), 1.0, 0.5).pose


def test_actions_happen_at_their_time_in_the_order_of_the_file() -> None:
    told: list[tuple[float, str, str]] = []
    a, b, c, d, e = (SetTopic(topic, value) for topic, value in (("a", "1"), ("b", "2"), ("c", "3"), ("d", "4"), ("e", "5")))
    script = (at(2.0, a, b), at(1.005, c), at(2.0, d), at(0.0, e))
    sim = Simulator(World("w", script=script), cart(), 0)
    sim.on_set_topic = lambda topic, value: told.append((sim.time_s, topic, value))
    sim.step(0.0)
    assert told == [(0.0, "e", "5")]
    run(sim, 3.0)
    assert told[1:] == [(1.01, "c", "3"), (2.0, "a", "1"), (2.0, "b", "2"), (2.0, "d", "4")]


@pytest.mark.parametrize(("once", "times"), [(True, 1), (False, 2)])
def test_entering_a_place_sets_off_its_actions(once: bool, times: int) -> None:
    told: list[float] = []
    places = (Area("kitchen", "named", SQUARE),)
    sim = Simulator(World("w", areas=places, script=(When("kitchen", once, (SetTopic("world/alarm", "true"),)),)), cart(), 0)
    sim.on_set_topic = lambda topic, value: told.append(sim.pose[0])
    run(sim, 6.0, 0.5)
    run(sim, 6.0, -0.5)
    assert len(told) == times
    assert told[0] == pytest.approx(1.0, abs=0.011)


def test_terrains_are_places_too_and_who_starts_inside_has_entered() -> None:
    told: list[str] = []
    world = World("w", terrains=(Terrain("mud", SQUARE),), script=(When("mud", True, (SetTopic("world/alarm", "x"),)),))
    sim = Simulator(world, cart(), 0, start=(1.5, 0.0, 0.0))
    sim.on_set_topic = lambda topic, value: told.append(topic)
    sim.step(0.0)
    assert told == ["world/alarm"]


def test_removed_and_placed_things_are_gone_and_there_for_the_laser() -> None:
    script = (at(1.0, Remove("crate")), at(2.0, Put("crate", 3.0, 0.0)), at(3.0, Put("crate", None, None)))
    world = room(box("crate", 1.0, -0.5, 1.0, 1.0), script=script)
    robot = shipped("pioneer")
    sim = Simulator(world, robot, 0, ideal=True)
    ahead = {round(r.stamp_s, 1): r.ranges_m[180] for r in readings(sim, ScanRecord, "laser", 4.2)}
    assert [ahead[t] for t in (0.8, 1.0, 2.0, 3.0)] == pytest.approx([0.982, 4.982, 2.482, 0.982])


def test_a_robot_that_is_carried_stands_there_and_its_wheels_know_nothing_of_it() -> None:
    sim = Simulator(World("w", script=(at(1.0, Carry(3.0, -2.0, 1.5)), at(2.0, Carry(0.0, 0.0)))), cart(), 0)
    sim.step(1.5)
    assert sim.pose == pytest.approx((3.0, -2.0, 1.5))
    sim.step(2.5)
    assert sim.pose == pytest.approx((0.0, 0.0, 1.5)), "without an angle it points as before"
    assert [record.distance_m for record in sim.devices["base"].read() if isinstance(record, OdometryRecord)][-1] == 0.0
    assert sim.distance_m == 0.0
