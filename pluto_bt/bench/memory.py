"""Memory of an hour's simulated run: flat after the first minute."""

from __future__ import annotations

from pluto_bt.bench.resident import resident_mb
from pluto_bt.bench.row import BenchRow
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.runner import make_runner
from pluto_bt.system import System

SAMPLES_S = (60.0, 600.0, 1800.0, 3590.0)


def run() -> list[BenchRow]:
    """Patrol for an hour of simulated time."""
    seen: dict[float, float] = {}

    def look(system: System) -> None:
        for at_s in SAMPLES_S:
            if at_s not in seen and system.clock.now_s() >= at_s:
                seen[at_s] = resident_mb()

    request = Request("patrol.xml", world="ideal.xml", port=["goals=3,0;3,3;0,0", "rounds=-1"])  # no drift, so it can go on for an hour
    make_runner(read_inputs(request), max_time_s=3600.0, on_progress=look).run()
    first = seen[SAMPLES_S[0]]
    rows = [BenchRow("memory after a minute", first, "MB", "", "")]
    rows += [BenchRow(f"  growth until {at_s:.0f} s", seen[at_s] - first, "MB", "flat", "") for at_s in SAMPLES_S[1:]]
    return rows
