"""The simulator alone: an ATRV-2 drives round a yard with laser and sonar at 10 Hz, everything else at its own rate, noise on.

How many times faster than real time on one core; beside it, where that package is installed, the Python simulator `ir-sim` with the same
scan in a world as large (it has no sonar, encoders, inertial sensor or motor dynamics, so the comparison flatters it).
"""

from __future__ import annotations

import importlib
import importlib.util
import math
import tempfile
from pathlib import Path

import msgspec
import numpy as np

from pluto_bt.bench.row import BenchRow, best_us
from pluto_bt.maps.platform import Platform
from pluto_bt.maps.world import Actor, Shape, World
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.runtime.clock import wall_ns

STEP_S, CHUNK_S, CHUNKS = 0.02, 2.0, 20
SCAN_HZ = 10.0
STAGE = 400.0  # × real time that is said of Stage, in C++, with a laser at 10 Hz and sonar
IRSIM_STEPS = 200


def run() -> list[BenchRow]:
    """All rows of this benchmark."""
    factor = measured_factor()
    rows = [
        BenchRow("simulator alone", factor, "× real time", f">= {5 * STAGE:.0f}", f"laser and sonar at {SCAN_HZ:.0f} Hz, best of {CHUNKS} chunks"),
        BenchRow("  CPU of a simulated second", 1e3 / factor, "ms", "<= 2.5"),
        BenchRow("  to Stage's 400", factor / STAGE, "×", ">= 5", "Stage's figure is from elsewhere, not from this machine"),
        BenchRow("  a step at 50 Hz with base and odometry alone", bare_step_us(), "µs", "<= 15", "with contacts, clearance and two actors"),
    ]
    return [*rows, irsim_row(factor)]


def yard() -> World:
    """A fenced yard of 20 × 15 m: a house, eight trees, twelve boxes, two who walk."""
    shapes = [Shape("fence", "wall", corners((0, 0), (20, 0), (20, 15), (0, 15), (0, 0))), rectangle("house", 6, 6, 5, 4)]
    shapes += [Shape(f"tree{i}", "circle", corners((2 + 2 * i, 1.2 + (i % 2) * 11)), radius_m=0.15 + 0.02 * i) for i in range(8)]
    shapes += [rectangle(f"box{i}", 1 + 1.5 * i, 14, 0.6, 0.5) for i in range(12)]
    people = (Actor("one", 0.25, 1.0, True, corners((1, 13), (18, 13))), Actor("two", 0.25, 0.5, True, corners((13, 6), (18, 6), (18, 11))))
    return World("yard", shapes=tuple(shapes), actors=people)


def corners(*points: tuple[float, float]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """(n, 2) points."""
    return np.array(points, dtype=np.float64)


def rectangle(id: str, x: float, y: float, width: float, depth: float) -> Shape:
    """By its lower left corner."""
    return Shape(id, "polygon", corners((x, y), (x + width, y), (x + width, y + depth), (x, y + depth)))


def robot(scans: bool) -> Platform:
    """The shipped ATRV-2 with its laser at 10 Hz, or with its base alone."""
    platform = load_robot_file("atrv2")
    devices = platform.devices
    if scans and devices.laser is not None:
        devices = msgspec.structs.replace(devices, laser=msgspec.structs.replace(devices.laser, rate_hz=SCAN_HZ))
    else:
        devices = type(devices)(odometry=devices.odometry, battery=devices.battery)
    return msgspec.structs.replace(platform, devices=devices)


class Round:
    """A robot that drives circles between house and fence, and whose records are read as they come."""

    def __init__(self, platform: Platform) -> None:
        from sim import BaseDevice, Simulator

        self.simulator = Simulator(yard(), platform, seed=1, start=(4.0, 4.0, 0.3))
        base = self.simulator.devices["base"]
        assert isinstance(base, BaseDevice)
        self._base = base
        self._step = 0

    def step(self) -> None:
        """One step at 50 Hz."""
        simulator = self.simulator
        simulator.step(self._step * STEP_S)
        self._step += 1
        self._base.drive(0.5, 0.35)
        for device in simulator.devices.values():
            device.read()


def measured_factor() -> float:
    """Simulated seconds in a second of the fastest chunk of a drive."""
    drive, steps, best_ns = Round(robot(scans=True)), round(CHUNK_S / STEP_S), 1 << 62
    for _ in range(CHUNKS):
        start_ns = wall_ns()
        for _ in range(steps):
            drive.step()
        best_ns = min(best_ns, wall_ns() - start_ns)
    return CHUNK_S * 1e9 / best_ns


def bare_step_us() -> float:
    """Microseconds of a step of physics, contacts and odometry: the mean of fifty in the fastest round."""
    drive = Round(robot(scans=False))

    def fifty() -> None:
        for _ in range(50):
            drive.step()

    return best_us(fifty, 40) / 50


def irsim_row(factor: float) -> BenchRow:
    """The ratio to `ir-sim`, or a word that it is not there."""
    if importlib.util.find_spec("irsim") is None:
        return BenchRow("  to ir-sim", math.nan, "×", "", "the package ir-sim is not installed: no ratio")
    irsim = importlib.import_module("irsim")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "yard.yaml"
        file.write_text(IRSIM_YARD, encoding="utf-8")
        environment = irsim.make(str(file), display=False)
        environment.step()
        start_ns = wall_ns()
        for _ in range(IRSIM_STEPS):
            environment.step()
        theirs = IRSIM_STEPS / SCAN_HZ * 1e9 / (wall_ns() - start_ns)
        environment.end()
    return BenchRow("  to ir-sim", factor / theirs, "×", ">= 5", f"ir-sim: {theirs:.0f} × real time, 361 beams at 10 Hz")


IRSIM_YARD = """
world: {height: 15, width: 20, step_time: 0.1, sample_time: 0.1, offset: [0, 0], collision_mode: 'stop', control_mode: 'auto'}
robot:
  - kinematics: {name: 'diff'}
    shape: {name: 'rectangle', length: 1.17, width: 0.85}
    state: [4, 4, 0.3]
    goal: [18, 3, 0]
    behavior: {name: 'dash'}
    sensors:
      - {type: 'lidar2d', range_min: 0, range_max: 80, angle_range: 3.14159, number: 361, noise: True, std: 0.01, angle_std: 0.0}
obstacle:
  - {shape: {name: 'linestring', vertices: [[0, 0], [20, 0], [20, 15], [0, 15], [0, 0]]}, state: [0, 0, 0]}
  - {shape: {name: 'rectangle', length: 5, width: 4}, state: [8.5, 8, 0]}
  - {shape: {name: 'circle', radius: 0.2}, state: [2, 1.2, 0]}
  - {shape: {name: 'circle', radius: 0.2}, state: [6, 1.2, 0]}
  - {shape: {name: 'circle', radius: 0.2}, state: [10, 1.2, 0]}
  - {shape: {name: 'circle', radius: 0.2}, state: [14, 1.2, 0]}
"""
