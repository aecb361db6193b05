"""Two things break at once, in places nobody tuned to: random pairs of faults, drawn from seeds, while a patrol drives.

Never a collision, never a success far from the goal, never a stop without a word, and the exit code that the outcome asks for.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pluto_bt.bench.courses import Course, Surveyor
from pluto_bt.bench.fault_plays import CAUSES, Play
from pluto_bt.bench.random_places import PLACES
from pluto_bt.bench.row import BenchRow
from pluto_bt.bench.why_score import Asked, Broken, questions
from pluto_bt.files import package_root
from pluto_bt.inputs.reading import Inputs
from pluto_bt.maps.script import At
from pluto_bt.maps.world import Shape, World
from pluto_bt.modules.robot_file import load_robot_file

PAIRS = 40
PLATFORMS = ("atrv2", "pioneer")
LEGS = 2
LONGEST_S = 300.0
MOST_ERROR_M = 1.0  # of a success; dead reckoning with a corrected sensor is not what it is with a good one
SURPRISE = Shape("surprise", "polygon", np.array([(0.0, 0.0), (0.5, 0.0), (0.5, 0.5), (0.0, 0.5)]), absent=True)


@dataclass(frozen=True)
class Pair:
    """Two faults in one place."""

    seed: int
    names: tuple[str, str]
    platform: str
    place: str
    play: Play
    asked: tuple[Asked, ...]

    @property
    def complaints(self) -> list[str]:
        """What must not be."""
        return self.play.complaints(MOST_ERROR_M)

    @property
    def text(self) -> str:
        """In one line."""
        result = self.play.result
        return f"{self.seed}: {self.names[0]} + {self.names[1]}, {self.platform}, {self.place}: {result.result} {result.reason}"


def play_pair(seed: int) -> Pair:
    """Draw place, course, faults and their times from a seed, run it, and ask `why` of its black box."""
    rng = np.random.default_rng((seed, 77))
    platform = PLATFORMS[int(rng.integers(len(PLATFORMS)))]
    robot = load_robot_file(platform)
    place, world, course = _somewhere(rng, robot.body.outline_m)
    first, second = (list(CAUSES)[int(i)] for i in rng.choice(len(CAUSES), 2, replace=False))
    script, broken = [], []
    for name in (first, second):
        where = (*course.goals[int(rng.integers(len(course.goals)))], float(rng.uniform(-3.0, 3.0)))
        for_s = float(rng.choice((0.0, 3.0, 8.0)))
        broken.append(Broken(name, round(float(rng.uniform(2.0, 9.0)), 2), 20.0 if name == "laser fatal" else for_s))
        script.append(At(broken[-1].at_s, (CAUSES[name](for_s, where),)))
    world = replace(world, shapes=(*world.shapes, SURPRISE), script=tuple(script))
    ports = {"goals": course.goals_text, "timeout_s": "60"}
    inputs = Inputs(package_root() / "missions" / "patrol.xml", world, None, robot, course.start, seed, ports, None)
    with tempfile.TemporaryDirectory() as folder:
        box = Path(folder) / "pair.mcap"
        play = Play(inputs, LONGEST_S, record=box)
        asked = questions(box, broken, play.result.result != "SUCCESS")
    return Pair(seed, (first, second), platform, place, play, tuple(asked))


def _somewhere(rng: np.random.Generator, outline_m: Iterable[tuple[float, float]]) -> tuple[str, World, Course]:
    while True:
        place = list(PLACES)[int(rng.integers(len(PLACES)))]
        world = PLACES[place](rng, int(rng.choice((0, 2))))
        course = Surveyor(world, tuple(outline_m)).course(rng, LEGS, bool(rng.integers(2)))
        if course is not None:
            return place, world, course


def run(pairs: int = PAIRS) -> list[BenchRow]:
    """The pairs, and every complaint in words."""
    played = [play_pair(seed) for seed in range(pairs)]
    bad = [pair for pair in played if pair.complaints]
    ends = sorted({pair.play.result.reason or "success" for pair in played})
    rows = [BenchRow("pairs of faults without a complaint", 100.0 * (1.0 - len(bad) / pairs), "%", "100", f"{pairs} pairs: {', '.join(ends)}")]
    asked = [(pair, one) for pair in played for one in pair.asked]
    wrong = [f"{pair.text}, {one.text}" for pair, one in asked if not one.is_right]
    share = 100.0 * (1.0 - len(wrong) / len(asked)) if asked else 100.0
    rows.append(BenchRow("  first causes that why names rightly", share, "%", ">= 95", "; ".join([f"{len(asked)} asked", *wrong])))
    rows.append(BenchRow("  collisions", sum(pair.play.result.collisions for pair in played), "", "0"))
    return rows + [BenchRow(f"  {pair.text}", len(pair.complaints), "", "0", "; ".join(pair.complaints)) for pair in bad]
