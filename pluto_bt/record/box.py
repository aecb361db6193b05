"""A black box, open for reading: the run, its trees, and the state of everything at any tick, forward and back."""

from __future__ import annotations

import bisect
import copy
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

import msgspec

from pluto_bt.blackboard import TOPICS, Sample
from pluto_bt.record.codec import decode
from pluto_bt.record.entries import RUN, STATUS_OF_LETTER, TICK, TREE, NodeRow, Run, Tick, Tree
from pluto_bt.record.mcap_reader import McapFile, open_mcap
from pluto_bt.record.trail import Trail
from pluto_bt.source import Faults, Place

CHECKPOINT_EVERY = 256  # ticks that are folded anew when one goes back
ENDS_ERRAND = ("pause", "resume", "abort", "start", "end-errand")
_ticks = msgspec.json.Decoder(Tick)
_trees = msgspec.json.Decoder(Tree)


@dataclass
class TreeNow:
    """A tree at one moment. `since_ns`: when each node took the status it has."""

    tree: Tree
    tick: int = 0
    nodes: str = ""
    feedback: dict[int, str] = field(default_factory=dict)
    board: dict[str, Any] = field(default_factory=dict)
    since_ns: list[int] = field(default_factory=list)
    state: str = "running"
    reason: str = ""
    text: str = ""

    def rows(self) -> Iterator[tuple[NodeRow, str, str, int]]:
        """Each node: (row, status, feedback, since when in nanoseconds)."""
        for i, row in enumerate(self.tree.nodes):
            letter = self.nodes[i] if i < len(self.nodes) else "I"
            yield row, STATUS_OF_LETTER[letter], self.feedback.get(i, ""), self.since_ns[i] if i < len(self.since_ns) else 0


@dataclass
class Now:
    """Everything at one tick; `runs`: the trees that were ticked last, `paused`: by which word the mission is paused."""

    number: int = -1
    tick: Tick = field(default_factory=lambda: Tick(0, 0))
    trees: dict[int, TreeNow] = field(default_factory=dict)
    trail: Trail = field(default_factory=Trail)
    paused: str = ""
    runs: tuple[int, ...] = ()

    def at_work(self) -> list[TreeNow]:
        """The trees that were ticked last."""
        return [self.trees[run] for run in self.runs if run in self.trees]

    @property
    def mission(self) -> TreeNow | None:
        """The mission that began last; None before the first one."""
        return next((tree for tree in reversed(self.trees.values()) if tree.tree.role == "mission"), None)

    def end_errand(self) -> None:
        """An order has ended it: what was ticked before it is what people look at again."""
        left = tuple(run for run in self.runs if run not in self.trees or self.trees[run].tree.role != "errand")
        if left != self.runs:
            self.runs = left or ((self.mission.tree.run,) if self.mission is not None else self.runs)


class Box:
    """A black box in memory; its ticks stay packed until they are asked for."""

    def __init__(self, file: McapFile, run: Run) -> None:
        self.file, self.run = file, run
        self.trees: dict[int, Tree] = {}
        self.result: dict[str, Any] = {}
        self.times_ns: list[int] = []
        self._packed: list[bytes] = []
        self._checkpoints: dict[int, Now] = {}

    def __len__(self) -> int:
        return len(self._packed)

    def tick(self, number: int) -> Tick:
        """The tick of that number; 0 is the first that the file still has. What it tells of a tree that was lost is left out."""
        tick = _ticks.decode(self._packed[number])
        if any(branch.run not in self.trees for branch in tick.trees):
            tick.trees = tuple(branch for branch in tick.trees if branch.run in self.trees)
        return tick

    def number_at(self, t_s: float) -> int:
        """The last tick at or before a time; the first one if all are later. -1 without any."""
        return max(bisect.bisect_right(self.times_ns, round(t_s * 1e9) + 500) - 1, 0) if self._packed else -1

    @property
    def is_from_start(self) -> bool:
        """True if no tick was dropped for want of room."""
        return bool(self._packed) and self.tick(0).step == 0

    def now(self, number: int) -> Now:
        """The state of everything after a tick."""
        begin = number // CHECKPOINT_EVERY * CHECKPOINT_EVERY
        while begin > 0 and begin not in self._checkpoints:
            begin -= CHECKPOINT_EVERY
        state = copy.deepcopy(self._checkpoints[begin]) if begin in self._checkpoints else Now()
        for i in range(state.number + 1, number + 1):
            self._fold(state, self.tick(i))
            if i % CHECKPOINT_EVERY == 0:
                self._checkpoints[i] = copy.deepcopy(state)
        return state

    def _fold(self, state: Now, tick: Tick) -> None:
        state.number, state.tick = state.number + 1, tick
        for verb, _, text in tick.orders:
            state.paused = text if verb == "pause" else "" if verb in ("resume", "start", "abort") else state.paused
            if verb in ENDS_ERRAND:
                state.end_errand()
        if tick.trees:
            state.runs = tuple(branch.run for branch in tick.trees)
        for branch in tick.trees:
            tree = self.trees.get(branch.run)
            if tree is None:
                continue
            now = state.trees.setdefault(branch.run, TreeNow(tree, since_ns=[tick.t_ns] * len(tree.nodes)))
            if branch.nodes != now.nodes:
                before = now.nodes or "I" * len(branch.nodes)
                for i, letter in enumerate(branch.nodes):
                    if letter != before[i]:
                        now.since_ns[i] = tick.t_ns
            if branch.is_key:
                now.feedback, now.board = {}, {}
            now.feedback.update(branch.feedback)
            now.board.update(branch.board)
            for key in branch.gone:
                now.board.pop(key, None)
            now.tick, now.nodes, now.state, now.reason, now.text = branch.tick, branch.nodes, branch.state, branch.reason, branch.text
        if tick.situation is not None:
            state.trail.take(tick.situation, tick.t_ns)

    def samples(self, topics: Iterable[str]) -> dict[str, list[Sample]]:
        """All recorded samples of topics, in order."""
        kinds = {topic.name: topic.type for topic in TOPICS}
        found: dict[str, dict[int, Sample]] = {name: {} for name in topics}
        for line in self.file.lines():
            if line.topic in found:
                found[line.topic][line.sequence] = Sample(decode(line.data, kinds[line.topic]), line.sequence, line.time_ns / 1e9)
        return {name: [by_seq[seq] for seq in sorted(by_seq)] for name, by_seq in found.items()}

    @contextmanager
    def unpacked(self) -> Iterator[Path]:
        """The files of the run in a folder that lasts as long as the context."""
        with tempfile.TemporaryDirectory(prefix="pluto-box-") as name:
            for attachment in self.file.attachments.values():
                if ".." in PurePosixPath(attachment.name).parts or attachment.name.startswith("/"):
                    continue  # a file of somebody else's making must not write where it likes
                path = Path(name, attachment.name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(attachment.data)
            yield Path(name)


def open_box(path: Path, shown: str, faults: Faults) -> Box | None:
    """Read a black box, as far as it goes; None and faults if it is none."""
    file = open_mcap(path, shown, faults)
    if file is None:
        return None
    try:
        return _read(file, shown, faults)
    except (msgspec.MsgspecError, KeyError) as error:
        faults.error(Place(shown), "broken-black-box", f'"{shown}" is a black box that makes no sense', expected="a file of `pluto run --record`",
                     found=str(error), mend="record the run again")  # fmt: skip
        return None


def _read(file: McapFile, shown: str, faults: Faults) -> Box | None:
    """Raises: MsgspecError, KeyError for a file that something has spoiled."""
    times_ns: list[int] = []
    packed: list[bytes] = []
    trees: dict[int, Tree] = {}
    for line in file.lines():
        if line.topic == TICK:
            times_ns.append(line.time_ns)
            packed.append(line.data)
        elif line.topic == TREE:
            tree = _trees.decode(line.data)
            trees[tree.run] = tree
    if RUN not in file.metadata:
        faults.error(Place(shown), "no-black-box", f'"{shown}" is MCAP, but no black box of a run', expected="a file of `pluto run --record`",
                     found=", ".join(sorted({channel.topic for channel in file.channels.values()})[:5]) or "no channels")  # fmt: skip
        return None
    box = Box(file, msgspec.json.decode(file.metadata[RUN]["json"], type=Run))
    box.times_ns, box._packed, box.trees = times_ns, packed, trees
    box.result = msgspec.json.decode(file.metadata.get("pluto/result", {"json": "{}"})["json"])
    return box
