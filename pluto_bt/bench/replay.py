"""Black boxes of many different runs, in lockstep and in threads, executed again: identical ticks; and what recording costs."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pluto_bt.bench.row import BenchRow
from pluto_bt.doors import CLOSED, Doors
from pluto_bt.gateway.listen import Address
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.playback import replay_file
from pluto_bt.record.box import open_box
from pluto_bt.runner import make_runner
from pluto_bt.source import Faults

RUNS = 100
THREADS_EVERY = 4  # every fourth run is one in threads
SPEED = 4.0
MOST_S = 40.0
HALL = """<world name="hall" seed="1"><wall id="fence">-6,-4 6,-4 6,4 -6,4 -6,-4</wall> <circle id="post" x="0.5" y="0.2" r="0.15"/>
  <actor id="person" r="0.25" speed="0.7" loop="true">-2,3 4,3 4,-3</actor> <script><at t="{at:.2f}"><fault {fault}/></at></script></world>"""
FAULTS = (
    'device="laser" kind="off" for="3"', 'device="sonar" kind="nan" for="2"', 'device="odometry" kind="slip" value="0.2"',
    'device="leaf:go" kind="raise"', 'device="module:avoid" kind="raise"', 'device="base" kind="blocked" for="4"',
    'device="laser" kind="fatal" for="5"', 'device="compass" kind="off"',
)  # fmt: skip
MISSIONS = {
    "legs": '<Sequence><Sleep msec="1050"/><Timeout msec="{short}"><GoTo name="go" goal="{goal}"/></Timeout><GoTo goal="-4;0"/></Sequence>',
    "reacts": '<Sequence><Sleep msec="1000"/><Fallback><ReactiveSequence><ScriptCondition code="@Localization_Pose_x &lt; {x:.2f}"/>'
              '<GoTo name="go" goal="{goal}"/></ReactiveSequence><MakeTurn angle_deg="70"/></Fallback></Sequence>',
    "moveto": '<Sequence><Sleep msec="1000"/><MoveTo name="go" goal="{goal}" timeout_s="25"/></Sequence>',
    "parallel": '<Parallel success_count="2"><Repeat num_cycles="6"><Sequence><Sleep msec="640"/><Script code="n += 1"/></Sequence></Repeat>'
                '<Fallback><IsAt goal="{goal}"/><Sequence><Sleep msec="1000"/><GoTo name="go" goal="{goal}"/></Sequence></Fallback></Parallel>',
}  # fmt: skip


class Repetition(NamedTuple):
    """One run and its repetition; `difference` is "" if all ticks were identical."""

    number: int
    mode: str
    ticks: int
    difference: str


def repeat(number: int, folder: Path) -> Repetition:
    """Record a run drawn from its number, and execute it again."""
    rng = np.random.default_rng(number)
    goal = f"{rng.uniform(2.0, 5.0):.2f};{rng.uniform(-3.0, 3.0):.2f}"
    kind = list(MISSIONS)[number % len(MISSIONS)]
    body = MISSIONS[kind].format(goal=goal, short=int(rng.integers(1500, 9000)), x=rng.uniform(-3.0, 3.0))
    (folder / "w.xml").write_text(HALL.format(at=rng.uniform(2.0, 9.0), fault=FAULTS[int(rng.integers(len(FAULTS)))]), encoding="utf-8")
    body = f'<Sequence><Script code="n := 0"/>{body}</Sequence>'
    (folder / "m.xml").write_text(f'<root BTCPP_format="4"><BehaviorTree ID="m">{body}</BehaviorTree></root>', encoding="utf-8")
    in_threads = number % THREADS_EVERY == THREADS_EVERY - 1
    platform = ("pioneer", "atrv2")[number // 8 % 2]
    request = Request(str(folder / "m.xml"), world=str(folder / "w.xml"), start="-4.5,0,0", platform=platform, seed=str(number))
    make_runner(read_inputs(request), realtime=in_threads, speed=SPEED, max_time_s=MOST_S, record=folder / "a.mcap",
                doors=Doors(gateway=Address(port=0)) if in_threads else CLOSED).run()  # fmt: skip
    box = open_box(folder / "a.mcap", "a.mcap", Faults())
    assert box is not None  # it was just written
    found = replay_file(folder / "a.mcap")
    return Repetition(number, box.run.mode, len(box), str(found[0]) if found else "")


def repetitions(numbers: range) -> Iterator[Repetition]:
    """So many runs, each with its repetition."""
    with tempfile.TemporaryDirectory() as folder:
        for number in numbers:
            yield repeat(number, Path(folder))


def cost(folder: Path, rounds: int = 3) -> tuple[float, float]:
    """(share of the processor's time that recording adds, kilobytes a second of the run), of a patrol in lockstep."""
    request = Request("patrol.xml", port=["goals=8,3;13.5,3;2,3.5"])
    least = [np.inf, np.inf]
    size = 0.0
    for _ in range(rounds):
        for which, record in enumerate((None, folder / "a.mcap")):
            runner = make_runner(read_inputs(request), record=record)
            begun = time.process_time()
            result = runner.run()
            least[which] = min(least[which], time.process_time() - begun)
            size = (folder / "a.mcap").stat().st_size / 1e3 / result.sim_time_s if record is not None else size
    return least[1] / least[0] - 1.0, size


def run() -> Iterator[BenchRow]:
    """The rows of `pluto bench replay`."""
    done = list(repetitions(range(RUNS)))
    bad = [one for one in done if one.difference]
    threads = sum(one.mode == "threads" for one in done)
    yield BenchRow("runs executed again", float(len(done)), "", ">= 100", f"{threads} of them in threads, {sum(one.ticks for one in done)} ticks")
    yield BenchRow("of them with a tick that differs", float(len(bad)), "", "0", "; ".join(f"run {one.number}: {one.difference}" for one in bad[:3]))
    with tempfile.TemporaryDirectory() as folder:
        share, kilobytes = cost(Path(folder))
    yield BenchRow("recording adds to the processor's time", 100.0 * share, "%", "", "a patrol in lockstep")
    yield BenchRow("a black box grows by", kilobytes, "kB/s", "", "of the run")
