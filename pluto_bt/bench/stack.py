"""The whole robot in lockstep: 361 beams at 5 Hz, sonars at 10 Hz, inertial sensor and odometry at 50 Hz, drive at 20 Hz, avoidance
and tree at 10 Hz, noise on. How many times faster than real time on one core, and which module the time goes to."""

from __future__ import annotations

from collections.abc import Iterator

from pluto_bt.bench.row import BenchRow
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.runner import Runner, make_runner

PATROL = Request("patrol.xml", world="yard.xml", port=["goals=8,3;13.5,3;10.5,8;2,3.5", "rounds=20"])
JOBS = {
    "explore": Request("t14_explore.xml", world="yard.xml"),
    "moveto": Request("t13_move_to.xml", world="yard.xml"),
    "wall follow": Request("t16_follow_a_wall.xml", world="office.xml"),
    "navigation on the map": Request("t17_find_the_way.xml", world="office.xml"),
}
RUNS = 3  # of each the fastest counts: what else the machine does makes runs slower, never faster


def measured_run(request: Request, max_time_s: float) -> Runner:
    """A run of at most so many simulated seconds."""
    runner = make_runner(read_inputs(request), max_time_s=max_time_s)
    runner.run()
    return runner


def speed(runner: Runner) -> float:
    """How many times faster than real time a run was."""
    return runner.result.sim_time_s / runner.result.wall_time_s


def row(name: str, runner: Runner) -> BenchRow:
    """The speed of one run."""
    return BenchRow(name, speed(runner), "× real time", ">= 100", f"{runner.result.sim_time_s:.0f} s simulated")


def run() -> Iterator[BenchRow]:
    """The patrol with all its modules, then the other jobs, each with kernels that were used before."""
    measured_run(PATROL, 5.0)
    yield from patrol_rows(max((measured_run(PATROL, 200.0) for _ in range(RUNS)), key=speed))
    for name, request in JOBS.items():
        yield row(f"{name} in lockstep", max((measured_run(request, 200.0) for _ in range(RUNS)), key=speed))


def patrol_rows(best: Runner) -> list[BenchRow]:
    """The whole stack, and the share of each module."""
    result = best.result
    rows = [row("whole stack in lockstep", best)]
    for part in sorted(best.system.parts, key=lambda part: -part.total_ns):
        per_step_us = part.total_ns / max(part.steps, 1) / 1e3
        share = part.total_ns / 1e9 / result.wall_time_s
        used = f"{per_step_us:.1f} µs a step, {part.steps} steps; worst {part.worst_ns / 1e6:.1f} of {part.module.budget_ms:g} ms"
        rows.append(BenchRow(f"  {part.module.name}", 100 * share, "% of the time", "", used))
    accounted = sum(part.total_ns for part in best.system.parts) / 1e9
    rows.append(BenchRow("  scheduler and rest", 100 * (1 - accounted / result.wall_time_s), "% of the time", "", ""))
    return rows
