"""Runs with one seed: the traces are equal, also with both cores busy; runs with different seeds differ."""

from __future__ import annotations

import multiprocessing
import os

from pluto_bt.bench.row import BenchRow

REPEATS = 200


def trace_of(seed: int) -> str:
    """The hash of a short patrol."""
    from pluto_bt.inputs.reading import Request, read_inputs
    from pluto_bt.runner import make_runner

    request = Request("patrol.xml", world="yard.xml", port=["goals=8,3"], seed=str(seed))
    return make_runner(read_inputs(request), max_time_s=20.0).run().trace_sha256


def run() -> list[BenchRow]:
    """200 repeats over as many fresh processes as there are cores, so that all of them are busy."""
    with multiprocessing.get_context("spawn").Pool(os.cpu_count(), maxtasksperchild=20) as pool:
        same = pool.map(trace_of, [7] * REPEATS, chunksize=5)
        others = pool.map(trace_of, range(20))
    return [
        BenchRow("repeats that differ, one seed", sum(trace != same[0] for trace in same), "", "0", f"{REPEATS} runs, all cores busy"),
        BenchRow("different traces of different seeds", len(set(others)), f"of {len(others)}", f"{len(others)}", ""),
    ]
