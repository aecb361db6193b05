"""Everything that moves the robot, in worlds drawn from seeds: what it touches, how often it reaches what it must, how far off, how fast.

Patrols in 306 worlds, goto around single things, moveto in towns, explore in yards, investigate. The tests play a few of the same kinds.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pluto_bt.bench import lone_things, patrols
from pluto_bt.bench.buildings import Building, kept
from pluto_bt.bench.row import BenchRow
from pluto_bt.bench.towns import Town
from pluto_bt.bench.yards import Yard
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.result import RunResult
from pluto_bt.runner import Runner, make_runner

TOWNS, YARDS, BUILDINGS = 40, 50, 40
MISSION = '<root BTCPP_format="4"><BehaviorTree ID="main">{}</BehaviorTree></root>'
OBJECT = """<world name="field" seed="{seed}"><wall id="w">-12,-12 12,-12 12,12 -12,12 -12,-12</wall>
<circle id="o" x="2" y="1" r="{r}"/><robot platform="atrv2" x="-6" y="-2" theta_deg="0"/></world>"""


def play(folder: Path, body: str, world: str, max_time_s: float = 1500.0) -> Runner:
    """One mission node in one world."""
    (folder / "mission.xml").write_text(MISSION.format(body), encoding="utf-8")
    (folder / "world.xml").write_text(world, encoding="utf-8")
    runner = make_runner(read_inputs(Request(str(folder / "mission.xml"), world=str(folder / "world.xml"))), max_time_s=max_time_s)
    runner.run()
    return runner


def _rows(name: str, results: list[RunResult], target: str) -> list[BenchRow]:
    good = [result for result in results if result.result == "SUCCESS"]
    others = sorted({result.reason for result in results if result.result != "SUCCESS"})
    wall_s, sim_s = sum(result.wall_time_s for result in results), sum(result.sim_time_s for result in results)
    return [
        BenchRow(name, 100.0 * len(good) / len(results), "%", target, f"{len(results)} worlds" + (f"; else {', '.join(others)}" if others else "")),
        BenchRow("  collisions", sum(result.collisions for result in results), "", "0"),
        BenchRow("  speed", sim_s / wall_s, "× real time", ">= 100", f"{sim_s:.0f} s simulated"),
    ]


def towns(folder: Path) -> list[BenchRow]:
    """Moveto through towns."""
    results = []
    for seed in range(TOWNS):
        town = Town.make(1000 + seed)
        results.append(play(folder, f'<MoveTo goal="{town.goal[0]};{town.goal[1]}"/>', town.text).result)
    return _rows("moveto in towns: goals reached", results, ">= 95")


def yards(folder: Path) -> list[BenchRow]:
    """Explore in yards: home again, covered, never outside."""
    results, shares, worst_m = [], [], math.inf
    for seed in range(YARDS):
        yard = Yard.make(2000 + seed)
        runner = play(folder, f'<Explore rectangle="{yard.rectangle[0]:.2f};{yard.rectangle[1]:.2f}"/>', yard.text)
        results.append(runner.result)
        shown: Any = runner.system.board.newest("map/local")
        shares.append(yard.covered_share(shown.value))
        b, h = yard.rectangle
        x0, y0, _ = yard.start
        for point in runner.system.track.points:
            x, y = point.pose[0] - x0, point.pose[1] - y0
            worst_m = min(worst_m, x, h - x, b - abs(y))
    enough = sum(share >= 0.9 and result.result == "SUCCESS" for share, result in zip(shares, results, strict=True))
    return [
        *_rows("explore in yards: home again", results, ">= 95"),
        BenchRow("  covered 90 % and home", 100.0 * enough / YARDS, "%", ">= 95", f"least {min(shares):.3f}"),
        BenchRow("  deepest outside the rectangle", max(0.0, -worst_m), "m", "0"),
    ]


def objects(folder: Path) -> list[BenchRow]:
    """Investigate things of 0.3 to 3 m: how far the robot comes off the circle while it circles."""
    results, off_m = [], 0.0
    for seed, radius_m in enumerate((0.15, 0.3, 0.5, 0.8, 1.1, 1.5)):
        circle_m = radius_m + 1.6
        runner = play(folder, f'<Investigate radius_m="{circle_m}"/>', OBJECT.format(seed=seed, r=radius_m))
        results.append(runner.result)
        from_s = runner.result.sim_time_s - math.tau * circle_m / 0.3
        for point in runner.system.track.points:
            if point.t_s > from_s:
                off_m = max(off_m, abs(math.dist(point.pose[:2], (2.0, 1.0)) - circle_m))
    farthest = BenchRow("  farthest off the circle", off_m, "m", "<= 0.2", "objects of 0.3 to 3 m")
    return [*_rows("investigate: objects circled", results, "100"), farthest]


def walls(folder: Path) -> list[BenchRow]:
    """Wall follow around houses and inside rooms, with bays, doors, posts and boxes: how well the camera kept its distance."""
    results, keeps = [], []
    for seed in range(3000, 3000 + BUILDINGS):
        building, platform, side = Building.for_seed(seed)
        wall = load_robot_file(platform).wall
        runner = play(folder, f'<WallFollow side="{side}" length_m="{1.1 * building.way_m:.1f}"/>', building.text, 600.0)
        results.append(runner.result)
        keeps.append(kept(runner.system.track.points, wall, side, building.edges, wall.distance_m))
    at_corners = sorted(keep.corner_m for keep in keeps)
    median = f"the farthest of all; median run {at_corners[len(at_corners) // 2]:.2f}"
    return [
        *_rows("wall follow: once around", results, ">= 95"),
        BenchRow("  camera off its distance beside straight walls", max(keep.straight_m for keep in keeps), "m", "<= 0.15", "the farthest of all"),
        BenchRow("  at corners, doors and posts; pockets are passed by", at_corners[-1], "m", "<= 0.4", median),
        BenchRow("  the same from the nearest wall, also in pockets", max(keep.pocket_m for keep in keeps), "m", "", "see `bench.buildings.Kept`"),
    ]


def run() -> Iterator[BenchRow]:
    """All of them, one after the other."""
    yield from patrols.run()
    yield from lone_things.run()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for part in (towns, yards, objects, walls):
            yield from part(folder)
