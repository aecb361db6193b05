"""The sensor adapters: sick, dmu, imu, compass, gps, speed, wrist; and the arm."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from drivers.records import CompassRecord, GpsRecord, InertialRecord, ScanRecord, SpeedRecord, WristRecord
from pluto_bt.blackboard.messages import ActuatorState, CompassState, GpsState, read_only
from pluto_bt.modules.arm import Arm
from pluto_bt.modules.compass import Compass
from pluto_bt.modules.dmu import Dmu
from pluto_bt.modules.gps import Gps
from pluto_bt.modules.imu import Imu
from pluto_bt.modules.sick import Sick
from pluto_bt.modules.speed import Speed
from pluto_bt.modules.wrist import Wrist

LEVEL = (0.0, 0.0, 9.81)


def scan(stamp_s: float, ranges: Any) -> ScanRecord:
    return ScanRecord(stamp_s, stamp_s + 0.19, -math.pi / 2, math.pi / (len(ranges) - 1), read_only(ranges))


@pytest.mark.parametrize("n_beams", [361, 181, 721])
def test_three_interfaces_of_one_scan(make_rig: Any, n_beams: int) -> None:
    rig = make_rig()
    ranges = np.linspace(1.0, 5.0, n_beams)
    rig.devices["laser"].records = [scan(1.0, ranges)]
    Sick(rig.context).step(1.2)
    full, coarse, timing = rig.newest("sick/scan"), rig.newest("sick/rwi181"), rig.newest("sick/timing")
    assert (full.stamp_s, coarse.stamp_s, timing.stamp_s) == (1.0, 1.19, 1.0)
    assert (full.count, coarse.count, timing.count) == (n_beams, 181, n_beams)
    np.testing.assert_array_equal(full.ranges_m, ranges)
    np.testing.assert_array_equal(coarse.ranges_m, ranges[:: (n_beams - 1) // 180])
    assert coarse.angle_min_rad + 180 * coarse.angle_step_rad == pytest.approx(math.pi / 2)
    assert not full.ranges_m.flags.writeable and not coarse.ranges_m.flags.writeable


def test_a_fatal_error_is_minus_one_everywhere_and_said_once_each_way(make_rig: Any) -> None:
    rig = make_rig()
    sick = Sick(rig.context)
    for k, value in enumerate((2.0, -1.0, -1.0, 2.0)):
        rig.devices["laser"].records = [scan(0.2 * k, np.full(361, value))]
        sick.step(0.2 * k + 0.2)
        assert set(rig.newest("sick/rwi181").ranges_m) == {value}
    assert rig.codes() == ["laser-fatal", "laser-back"]


def test_a_scan_without_beams_is_none_and_one_with_a_single_beam_is_one(make_rig: Any) -> None:
    rig = make_rig()
    sick = Sick(rig.context)
    for k, n_beams in enumerate((0, 1, 0)):
        rig.devices["laser"].records = [ScanRecord(0.2 * k, 0.2 * k + 0.19, 0.0, 0.01, read_only(np.full(n_beams, 2.0)))]
        sick.step(0.2 * k + 0.2)
    assert (rig.newest("sick/scan").stamp_s, rig.newest("sick/scan").count, rig.newest("sick/timing").count) == (0.2, 1, 1)


def gyro(k: int, rate: float, theta: float = math.nan) -> InertialRecord:
    return InertialRecord(k * 0.02, k * 0.02, (0.0, 0.0, rate), LEVEL, theta, 0.0, 0.0)


def still(rig: Any, k: int, v: float = 0.0) -> None:
    rig.put("ATRV2/Drive/Raw", ActuatorState(k * 0.02, 0, velocity=(v, 0.0)), k * 0.02)


def test_the_bias_is_found_at_rest_and_taken_away(make_rig: Any) -> None:
    rig = make_rig()
    dmu = Dmu(rig.context)
    for k in range(1000):
        still(rig, k)
        rig.devices["dmu"].records = [gyro(k, 0.01)]
        dmu.step(k * 0.02)
        assert rig.newest("dmu/state").bias_known == (k == 999)
    turned = rig.newest("dmu/state").theta_rad
    for k in range(1000, 1100):
        still(rig, k, v=0.2)  # it moves now
        rig.devices["dmu"].records = [gyro(k, 0.51)]
        dmu.step(k * 0.02)
    state, raw = rig.newest("dmu/state"), rig.newest("dmu/raw")
    assert state.bias_radps == pytest.approx(0.01)
    assert state.theta_rad - turned == pytest.approx(0.5 * (2.0 - 0.04), abs=0.005)
    assert state.stamp_s == pytest.approx(raw.stamp_s - 0.04)
    assert raw.turn_rates_radps[2] == 0.51 and not raw.bias_known
    assert rig.codes() == ["gyro-bias-known"]


def test_a_robot_that_moves_during_the_bias_is_refused_and_said(make_rig: Any) -> None:
    rig = make_rig()
    dmu = Dmu(rig.context)
    for k in range(1400):
        still(rig, k, v=0.2 if 300 <= k < 310 else 0.0)
        rig.devices["dmu"].records = [gyro(k, 0.01)]
        dmu.step(k * 0.02)
    assert rig.codes() == ["gyro-bias-refused", "gyro-bias-known"]
    assert "moved" in rig.events[0][3]


def test_stop_and_go_is_told_once_and_then_only_when_much_was_lost(make_rig: Any) -> None:
    rig = make_rig()
    dmu = Dmu(rig.context)
    for k in range(1000):
        still(rig, k, v=0.2 if k % 10 == 9 and not 300 < k < 600 else 0.0)
        rig.devices["dmu"].records = [gyro(k, 0.01)]
        dmu.step(k * 0.02)
    assert rig.codes() == ["gyro-bias-refused"] * 2
    assert rig.events[0][0] == "info"


def test_without_a_word_from_the_wheels_nothing_passes_for_rest(make_rig: Any) -> None:
    rig = make_rig()
    dmu = Dmu(rig.context)
    rig.devices["dmu"].records = [gyro(k, 0.0) for k in range(1500)]
    dmu.step(30.0)
    assert not dmu.bias.known and dmu.bias.taken == 0


def test_an_absolute_sensor_knows_its_heading(make_rig: Any) -> None:
    rig = make_rig()
    imu = Imu(rig.context)
    rig.devices["imu"].records = [gyro(1, 0.1, theta=2.0)]
    imu.step(0.02)
    assert rig.newest("imu/state").theta_rad == 2.0 and rig.newest("imu/state").bias_known
    rig.devices["imu"].records = [gyro(2, 0.1)]
    imu.step(0.04)
    assert not rig.newest("imu/state").bias_known


def test_small_sensors_and_readings_that_are_not_numbers(make_rig: Any) -> None:
    rig = make_rig()
    adapters = {"compass": Compass(rig.context), "gps": Gps(rig.context), "speed": Speed(rig.context)}
    good = {"compass": CompassRecord(1.0, 1.0, 0.5), "gps": GpsRecord(1.0, 1.0, 3.0, 4.0, 7, 2), "speed": SpeedRecord(1.0, 1.0, 0.25)}
    bad = {
        "compass": CompassRecord(2.0, 2.0, math.nan),
        "gps": GpsRecord(2.0, 2.0, math.inf, 4.0, 7, 2),
        "speed": SpeedRecord(2.0, 2.0, math.nan),
    }
    for name, adapter in adapters.items():
        rig.devices[name].records = [good[name], bad[name], bad[name]]
        adapter.step(2.0)
    assert rig.newest("compass/state") == CompassState(1.0, 0.5)
    assert rig.newest("gps/state") == GpsState(1.0, 3.0, 4.0, 7, 2)
    assert rig.newest("car/speed").speed_mps == 0.25
    assert rig.codes() == ["bad-compass", "bad-gps", "bad-speed"]


def point(rig: Any, position: tuple[float, float], velocity: tuple[float, float], acceleration: tuple[float, float]) -> None:
    rig.context.inboxes["wrist"].post("mission", ActuatorState(0.0, 0, position, velocity, acceleration))


def test_an_axis_moves_only_with_velocity_and_acceleration_above_zero(make_rig: Any) -> None:
    rig = make_rig()
    wrist, moved = Wrist(rig.context), rig.devices["wrist"].driven
    point(rig, (0.5, 0.2), (0.3, 0.3), (0.0, 0.0))
    wrist.step(0.0)
    assert moved == [] and rig.newest("wrist/command") is None
    point(rig, (0.5, 0.2), (0.3, 0.0), (1.0, 1.0))
    wrist.step(0.1)
    assert moved == [(0.5, 0.0, 0.3, 1.0)]
    point(rig, (9.0, -9.0), (99.0, 0.5), (99.0, 99.0))
    wrist.step(0.2)
    assert moved[-1] == pytest.approx((1.0, -1.0, 0.5, math.radians(120)), abs=1e-3)
    assert rig.newest("wrist/command").position == pytest.approx((1.0, -1.0), abs=1e-3)


NAN, REST = math.nan, (0.0, 0.0)


@pytest.mark.parametrize(
    ("position", "velocity", "acceleration"),
    [((NAN, 0.0), (0.3, 0.3), (1.0, 1.0)), ((0.5, 0.2), (NAN, 0.3), (1.0, 1.0)), ((0.5, 0.2), (0.3, 0.3), (1.0, NAN)), ((0.5,), REST, REST)],
    ids=["no angle", "no rate", "no acceleration", "half a pair"],
)
def test_a_command_that_makes_no_sense_moves_no_axis_and_is_told_once(make_rig: Any, position: Any, velocity: Any, acceleration: Any) -> None:
    rig = make_rig()
    wrist, moved = Wrist(rig.context), rig.devices["wrist"].driven
    for k in range(3):
        point(rig, position, velocity, acceleration)
        wrist.step(0.1 * k)
    assert moved == [] and rig.codes() == ["bad-command"]
    point(rig, (0.5, NAN), (0.3, 0.0), (1.0, 0.0))
    wrist.step(0.3)
    assert len(moved) == 1, "an axis that is not to move needs no angle"
    point(rig, position, velocity, acceleration)
    wrist.step(0.4)
    assert rig.codes() == ["bad-command"] * 2


def test_an_arm_is_told_how_far_to_unfold_by_a_number_or_stays_and_says_so(make_rig: Any) -> None:
    rig = make_rig()
    arm, inbox = Arm(rig.context), rig.context.inboxes["arm"]
    arm.start(0.0)
    inbox.post("mission", ActuatorState(0.0, 0, (0.4, 0.0)))
    arm.step(100.0)
    for k in range(2):
        inbox.post("mission", ActuatorState(0.0, 0, (NAN, 0.0)))
        arm.step(101.0 + k)
    assert rig.newest("arm/state").position[0] == pytest.approx(0.4)
    assert rig.codes() == ["bad-command"]


def test_a_stop_holds_the_wrist_where_it_is(make_rig: Any) -> None:
    rig = make_rig()
    wrist = Wrist(rig.context)
    rig.devices["wrist"].records = [WristRecord(0.1, 0.1, 0.25, -0.1, 0.3, 0.0)]
    wrist.step(0.1)
    rig.context.inboxes["wrist"].stop("operator", 0.1)
    wrist.step(0.2)
    assert rig.devices["wrist"].driven[-1][:2] == (0.25, -0.1)
    assert rig.newest("wrist/state").velocity == (0.3, 0.0)
