"""Crash and go on: a real SIGKILL at every tick of a reference mission, then the same run again with its journal.

Each run is a process of its own, forked from one that has everything loaded. What must hold after every kill: held, the robot does not move;
resumed, the mission succeeds, its steps follow those before the kill without one being repeated, and nothing is said twice.
"""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import tempfile
from collections.abc import Iterator, Sequence
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from pluto_bt.bench.row import BenchRow

MISSION = str(resources.files("pluto_bt") / "bench" / "resume.xml")
ENDS = ("Sleep", "GoTo", "Say", "Script")
HELD_EVERY = 5  # of the kills that also try what `hold` does; its run is the shorter part of a resumed one
SECONDS = 120.0


class Outcome(NamedTuple):
    """What one kill led to; `problem` is "" if all is well."""

    tick: int
    problem: str


def run_once(folder: str, policy: str, kill_at: int = 0) -> None:
    """One run in this process; with `kill_at` it kills itself after that many steps of the executive. Leaves `run.json` and `said.txt`."""
    from pluto_bt.inputs.reading import Request, read_inputs
    from pluto_bt.resume import ResumeRequest
    from pluto_bt.runner import make_runner

    said = Path(folder, "said.txt").open("a", encoding="utf-8")  # noqa: SIM115  a killed process closes nothing anyway
    steps: list[list[str]] = []

    def hear(event: Any) -> None:
        if event.code == "say":
            said.write(event.text + "\n")
            said.flush()

    runner = make_runner(read_inputs(Request(MISSION, world="yard.xml")), resume=ResumeRequest(policy, Path(folder, "journal")),
                         on_event=hear, max_time_s=2.0 if policy == "hold" else SECONDS)  # fmt: skip
    runner.mission.watch(lambda number, word: steps.append([runner.mission.nodes()[number].path, word]))
    executive = runner.system.executive
    step, count = executive.step, 0

    def counted(now_s: float) -> None:
        nonlocal count
        step(now_s)
        count += 1
        if count == kill_at:
            os.kill(os.getpid(), signal.SIGKILL)

    executive.step = counted
    result = runner.run()
    told = {"result": result.result, "reason": result.reason, "distance_m": result.distance_m, "ticks": result.ticks, "steps": steps}
    Path(folder, "run.json").write_text(json.dumps(told), encoding="utf-8")


class Kills:
    """The reference run, and as many kills as asked for."""

    def __init__(self) -> None:
        self._context = multiprocessing.get_context("forkserver")
        self._context.set_forkserver_preload(["pluto_bt.bench.warm", "pluto_bt.bench.resume"])
        with tempfile.TemporaryDirectory() as folder:
            self.reference = self._run(folder, "resume")
            self._said = Path(folder, "said.txt").read_text(encoding="utf-8").split("\n")[:-1]

    @property
    def ticks(self) -> int:
        """Ticks of the mission: every one can be the last."""
        return int(self.reference["ticks"])

    def at(self, tick: int, try_hold: bool) -> Outcome:
        """Kill the run after a tick, then let it go on."""
        from pluto_bt.trees.journal import read_journal

        with tempfile.TemporaryDirectory() as folder:
            if self._start(folder, "resume", tick) != -signal.SIGKILL:
                return Outcome(tick, "it was not killed")
            past = read_journal(Path(folder, "journal"))
            before = [] if past is None else past.finished
            if try_hold:
                held = self._run(folder, "hold")
                if held["distance_m"] > 0.0 or held["steps"]:
                    return Outcome(tick, f"held, it moved {held['distance_m']} m and did {held['steps']}")
            resumed = self._run(folder, "resume")
            said = Path(folder, "said.txt").read_text(encoding="utf-8").split("\n")[:-1]
        return Outcome(tick, self._problem([*before, *map(tuple, resumed["steps"])], resumed, said))

    def _problem(self, steps: Sequence[tuple[str, str]], resumed: dict[str, Any], said: list[str]) -> str:
        wanted = [tuple(step) for step in self.reference["steps"] if _is_step(step[0])]
        done = [tuple(step) for step in steps if _is_step(step[0])]
        if resumed["result"] != "SUCCESS":
            return f"resumed, it ended with {resumed['result']} {resumed['reason']}"
        if done != wanted:
            i = next((i for i, (a, b) in enumerate(zip(done, wanted, strict=False)) if a != b), min(len(done), len(wanted)))
            return f"step {i}: expected {wanted[i : i + 1]}, found {done[i : i + 1]}"
        return "" if said == self._said else f"said {said}"

    def _run(self, folder: str, policy: str) -> dict[str, Any]:
        self._start(folder, policy)
        told: dict[str, Any] = json.loads(Path(folder, "run.json").read_text(encoding="utf-8"))
        Path(folder, "run.json").unlink()
        return told

    def _start(self, folder: str, policy: str, kill_at: int = 0) -> int | None:
        process = self._context.Process(target=run_once, args=(folder, policy, kill_at))
        process.start()
        process.join()
        return process.exitcode


def _is_step(path: str) -> bool:
    """Conditions are asked, not done; they may be asked again."""
    return path.rpartition("/")[2] not in ("third time", "three")


def outcomes(count: int | None = None, seed: int = 0) -> Iterator[Outcome]:
    """A kill after every tick of the mission but the last, or after `count` of them drawn with a seed."""
    kills = Kills()
    ticks = np.arange(1, kills.ticks)  # after the last one there is nothing to resume
    chosen = ticks if count is None else np.sort(np.random.default_rng(seed).choice(ticks, size=min(count, len(ticks)), replace=False))
    for number, tick in enumerate(chosen.tolist()):
        yield kills.at(tick, try_hold=number % HELD_EVERY == 0)


def run() -> Iterator[BenchRow]:
    """The rows of `pluto bench resume`."""
    done = list(outcomes())
    bad = [outcome for outcome in done if outcome.problem]
    yield BenchRow("runs killed, one at every tick", float(len(done)), "", ">= 200")
    yield BenchRow("of them not going on as they must", float(len(bad)), "", "0", "; ".join(f"tick {one.tick}: {one.problem}" for one in bad[:3]))
