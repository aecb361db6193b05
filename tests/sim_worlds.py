"""Worlds, robots and drivers for the simulator's tests: made in code, small, with figures that make closed forms easy."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
from numpy.typing import NDArray

import pluto_bt.platforms
from drivers.records import Record
from pluto_bt.maps.platform import (
    Body,
    Bumpers,
    Compass,
    Devices,
    Gps,
    Inertial,
    Laser,
    Limits,
    MarkerCamera,
    Odometry,
    Platform,
    Sonar,
    Transducer,
    WheelSpeed,
    Wrist,
)
from pluto_bt.maps.script import Action, At
from pluto_bt.maps.world import Shape, World
from sim import BaseDevice, Simulator

R = TypeVar("R", bound=Record)
STEP_S = 0.02


def points(*corners: tuple[float, float]) -> NDArray[np.float64]:
    """(n, 2) corners."""
    return np.array(corners, dtype=np.float64)


def box(id: str, x: float, y: float, width: float, depth: float, **more: Any) -> Shape:
    """A rectangle by its lower left corner."""
    return Shape(id, "polygon", points((x, y), (x + width, y), (x + width, y + depth), (x, y + depth)), **more)


def at(t_s: float, *actions: Action) -> At:
    """A line of a script."""
    return At(t_s, actions)


def shipped(name: str) -> Platform:
    """The body and devices of a platform file of the product; the tables of its modules are not the simulator's business."""
    tables = tomllib.loads((Path(pluto_bt.platforms.__file__).parent / f"{name}.toml").read_text())
    return msgspec.convert({name: table for name, table in tables.items() if name in Platform.__struct_fields__}, Platform)


def cart(**devices: Any) -> Platform:
    """A differential robot of 1.0 × 0.8 m with quick motors."""
    body = Body(kinematics="differential", outline_m=((0.5, 0.4), (-0.5, 0.4), (-0.5, -0.4), (0.5, -0.4)), track_m=0.6)
    limits = Limits(
        max_speed_mps=1.0, max_turn_rate_dps=90.0, acceleration_mps2=2.0, deceleration_mps2=2.0, turn_acceleration_dps2=720.0,
        motor_latency_s=0.0, motor_time_constant_s=0.0,
    )  # fmt: skip
    return Platform(name="cart", body=body, limits=limits, devices=Devices(**devices))


def everything() -> Platform:
    """A quick robot with every device there is, without noise."""
    devices: dict[str, Any] = {
        "laser": Laser(x_m=0.3, beams=19, arrival_delay_s=0.0, resolution_m=0.0),
        "sonar": Sonar(transducers=(Transducer(x_m=0.4, y_m=0.0, theta_deg=0.0),)),
        "bumpers": Bumpers(), "dmu": Inertial(), "imu": Inertial(absolute=True), "compass": Compass(), "gps": Gps(rate_hz=10.0),
        "wrist": Wrist(), "marker": MarkerCamera(delay_s=0.0, rate_hz=10.0), "speed": WheelSpeed(), "odometry": Odometry(),
    }  # fmt: skip
    assert {*devices, "battery", "steering", "arm"} == set(Devices.__struct_fields__), "the arm has no physics"
    return cart(**devices)


def plain(record: Record) -> tuple[Any, ...]:
    """A record to compare to the bit; NaN equals NaN."""
    values = (getattr(record, field) for field in record.__struct_fields__)
    return (type(record).__name__, *(value.tobytes() if isinstance(value, np.ndarray) else repr(value) for value in values))


def run(sim: Simulator, seconds: float, speed_mps: float = 0.0, turn_rate_radps: float = 0.0, each: Callable[[], None] | None = None) -> Simulator:
    """Step at 50 Hz with one command, repeated as a controller repeats it."""
    base = sim.devices["base"]
    assert isinstance(base, BaseDevice)
    first = round(sim.time_s / STEP_S)
    for i in range(first, first + round(seconds / STEP_S)):
        base.drive(speed_mps, turn_rate_radps)
        sim.step((i + 1) * STEP_S)
        if each:
            each()
    return sim


def of_type(records: Iterable[Record], kind: type[R]) -> list[R]:
    """Those of one type."""
    return [record for record in records if isinstance(record, kind)]


def room(*shapes: Shape, **more: Any) -> World:
    """A room of 10 × 10 m around the origin, with things in it."""
    walls = Shape("walls", "wall", points((-5, -5), (5, -5), (5, 5), (-5, 5), (-5, -5)))
    return World("room", shapes=(walls, *shapes), **more)
