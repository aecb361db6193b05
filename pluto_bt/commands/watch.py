"""`--watch`: the tree while it runs. On a terminal it stands at the bottom and moves; when piped, each beginning and end is a plain line."""

from __future__ import annotations

import sys
import threading
from collections import deque
from collections.abc import Iterator
from typing import IO, Final

from rich.console import Console
from rich.live import Live
from rich.text import Text

from pluto_bt.blackboard.messages import Event
from pluto_bt.commands.progress import LIVE_EVERY_NS, Progress
from pluto_bt.commands.tree_now import of_system
from pluto_bt.result import RunResult
from pluto_bt.runtime.clock import wall_ns
from pluto_bt.system import System
from pluto_bt.trees import Mission
from pluto_bt.trees.dump import Drawn, folded
from pluto_bt.trees.dump.text import PRETTY_MARKS

STYLES: Final = {"": "", "IDLE": "dim", "RUNNING": "bold yellow", "SUCCESS": "green", "FAILURE": "bold red", "SKIPPED": "blue"}


class LiveTree(Progress):
    """Draws the tree anew ten times a second; events scroll by above it."""

    def __init__(self, stream: IO[str]) -> None:
        super().__init__(stream)
        self._console = Console(file=stream, highlight=False, markup=False, emoji=False)
        self._live = Live(console=self._console, auto_refresh=False, transient=True, vertical_overflow="crop",
                          redirect_stdout=stream is sys.stdout, redirect_stderr=False)  # fmt: skip

    def line(self, text: str) -> None:
        """One whole line, above the tree."""
        self._console.print(text)

    def show(self, system: System) -> None:
        """Called every now and then while the run goes on."""
        now_ns = wall_ns()
        if now_ns - self._shown_ns < LIVE_EVERY_NS:
            return
        self._begun_ns, self._shown_ns = self._begun_ns or now_ns, now_ns
        root, status = of_system(system), self._status(system, now_ns)
        lines = [] if root is None else tree_lines(root, self._console.height - 2)
        self._live.start()
        self._live.update(Text("\n").join([*lines, Text(status, no_wrap=True, overflow="ellipsis")]), refresh=True)

    def end(self, result: RunResult) -> None:
        """The summary in place of the tree."""
        self._live.stop()
        super().end(result)


def tree_lines(root: Drawn, most: int) -> list[Text]:
    """The tree as coloured lines, at most so many: what is not RUNNING is folded first; then the lines round the deepest RUNNING node are kept."""
    lines = list(_lines(folded(root, most), "", ""))
    if len(lines) <= most:
        return [line for line, _ in lines]
    depth_of = [depth if is_running else -1 for line, (depth, is_running) in lines]
    middle = depth_of.index(max(depth_of))
    first = min(max(middle - most // 2, 0), len(lines) - most)
    return [line for line, _ in lines[first : first + most]]


def _lines(node: Drawn, head: str, indent: str) -> Iterator[tuple[Text, tuple[int, bool]]]:
    text = Text(no_wrap=True, overflow="ellipsis")
    text.append(head, "dim")
    text.append(f"{PRETTY_MARKS[node.status] or ' '} {node.title}", STYLES[node.status])
    if node.status not in ("", "IDLE"):
        text.append(f"  {node.state}", STYLES[node.status])
    if node.feedback:
        text.append(f" – {' '.join(node.feedback.split())}", "" if node.status == "RUNNING" else "dim")
    yield text, (len(indent), node.status == "RUNNING")
    for i, child in enumerate(node.children):
        is_last = i == len(node.children) - 1
        yield from _lines(child, indent + ("└─ " if is_last else "├─ "), indent + ("   " if is_last else "│  "))


class ToldTree(Progress):
    """Plain lines: when a leaf of the mission began and how it ended."""

    def __init__(self, stream: IO[str]) -> None:
        super().__init__(stream)
        self._ends: deque[tuple[float, str]] = deque()
        self._telling = threading.Lock()  # events come from the thread that ticks
        self._begun: dict[str, float] = {}

    def attach(self, mission: Mission) -> None:
        """Listen to its leaves; the thread that ticks only puts down what it heard."""
        tracked = mission.nodes()

        def heard(number: int, status: str) -> None:
            said = tracked[number].node.feedback_message
            self._ends.append((mission.now_s(), f"{tracked[number].path}: {status}" + (f" – {said}" if said else "")))

        mission.watch(heard)

    def event(self, event: Event) -> None:
        """An event of the run, behind what led to it."""
        self._tell([])
        super().event(event)

    def show(self, system: System) -> None:
        """Tell what has happened since the last call."""
        self._tell(self._beginnings(system))
        super().show(system)

    def end(self, result: RunResult) -> None:
        """What is left to tell, and the summary."""
        self._tell([])
        super().end(result)

    def _beginnings(self, system: System) -> list[tuple[float, str]]:
        """The leaves that are RUNNING and were not, or were begun anew."""
        active = system.executive.core.mission
        if active is None:
            return []
        now = {one.path: one.since_s for one in active.mission.nodes() if not one.node.children and one.shown == "RUNNING"}
        fresh = [(since_s, f"{path}: RUNNING") for path, since_s in now.items() if self._begun.get(path) != since_s]
        self._begun = now
        return fresh

    def _tell(self, beginnings: list[tuple[float, str]]) -> None:
        with self._telling:
            ends = [self._ends.popleft() for _ in range(len(self._ends))]
        for at_s, words in sorted([*ends, *beginnings], key=lambda one: one[0]):
            self.line(f"[{at_s:8.1f} s]   {words}")
