"""The shipped platform files: they fit the declared tables, and their figures are possible."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import msgspec
import numpy as np
import pytest

import pluto_bt.platforms
from pluto_bt.maps.platform import Platform

FOLDER = Path(pluto_bt.platforms.__file__).parent
NAMES = sorted(path.stem for path in FOLDER.glob("*.toml"))
SENSORS = {
    "atrv2": "laser sonar bumpers dmu compass gps wrist arm", "car": "dmu marker speed steering", "jbot": "sonar imu", "pioneer": "laser sonar dmu",
}  # fmt: skip


def read(name: str) -> Platform:
    """The tables of `pluto_bt.maps.platform`; a file may hold tables of modules beside them."""
    tables = tomllib.loads((FOLDER / f"{name}.toml").read_text())
    return msgspec.convert({name: table for name, table in tables.items() if name in Platform.__struct_fields__}, Platform)


def test_there_are_the_four_robots_of_the_design() -> None:
    assert NAMES == ["atrv2", "car", "jbot", "pioneer"]


@pytest.mark.parametrize("name", NAMES)
def test_the_file_says_its_own_name_and_its_devices(name: str) -> None:
    platform = read(name)
    fitted = {field for field in platform.devices.__struct_fields__ if getattr(platform.devices, field) is not None}
    assert platform.name == name
    assert fitted == {"odometry", "battery", *SENSORS[name].split()}


@pytest.mark.parametrize("name", NAMES)
def test_the_outline_runs_counter_clockwise_around_the_origin(name: str) -> None:
    corners = np.array(read(name).body.outline_m)
    following = np.roll(corners, -1, axis=0)
    assert np.all(corners[:, 0] * following[:, 1] > corners[:, 1] * following[:, 0])


@pytest.mark.parametrize("name", NAMES)
def test_transducers_stand_on_or_in_the_outline_and_look_out(name: str) -> None:
    platform = read(name)
    corners = np.array(platform.body.outline_m)
    for transducer in platform.devices.sonar.transducers if platform.devices.sonar else ():
        assert abs(transducer.x_m) <= abs(corners[:, 0]).max() and abs(transducer.y_m) <= abs(corners[:, 1]).max()
        theta = math.radians(transducer.theta_deg)
        assert transducer.x_m * math.cos(theta) + transducer.y_m * math.sin(theta) > 0.0


def test_the_car_keeps_to_the_design() -> None:
    car = read("car")
    assert (car.body.min_turn_radius_m, car.body.min_turn_radius_percent) == (0.83, 90.0)
    assert car.limits.max_speed_mps <= 0.9
    tightest_m = 0.83 * 0.9
    assert math.radians(car.limits.max_turn_rate_dps) >= car.limits.max_speed_mps / tightest_m
