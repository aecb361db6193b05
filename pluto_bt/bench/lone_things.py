"""Goto around single things: a field with one post, box, car or piece of wall just in the straight way to the goal."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from pluto_bt.bench.courses import Course
from pluto_bt.bench.patrols import PLATFORMS, Drive, drive
from pluto_bt.bench.random_places import Rng, lone_thing
from pluto_bt.bench.row import BenchRow
from pluto_bt.maps.world import World
from pluto_bt.modules.robot_file import load_robot_file

SEEDS = 34  # × 3 platforms = 102 gotos
LONGEST_S = 120.0


def drawn(seed: int) -> tuple[World, Course]:
    """A field, and a course of one leg from one side of the thing to the other, looking anywhere."""
    rng = np.random.default_rng((seed, 7))
    world = lone_thing(rng)
    return world, _course(rng)


def _course(rng: Rng) -> Course:
    bearing = float(rng.uniform(-math.pi, math.pi))
    before_m, behind_m = rng.uniform(2.8, 5.5, 2)
    aside_m = rng.uniform(-0.5, 0.5, 2)
    c, s = math.cos(bearing), math.sin(bearing)
    start = (-c * before_m - s * aside_m[0], -s * before_m + c * aside_m[0], float(rng.uniform(-math.pi, math.pi)))
    goal = (float(c * behind_m - s * aside_m[1]), float(s * behind_m + c * aside_m[1]))
    return Course(start, (goal,), math.dist(start[:2], goal))


def drives(seeds: range) -> Iterator[Drive]:
    """Each platform around each thing."""
    for seed in seeds:
        world, course = drawn(seed)
        for platform in PLATFORMS:
            yield drive("one thing in the way", world, load_robot_file(platform), course, seed, LONGEST_S)


def run() -> Iterator[BenchRow]:
    """How many goals were reached."""
    done = list(drives(range(SEEDS)))
    for platform in PLATFORMS:
        some = [one for one in done if one.platform == platform]
        good = sum(one.is_good for one in some)
        note = f"of {len(some)}; way × {np.mean([one.detour for one in some]):.2f}, pauses {sum(one.pauses for one in some)}"
        yield BenchRow(f"{platform}: goto around one thing", 100.0 * good / len(some), "%", ">= 98", note)
