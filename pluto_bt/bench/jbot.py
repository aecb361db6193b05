"""The jBot figure: 1000 feet out and back between trees and picnic tables, and how far the robot then is from where it believes to be.

The article tells of ±5 ft in 1000 ft (0.5 %; DESIGN.md, section 9) with the heading of the orientation sensor. Beside it, in the same runs, the
wheels alone: the same encoders, reckoned with their own heading. The errors of wheels and sensor are in platforms/jbot.toml, with their sources.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from estimation.odometer import Odometer
from estimation.se2 import IDENTITY, Pose2, arc, compose
from pluto_bt.bench.row import BenchRow
from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.files import package_root
from pluto_bt.inputs.reading import Inputs
from pluto_bt.maps.world import Shape, World
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.runner import Runner, make_runner

FOOT_M = 0.3048
OUT_M = 500.0 * FOOT_M
SEEDS = 20
TARGET_PERCENT = 0.5
OBSTACLES, STRIP_M, APART_M = 60, 8.0, 4.0  # on both sides of the way, so that it must be left several times
LONGEST_S = 1500.0


@dataclass(frozen=True, slots=True)
class Journey:
    """One run out and back.

    Attributes:
        fused_percent, wheels_percent: distance between the true and the reckoned place at the end, by the way driven.
    """

    runner: Runner
    fused_percent: float
    wheels_percent: float

    @property
    def is_good(self) -> bool:
        """It came back without touching anything."""
        return self.runner.result.result == "SUCCESS" and self.runner.result.collisions == 0


class WheelsAlone:
    """Dead reckoning from `ATRV2/Drive/Raw` and nothing else, beside a run."""

    def __init__(self, runner: Runner) -> None:
        board = runner.system.board
        self.pose: Pose2 = IDENTITY
        self._raw = board.reader("ATRV2/Drive/Raw")
        self._odometer = Odometer(runner.system.options.robot.limits.max_speed_mps)
        board.on_change("ATRV2/Drive/Raw", self._step)

    def _step(self) -> None:
        sample = self._raw()
        if sample is not None and isinstance(sample.value, ActuatorState):
            step = self._odometer.step(sample.value.stamp_s, *sample.value.position)
            if step is not None:
                self.pose = compose(self.pose, arc(step[1], step[2]))


def field(seed: int, out_m: float) -> World:
    """A meadow with trees and picnic tables along the way from (0, 0) to (out_m, 0)."""
    rng = np.random.default_rng((seed, 3))
    places: list[tuple[float, float]] = []
    for _ in range(40 * OBSTACLES):
        x, y = float(rng.uniform(5.0, out_m - 5.0)), float(rng.uniform(-STRIP_M, STRIP_M))
        if len(places) < OBSTACLES * out_m / OUT_M and all(math.dist((x, y), other) > APART_M for other in places):
            places.append((x, y))
    return World("meadow", shapes=tuple(_thing(rng, i, x, y) for i, (x, y) in enumerate(places)))


def _thing(rng: np.random.Generator, i: int, x: float, y: float) -> Shape:
    """A tree, or now and then a table with its benches."""
    if rng.random() < 0.75:
        return Shape(f"tree{i}", "circle", np.array([(x, y)]), radius_m=float(rng.uniform(0.1, 0.4)))
    turn = float(rng.uniform(0.0, math.pi))
    c, s = math.cos(turn), math.sin(turn)
    corners = [(x + a * c - b * s, y + a * s + b * c) for a, b in ((-0.9, -0.7), (0.9, -0.7), (0.9, 0.7), (-0.9, 0.7))]
    return Shape(f"table{i}", "polygon", np.array(corners), height_m=0.75)


def journey(seed: int, out_m: float = OUT_M) -> Journey:
    """Drive out and back."""
    robot = load_robot_file("jbot")
    ports = {"goals": f"{out_m:.2f},0;0,0", "max_speed_mps": "0.9", "timeout_s": "700"}
    inputs = Inputs(package_root() / "missions" / "patrol.xml", field(seed, out_m), None, robot, (0.0, 0.0, 0.0), seed, ports, None)
    runner = make_runner(inputs, max_time_s=LONGEST_S)
    wheels = WheelsAlone(runner)
    result = runner.run()
    believed = result.estimated_pose or (math.nan, math.nan, math.nan)
    true = runner.system.simulator.pose
    fused_m, wheels_m = (math.dist(pose[:2], true[:2]) for pose in (believed, wheels.pose))
    return Journey(runner, 100.0 * fused_m / result.distance_m, 100.0 * wheels_m / result.distance_m)


def rows_of(journeys: Iterable[Journey]) -> list[BenchRow]:
    """The figures of some journeys."""
    done = list(journeys)
    fused, wheels = ([getattr(one, name) for one in done] for name in ("fused_percent", "wheels_percent"))
    collisions = sum(one.runner.result.collisions for one in done)
    way_m = float(np.mean([one.runner.result.distance_m for one in done]))
    note = f"{len(done)} seeds, {way_m:.0f} m each; worst {max(fused):.2f} %, median {np.median(fused):.2f} %"
    return [
        BenchRow("error by way, heading of the sensor, mean", float(np.mean(fused)), "%", f"<= {TARGET_PERCENT}", note),
        BenchRow("error by way, wheels alone, mean", float(np.mean(wheels)), "%", "", f"worst {max(wheels):.1f} %"),
        BenchRow("journeys that came back", 100.0 * sum(one.is_good for one in done) / len(done), "%", "100", f"collisions {collisions}"),
    ]


def run() -> list[BenchRow]:
    """Twenty journeys."""
    return rows_of(journey(seed) for seed in range(SEEDS))
