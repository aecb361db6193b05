"""Laser, sonar and clearance: against the plain compiled baselines where these are present, and in microseconds a call."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pluto_bt.bench.baseline import load_baseline
from pluto_bt.bench.row import BenchRow, best_pair_us, best_us
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import Actor, OccupancyGrid, Shape, World

Array = NDArray[np.float64]

N_BEAMS = 361
FIRST_RAD, STEP_RAD = -math.pi / 2, math.pi / (N_BEAMS - 1)
GRID_RANGE_M, SHAPE_RANGE_M = 30.0, 80.0
OUTLINE = np.array([(0.5, 0.35), (-0.5, 0.35), (-0.5, -0.35), (0.5, -0.35), (0.6, 0.0)])


def run() -> list[BenchRow]:
    """All rows of this benchmark."""
    baselines = load_baseline("ray_baselines")
    rows = grid_rows(baselines) + segment_rows(baselines) if baselines else [
        BenchRow("ray baselines", math.nan, "", note="shared/bench/ray_baselines.py is not there: no ratios; PLUTO_SHARED names the folder `shared`")
    ]  # fmt: skip
    return rows + typical_rows()


def grid_rows(baselines: Any) -> list[BenchRow]:
    """Scans of 2000 x 2000 cells from a dozen places, against the walk from cell to cell."""
    rows = []
    for name in ("rooms_map", "open_map"):
        cells = getattr(baselines, name)()
        scene = Scene(World(name, grid=OccupancyGrid(cells, np.zeros_like(cells), 0.05, (0.0, 0.0, 0.0))))
        rng = np.random.default_rng(2)
        poses = [(50.0, 50.0, 0.0)] + [(float(x), float(y), float(a)) for x, y, a in rng.uniform((5, 5, -3), (95, 95, 3), (12, 3))]
        poses = [pose for pose in poses if not cells[int(pose[1] / 0.05), int(pose[0] / 0.05)]]

        def walk(pose: tuple[float, float, float], out_m: Array, cells: NDArray[np.uint8] = cells) -> None:
            baselines.grid_walk(cells, 0.05, *pose, FIRST_RAD, STEP_RAD, N_BEAMS, GRID_RANGE_M, out_m)

        rows += compare(f"scan of {name} / grid walk", scene, poses, walk, GRID_RANGE_M, "<= 0.25")
    return rows


def segment_rows(baselines: Any) -> list[BenchRow]:
    """Scans of 500 segments, against every beam with every segment."""
    rng = np.random.default_rng(3)
    starts = rng.uniform(-40, 40, (500, 2))
    segments = np.hstack((starts, starts + rng.normal(0, 3.0, (500, 2))))
    scene = Scene(World("segments", shapes=tuple(Shape(f"w{i}", "wall", row.reshape(2, 2)) for i, row in enumerate(segments))))

    def brute_force(pose: tuple[float, float, float], out_m: Array) -> None:
        baselines.segment_brute_force(segments, *pose, FIRST_RAD, STEP_RAD, N_BEAMS, SHAPE_RANGE_M, out_m)

    poses = [(float(x), float(y), float(a)) for x, y, a in rng.uniform((-30, -30, -3), (30, 30, 3), (6, 3))]
    return compare("scan of 500 segments / brute force", scene, poses, brute_force, SHAPE_RANGE_M, "<= 0.1")


def compare(
    name: str, scene: Scene, poses: list[tuple[float, float, float]], baseline: Callable[[tuple[float, float, float], Array], None],
    max_range_m: float, target: str,
) -> list[BenchRow]:  # fmt: skip
    """The ratio of times over all poses, and the largest difference of ranges."""
    angles, ours_m, theirs_m = fan(), np.zeros(N_BEAMS), np.zeros(N_BEAMS)
    ours_us, theirs_us, difference_m = 0.0, 0.0, 0.0
    for pose in poses:
        scan = partial(scene.scan, pose, 0.6, 0.0, angles, max_range_m, ours_m)
        one, other = best_pair_us(scan, partial(baseline, pose, theirs_m), 60)
        ours_us, theirs_us = ours_us + one, theirs_us + other
        difference_m = max(difference_m, float(np.abs(ours_m - theirs_m).max()))
    note = f"{ours_us / len(poses):.1f} us against {theirs_us / len(poses):.1f} us; ranges differ by {difference_m:.0e} m at most"
    return [BenchRow(name, ours_us / theirs_us, "x", target, note)]


def typical_rows() -> list[BenchRow]:
    """A yard of 60 walls, 10 trees and 3 people: one call of each question."""
    rng = np.random.default_rng(4)
    walls = tuple(Shape(f"w{i}", "wall", p + np.array([(0.0, 0.0), rng.normal(0, 2, 2)])) for i, p in enumerate(rng.uniform(-15, 15, (60, 2))))
    trees = tuple(Shape(f"t{i}", "circle", p.reshape(1, 2), 0.3) for i, p in enumerate(rng.uniform(-15, 15, (10, 2))))
    people = tuple(Actor(f"p{i}", 0.25, 1.0, True, p.reshape(1, 2)) for i, p in enumerate(rng.uniform(-15, 15, (3, 2))))
    scene = Scene(World("yard", shapes=walls + trees, actors=people))
    angles, ranges_m, sonar_m = fan(), np.zeros(N_BEAMS), np.zeros(12)
    x_m, y_m, theta_rad = 0.3 * np.cos(np.arange(12)), 0.3 * np.sin(np.arange(12)), np.arange(12) * math.pi / 6
    calls: list[tuple[str, Callable[[], object], str]] = [
        ("level scan, 361 beams", lambda: scene.scan((0.0, 0.0, 0.3), 0.6, 0.0, angles, SHAPE_RANGE_M, ranges_m), "<= 10"),
        ("tilted scan, 361 beams", lambda: scene.scan((0.0, 0.0, 0.3), 0.6, 0.2, angles, SHAPE_RANGE_M, ranges_m), "<= 10"),
        ("12 sonar cones", lambda: scene.cones(x_m, y_m, theta_rad, 0.4, 0.44, 8.0, sonar_m), "<= 10"),
        ("clearance", lambda: scene.clearance(OUTLINE), "<= 5"),
    ]
    return [BenchRow(name, best_us(call), "us", target, "60 walls, 10 circles, 3 actors") for name, call, target in calls]


def fan() -> Array:
    """The angles of a half-turn scan, read-only."""
    angles: Array = FIRST_RAD + STEP_RAD * np.arange(N_BEAMS, dtype=np.float64)
    angles.setflags(write=False)
    return angles
