"""The car's trip2 a hundred times over: does it close its loop with noisy markers, a steering that misses and a gyro that drifts?

Marker noise (3 cm, 2°) and steering noise (5 %) are those of platforms/car.toml. The gyro drifts by 0.02 °/s from the start on, after its
bias has been measured, to the right in even seeds and to the left in odd ones. Markers hang as in the shipped corridor, or anywhere.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from pluto_bt.bench.row import BenchRow
from pluto_bt.bench.trip_faults import MUD, TROUBLES, blame, troubled
from pluto_bt.files import package_root
from pluto_bt.inputs.reading import Inputs
from pluto_bt.maps.load import load_world
from pluto_bt.maps.script import At, FaultAction
from pluto_bt.maps.world import Marker, World
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.result import RunResult
from pluto_bt.runner import make_runner

SEEDS, LOOPS = 40, 100
TROUBLED_SEEDS = 8  # of each trouble
TARGET_SEEDS = 38
DRIFT_DPS = 0.02
START = (0.5, 12.0, math.pi / 2)
LONGEST_LOOP_S = 90.0
WIDTH_M, LENGTH_M = 3.13, 19.78  # of the corridor
MARKERS, EDGE_M = 16, 0.1


def corridor(seed: int, anywhere: bool = False, drift_dps: float = DRIFT_DPS) -> World:
    """The shipped corridor with a drifting gyro; `anywhere`: its markers hang where the seed says, one in each stretch of its length."""
    world = load_world(package_root() / "sim" / "worlds" / "corridor.xml")
    drift = FaultAction("imu", "bias", value=math.radians(drift_dps) * (-1.0 if seed % 2 else 1.0))
    world = replace(world, script=(*world.script, At(0.0, (drift,))))
    if not anywhere:
        return world
    rng = np.random.default_rng((seed, 4))
    stretch_m = LENGTH_M / MARKERS
    hung = [(rng.uniform(EDGE_M, WIDTH_M - EDGE_M), (i + rng.uniform()) * stretch_m, rng.uniform(-math.pi, math.pi)) for i in range(MARKERS)]
    hung.append((rng.uniform(EDGE_M, 1.5), START[1] + rng.uniform(-1.0, 1.0), 0.0))  # without one in sight it would not even start
    return replace(world, markers=tuple(Marker(i, float(x), float(y), float(theta)) for i, (x, y, theta) in enumerate(hung)))


def trip(seed: int, loops: int = LOOPS, anywhere: bool = False, trouble: str = "") -> RunResult:
    """One trip of so many loops; `trouble`: a name of TROUBLES."""
    mission = package_root() / "missions" / "trip2.xml"
    world = corridor(seed, anywhere)
    world = troubled(world, trouble, seed) if trouble else world
    inputs = Inputs(mission, world, None, load_robot_file("car"), START, seed, {"max_loops": str(loops)}, None)
    return make_runner(inputs, max_time_s=LONGEST_LOOP_S * loops).run()


def rows_of(name: str, trips: Iterable[RunResult], target: str) -> list[BenchRow]:
    """The figures of some trips."""
    done = list(trips)
    good = [one for one in done if one.result == "SUCCESS" and one.collisions == 0]
    others = ", ".join(sorted({one.reason or one.result for one in done if one not in good}))
    loops = sum(int(one.blackboard["loops"]) for one in done)
    least_m = min(one.min_clearance_m for one in done if one.min_clearance_m is not None)
    note = f"{loops} loops; least clearance {least_m:.2f} m" + (f"; else {others}" if others else "")
    return [BenchRow(name, len(good), f"of {len(done)}", target, note)]


def troubled_rows() -> list[BenchRow]:
    """For each trouble how many of its trips did what none may do."""
    rows = []
    for name in (*TROUBLES, MUD):
        done = [trip(seed, 2, trouble=name) for seed in range(TROUBLED_SEEDS)]
        bad = [f"seed {one.seed} {word}" for one in done if (word := blame(name, one))]
        note = "; ".join([f"{sum(one.result == 'SUCCESS' for one in done)} closed their loops", *bad])
        rows.append(BenchRow(f"  {name}: wrong", len(bad), f"of {len(done)}", "<= 0", note))
    return rows


def run() -> list[BenchRow]:
    """Forty trips in the shipped corridor, forty shorter ones with markers hung at random, and some with a trouble each."""
    shipped = rows_of(f"seeds that close trip2 {LOOPS} times", (trip(seed) for seed in range(SEEDS)), f">= {TARGET_SEEDS}")
    drawn = rows_of("  20 times with markers anywhere", (trip(seed, LOOPS // 5, anywhere=True) for seed in range(SEEDS)), f">= {TARGET_SEEDS}")
    return [*shipped, *drawn, *troubled_rows()]
