"""The car's trip2 with one thing wrong, drawn by seed: who carries it, which sensor fails, what holds it.

Judged by what it claims: no SUCCESS whose position is off by more than 0.15 m, and no end for a reason that does not belong to what was wrong.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pluto_bt.maps.script import Action, At, Carry, FaultAction
from pluto_bt.maps.world import Terrain, World
from pluto_bt.result import RunResult

HONEST_M = 0.15  # so far a position may be off that is claimed
FIRST_S, LAST_S = 3.0, 45.0  # within the first loop
WALLS = frozenset({"hindered", "timeout", "outside-map"})  # of a car without eyes that stood elsewhere for a moment
Draw = np.random.Generator


class Trouble(NamedTuple):
    """What goes wrong, by a random draw, and the reasons with which the trip may end because of it."""

    draw: Callable[[Draw], Action]
    reasons: frozenset[str]


def _signed(rng: Draw, low: float, high: float) -> float:
    return float(rng.choice([-1.0, 1.0]) * rng.uniform(low, high))


def _carry(rng: Draw) -> Action:
    return Carry(float(rng.uniform(0.6, 2.5)), float(rng.uniform(3.0, 17.0)), float(rng.uniform(-math.pi, math.pi)))


TROUBLES = {
    "somebody carries it off": Trouble(_carry, WALLS | {"lost"}),
    "no marker for 10 s": Trouble(lambda rng: FaultAction("marker", "off", 10.0), frozenset()),
    "the camera repeats itself for 10 s": Trouble(lambda rng: FaultAction("marker", "stuck", 10.0), frozenset()),
    "markers are off for 2 s": Trouble(lambda rng: FaultAction("marker", "jump", 2.0, _signed(rng, 0.1, 1.0)), WALLS | {"lost"}),
    "the gyro's bias jumps": Trouble(lambda rng: FaultAction("imu", "jump", 0.0, _signed(rng, 0.02, 0.4)), WALLS | {"lost"}),
    "the gyro is silent for a while": Trouble(lambda rng: FaultAction("imu", "off", float(rng.uniform(0.5, 2.8))), frozenset()),
    "the gyro is gone": Trouble(lambda rng: FaultAction("imu", "off"), frozenset({"gyro-stale"})),
    "the gyro is stuck": Trouble(lambda rng: FaultAction("imu", "stuck"), WALLS | {"lost"}),
    "the wheel speed is silent for a while": Trouble(lambda rng: FaultAction("speed", "off", float(rng.uniform(0.5, 3.5))), frozenset()),
    "the wheel speed is gone": Trouble(lambda rng: FaultAction("speed", "off"), frozenset({"speed-stale"})),
    "something holds its wheels": Trouble(lambda rng: FaultAction("base", "blocked"), frozenset({"hindered", "timeout"})),
}
MUD = "its wheels slip in mud"


def troubled(world: World, name: str, seed: int) -> World:
    """The corridor with that trouble, at a time or a place that the seed draws."""
    rng = np.random.default_rng((seed, 5))
    if name == MUD:
        y = float(rng.uniform(3.0, 14.0))
        edge = np.array([[0.0, y], [4.0, y], [4.0, y + 3.0], [0.0, y + 3.0]])
        return replace(world, terrains=(*world.terrains, Terrain("mud", edge, slip=float(rng.uniform(0.2, 0.7)))))
    at = At(float(rng.uniform(FIRST_S, LAST_S)), (TROUBLES[name].draw(rng),))
    return replace(world, script=(*world.script, at))


def blame(name: str, run: RunResult) -> str:
    """What a trip may not do, "" if it did nothing of that."""
    may_end = frozenset() if name == MUD else TROUBLES[name].reasons
    if run.collisions and not may_end & WALLS:
        return f"touches something: {run.collisions} collisions"
    if run.result == "SUCCESS":
        assert run.final_pose is not None and run.estimated_pose is not None
        off_m = math.dist(run.final_pose[:2], run.estimated_pose[:2])
        return f"claims a position that is off by {off_m:.2f} m" if off_m > HONEST_M else ""
    return "" if run.reason in may_end else f"ends with {run.reason or run.result}"
