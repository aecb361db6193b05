"""The odometry calibration: read from a file, written to the base when the drive starts."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from pluto_bt.maps.world import World
from pluto_bt.modules.calibration import read_calibration
from pluto_bt.modules.drive import Drive
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.scenario import Play
from pluto_bt.source import InputError
from sim.device import BaseDevice
from sim.simulator import Simulator

GOOD = "counts_per_m = 153099.0\neffective_track_m = 1.2  # grass\n"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "odometry.toml"
    path.write_text(GOOD, encoding="utf-8")
    return path


def test_a_calibration_has_two_numbers(file: Path) -> None:
    calibration = read_calibration(file, "odometry.toml")
    assert (calibration.counts_per_m, calibration.effective_track_m) == (153099.0, 1.2)


@pytest.mark.parametrize(
    ("text", "faults"),
    [
        ("counts_per_m = 0\neffective_track_m = nan\n", ["1:1 bad-value", "2:1 bad-value"]),
        ("counts_per_m = 1.0\n", ["0:0 missing-parameter"]),
        ("counts_per_m = 1.0\neffective_track_m = 1.0\ntrack = 2\n", ["3:1 unknown-parameter"]),
        ("counts_per_m = \n", ["1:16 toml-syntax"]),
    ],
)
def test_every_fault_of_the_file_is_told_at_its_place(file: Path, text: str, faults: list[str]) -> None:
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as error:
        load_robot_file("atrv2", (f"drive.calibration_file={file}",))
    assert [f"{fault.line}:{fault.column} {fault.code}" for fault in error.value.faults] == faults


def test_a_file_that_is_not_there_is_a_fault() -> None:
    with pytest.raises(InputError, match=r'there is no calibration file "nowhere\.toml"'):
        load_robot_file("atrv2", ("drive.calibration_file=nowhere.toml",))


def test_it_is_looked_for_beside_the_platform_file_too(file: Path) -> None:
    text = (Path(load_robot_file.__code__.co_filename).parents[1] / "platforms" / "atrv2.toml").read_text(encoding="utf-8")
    (file.parent / "mine.toml").write_text(text + '\n[drive]\ncalibration_file = "odometry.toml"\n', encoding="utf-8")
    assert load_robot_file(str(file.parent / "mine.toml")).drive.calibration_file == str(file)


def test_the_drive_writes_it_to_the_base_at_each_start_and_keeps_the_old_one_if_it_went_bad(make_rig: Any, file: Path) -> None:
    rig = make_rig()
    rig.context.platform = load_robot_file("atrv2", (f"drive.calibration_file={file}",))
    drive = Drive(rig.context)
    drive.start(0.0)
    assert rig.devices["base"].calibrated == (153099.0, 1.2)
    drive.stop()
    file.write_text(GOOD.replace("1.2", "1.3"), encoding="utf-8")
    drive.start(1.0)
    assert rig.devices["base"].calibrated == (153099.0, 1.3)
    drive.stop()
    file.write_text("counts_per_m = false", encoding="utf-8")
    drive.start(2.0)
    assert rig.devices["base"].calibrated == (153099.0, 1.3)
    assert "bad-calibration" in rig.codes()


def test_the_simulated_base_reckons_with_it_from_then_on() -> None:
    robot = load_robot_file("pioneer")
    simulator = Simulator(World("w"), robot, 0, ideal=False)
    base = simulator.devices["base"]
    assert isinstance(base, BaseDevice)
    figures = robot.devices.odometry
    ways = []
    for step in range(201):
        base.drive(0.5, 0.0)
        simulator.step(0.05 * step)
        ways += [record.distance_m for record in base.read() if hasattr(record, "distance_m")]
        if step == 100:
            at_once = ways[-1]
            base.calibrate(2.0 * figures.counts_per_m, robot.body.track_m)
    assert ways[-1] - at_once == pytest.approx(0.5 * 2.5, rel=0.05), "half of what it really drives"
    assert max(b - a for a, b in pairwise(ways)) < 0.02, "no jump"


def test_a_robot_with_a_wrong_calibration_file_thinks_that_it_went_farther(scenario: Play, tmp_path: Path) -> None:
    path = tmp_path / "odometry.toml"
    robot = load_robot_file("atrv2")
    path.write_text(f"counts_per_m = {0.8 * robot.devices.odometry.counts_per_m}\neffective_track_m = {robot.body.effective_track_m}\n")
    mission = tmp_path / "ahead.xml"
    mission.write_text('<root BTCPP_format="4"><BehaviorTree ID="T"><DriveVelocity speed_mps="0.4" distance_m="3"/></BehaviorTree></root>')
    run = scenario("ideal.xml", mission=str(mission), platform="atrv2", settings=(f"drive.calibration_file={path}",))
    assert run.result == "SUCCESS"
