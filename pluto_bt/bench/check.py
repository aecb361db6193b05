"""A mission of 10 000 nodes: how long loading and checking take, and how much memory, in a process of their own."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from pluto_bt.bench.row import BenchRow

NODES = 10_000
REPEATS = 3
ROW = ('<Sequence><Script code="n := n + 1"/><GoTo name="go" goal="{place}" timeout_s="60" reason="{why}"/>'
       '<Fallback _skipIf="n &lt; 3"><ScriptCondition code="why == \'stuck\'"/><Sleep msec="10"/></Fallback></Sequence>\n')  # fmt: skip
NODES_OF_A_ROW = 6
MEASURE = """
import sys
from pluto_bt.modules.topic_globals import TopicGlobals
from pluto_bt.runtime.clock import wall_ns
from pluto_bt.trees import check_mission, load_mission
begun_ns = wall_ns()
errors = [fault for fault in check_mission(sys.argv[1], topics=TopicGlobals()) if fault.severity == "error"]
checked_ns = wall_ns()
nodes = len(load_mission(sys.argv[1]).nodes())
print((checked_ns - begun_ns) / 1e9, (wall_ns() - checked_ns) / 1e9, nodes, len(errors))
"""


def run() -> list[BenchRow]:
    """The least of a few runs."""
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "mission.xml"
        path.write_text(mission_of(NODES), encoding="utf-8")
        taken = [_measured(path) for _ in range(REPEATS)]
    check_s, load_s, memory_mib = (min(one[i] for one in taken) for i in range(3))
    note = f"check {check_s:.2f} s, load {load_s:.2f} s"
    return [
        BenchRow("10 000 nodes: load and check", check_s + load_s, "s", "<= 1", note),
        BenchRow("10 000 nodes: memory", memory_mib, "MiB", "<= 190", "200 MB, the interpreter and all imports in it"),
    ]


def mission_of(nodes: int) -> str:
    """A mission with so many nodes, of every common kind."""
    rows = ROW * (nodes // NODES_OF_A_ROW)
    head = "<Script code=\"n := 0; place := '1;2'\"/>"
    return f'<root BTCPP_format="4"><BehaviorTree ID="Long"><Sequence>{head}\n{rows}</Sequence></BehaviorTree></root>'


def _measured(path: Path) -> tuple[float, float, float]:
    """(seconds to check, seconds to load, peak MiB) in a fresh process."""
    child = subprocess.Popen([sys.executable, "-c", MEASURE, str(path)], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None  # it is a pipe
    check_s, load_s, nodes, errors = map(float, child.stdout.read().split())
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if errors or abs(nodes - NODES) > NODES_OF_A_ROW:
        raise RuntimeError(f"the mission of the benchmark has {nodes:g} nodes and {errors:g} errors")
    return check_s, load_s, usage.ru_maxrss / 1024
