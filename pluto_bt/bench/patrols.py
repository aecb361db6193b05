"""Patrols in places that nobody tuned to: random rooms, streets and woods, with and without people, and any world files given.

Every course can be driven by goto: each goal lies in a straight free way, or behind one thing with room to pass. What counts is that nothing
is touched by own motion, that the mission succeeds, and that the robot really comes to each goal, but for the drift of dead reckoning.
People walk through everything and yield to nobody: a patrol among them may end with a reason, but not with a collision.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pluto_bt.bench.courses import Course, Surveyor
from pluto_bt.bench.random_places import PLACES
from pluto_bt.bench.row import BenchRow
from pluto_bt.files import package_root
from pluto_bt.inputs.reading import Inputs
from pluto_bt.maps.world import World
from pluto_bt.modules.robot_file import RobotFile, load_robot_file
from pluto_bt.runner import Runner, make_runner

PLATFORMS = ("pioneer", "atrv2", "jbot")
SEEDS = 17  # × 3 kinds of places × 3 platforms × without and with people = 306 worlds
PEOPLE = 3
LEGS = 3
LONGEST_S = 900.0
TOLERANCE_M, DRIFT = 0.3, 0.02  # of patrol.xml; and the share of the way that dead reckoning may be off
Track = NDArray[np.float64]  # (n, 4) t s, x m, y m, theta rad
SLOW_MPS, TURNING_RADPS, PAUSE_S = 0.05, 0.1, 0.5


@dataclass(frozen=True, slots=True)
class Drive:
    """One patrol and what it came to.

    Attributes:
        goal_error_m: how far the robot passed the goals by, the worst of them, in truth.
        allowed_m: tolerance and drift for the way driven.
        detour: the way driven by the length of the course.
        pauses: how often it stood for a while that was no arrival.
    """

    place: str
    platform: str
    seed: int
    course: Course
    runner: Runner
    goal_error_m: float
    allowed_m: float
    detour: float
    pauses: int

    @property
    def is_good(self) -> bool:
        """It succeeded, touched nothing, and was where it said."""
        result = self.runner.result
        return result.result == "SUCCESS" and result.collisions == 0 and self.goal_error_m <= self.allowed_m


def drive(place: str, world: World, robot: RobotFile, course: Course, seed: int, max_time_s: float = LONGEST_S) -> Drive:
    """Run `patrol.xml` over a course."""
    ports = {"goals": course.goals_text}
    inputs = Inputs(package_root() / "missions" / "patrol.xml", world, None, robot, course.start, seed, ports, None)
    runner = make_runner(inputs, max_time_s=max_time_s)
    result = runner.run()
    track = np.array([(point.t_s, *point.pose) for point in runner.system.track.points])
    allowed_m = TOLERANCE_M + DRIFT * result.distance_m
    error_m = _worst_goal_error_m(track, course, allowed_m)
    return Drive(place, robot.name, seed, course, runner, error_m, allowed_m, result.distance_m / course.length_m, _pauses(track))


def drives(worlds: Iterable[tuple[str, World]], platforms: Iterable[str], seed: int) -> Iterator[Drive]:
    """Patrols of each platform in each world, straight ones and ones around things; none where there is no room."""
    for i, (place, world) in enumerate(worlds):
        for j, platform in enumerate(platforms):
            robot = load_robot_file(platform)
            surveyor = Surveyor(world, robot.body.outline_m)
            for around in (False, True):
                course = surveyor.course(np.random.default_rng((seed, i, j, around)), LEGS, around)
                if course is not None:
                    yield drive(f"{place}{', around things' if around else ''}", world, robot, course, seed)


def random_worlds(seed: int, people: int) -> list[tuple[str, World]]:
    """One place of each kind."""
    crowd = " with people" if people else ""
    return [(name + crowd, make(np.random.default_rng((seed, k, people)), people)) for k, (name, make) in enumerate(PLACES.items())]


def _worst_goal_error_m(track: Track, course: Course, allowed_m: float) -> float:
    """The goals in turn: how near the robot really came to each, from where it had come near the one before."""
    worst_m, since = 0.0, 0
    for x, y in course.goals:
        away_m = np.hypot(track[since:, 1] - x, track[since:, 2] - y)
        near = np.flatnonzero(away_m <= allowed_m)
        since += int(near[0]) if len(near) else 0
        worst_m = max(worst_m, float(np.min(away_m)))
    return worst_m


def _pauses(track: Track) -> int:
    """How often the robot stood for longer than `PAUSE_S`, the start left out."""
    dt_s = np.maximum(np.diff(track[:, 0]), 1e-3)
    rests = (np.hypot(np.diff(track[:, 1]), np.diff(track[:, 2])) < SLOW_MPS * dt_s) & (
        np.abs(np.remainder(np.diff(track[:, 3]) + np.pi, 2 * np.pi) - np.pi) < TURNING_RADPS * dt_s
    )
    count, rested_s, has_moved = 0, 0.0, False
    for is_at_rest, step_s in zip(rests.tolist(), dt_s.tolist(), strict=True):
        if not is_at_rest:
            has_moved = True
            rested_s = 0.0
        elif rested_s < PAUSE_S <= rested_s + step_s and has_moved:
            count += 1
        rested_s += step_s if is_at_rest else 0.0
    return count


def campaign(seeds: Iterable[int], people: int, platforms: Iterable[str] = PLATFORMS) -> Iterator[Drive]:
    """One patrol of each platform in each place; straight ones where the seed is even, around things where it is odd."""
    for seed in seeds:
        for i, (place, world) in enumerate(random_worlds(seed, people)):
            for j, platform in enumerate(platforms):
                robot = load_robot_file(platform)
                surveyor = Surveyor(world, robot.body.outline_m)
                for around in (seed % 2 == 1, seed % 2 == 0):
                    course = surveyor.course(np.random.default_rng((seed, i, j, around)), LEGS, around)
                    if course is not None:
                        yield drive(place, world, robot, course, seed)
                        break


def rows_of(done: Iterable[Drive]) -> list[BenchRow]:
    """A line for each kind of place and platform: the collisions, and what else came of it."""
    groups: dict[str, list[Drive]] = {}
    for one in done:
        groups.setdefault(f"{one.platform}: {one.place}", []).append(one)
    return [_row(name, some) for name, some in groups.items()]


def _row(name: str, some: list[Drive]) -> BenchRow:
    results = [one.runner.result for one in some]
    good = sum(one.is_good for one in some)
    reasons = Counter(result.reason for result in results if result.result != "SUCCESS")
    others = "".join(f", {count} × {reason}" for reason, count in sorted(reasons.items()))
    note = f"{good} of {len(some)} good{others}; hit by others {sum(result.hit_by for result in results)} ×"
    note += f", mean {np.mean([result.sim_time_s for result in results]):.0f} s, way × {np.mean([one.detour for one in some]):.2f}"
    return BenchRow(name, sum(result.collisions for result in results), "collisions", "0", note)


def run() -> Iterator[BenchRow]:
    """The random places, quiet and with people."""
    for people in (0, PEOPLE):
        yield from rows_of(campaign(range(SEEDS), people))


__all__ = ["Drive", "campaign", "drive", "drives", "random_worlds", "rows_of", "run"]
