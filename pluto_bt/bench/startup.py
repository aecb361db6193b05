"""What starting costs: `pluto --help` against a bare interpreter, and the first tick of a small mission with cached kernels."""

from __future__ import annotations

import subprocess
import sys

from pluto_bt.bench.row import BenchRow
from pluto_bt.runtime.clock import wall_ns

REPEATS = 15


def best_of(arguments: list[str], repeats: int = REPEATS) -> float:
    """The shortest wall time of a command, in seconds."""
    times = []
    for _ in range(repeats):
        begun_ns = wall_ns()
        subprocess.run(arguments, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        times.append((wall_ns() - begun_ns) / 1e9)
    return min(times)


def run() -> list[BenchRow]:
    """Best of several starts each."""
    bare = best_of([sys.executable, "-c", "pass"])
    shown = best_of([sys.executable, "-m", "pluto_bt", "--help"])
    mission = [sys.executable, "-m", "pluto_bt", "run", "patrol.xml", "--port", "goals=8,3", "--max-time", "0.1"]
    subprocess.run(mission, check=False, stdout=subprocess.DEVNULL)  # fills the kernel cache; ends with max-time
    times = []
    for _ in range(3):
        begun_ns = wall_ns()
        subprocess.run(mission, check=False, stdout=subprocess.DEVNULL)
        times.append((wall_ns() - begun_ns) / 1e9)
    return [
        BenchRow("pluto --help / bare interpreter", shown / bare, "×", "<= 2.5", f"{1e3 * shown:.0f} ms against {1e3 * bare:.0f} ms"),
        BenchRow("pluto run, start to end of the first tick", min(times), "s", "<= 2", "kernels cached"),
    ]
