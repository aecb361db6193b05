"""The journal of a mission: a file of lines that only grows, so that after a crash one knows what was done.

A line is written when the tree remembers something new, and is on the disk (fsync) before the next tick if a step has finished. A node
with side effects writes its key before it acts: after a crash it does not act twice.

    begin   the hashes of mission and map, and of what else must be the same
    step    what the mission remembers now, as far as it has changed; the leaves that ended; where the robot is
    at      once a second: where the robot is
    act     the key of a side effect that is about to happen
    end     the run came to its end; there is nothing to resume
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

import msgspec

from pluto_bt.trees import memory
from pluto_bt.trees.memory import State

Pose = tuple[float, float, float]
FINISHED_KEPT = 200  # of the leaves that ended, for people
COMPACT_BYTES = 1 << 20  # then the file is written anew with what is true now


class Line(msgspec.Struct, omit_defaults=True):
    """One line. `pose` is believed, `truth` the simulator's; x m, y m, theta rad. `wall_ns`: nanoseconds of the calendar."""

    kind: str
    wall_ns: int = 0
    hashes: dict[str, str] = {}
    tick: int = 0
    finished: tuple[tuple[str, str], ...] = ()
    change: dict[str, Any] = {}
    begun: dict[str, int] = {}
    keys: tuple[str, ...] = ()
    pose: Pose | None = None
    truth: Pose | None = None


@dataclass
class Past:
    """What a journal tells: how the mission stood when its run was cut off."""

    hashes: dict[str, str] = field(default_factory=dict)
    state: State = field(default_factory=lambda: {"nodes": {}, "board": {}})
    begun: dict[str, int] = field(default_factory=dict)
    keys: dict[str, None] = field(default_factory=dict)
    finished: list[tuple[str, str]] = field(default_factory=list)
    tick: int = 0
    wall_ns: int = 0
    pose: Pose | None = None
    truth: Pose | None = None
    is_over: bool = False

    @property
    def has_begun(self) -> bool:
        """True if there is something to resume."""
        return bool(self.state["nodes"] or self.keys) and not self.is_over


_lines = msgspec.json.Decoder(Line)


def read_journal(path: Path) -> Past | None:
    """What the journal tells, up to its last whole line; None if there is none."""
    try:
        data = path.read_bytes()
    except OSError:
        return None
    past = Past()
    for text in data.split(b"\n")[:-1]:  # a last line without its end was being written
        try:
            line = _lines.decode(text)
        except msgspec.MsgspecError:
            break  # nothing after a broken line can be trusted
        _take(past, line)
    return past if past.hashes else None


def _take(past: Past, line: Line) -> None:
    past.wall_ns = line.wall_ns or past.wall_ns
    past.hashes = line.hashes or past.hashes
    past.pose, past.truth = line.pose or past.pose, line.truth or past.truth
    past.is_over = line.kind == "end"
    past.keys.update(dict.fromkeys(line.keys))
    past.begun.update(line.begun)
    for key in [key for key in past.keys if _is_counted(key, past.begun)]:
        del past.keys[key]
    past.finished = [*past.finished, *line.finished][-FINISHED_KEPT:] if line.finished else past.finished
    past.tick = line.tick or past.tick
    if line.change:
        past.state = memory.merged(past.state, line.change)


def key_of(path: str, count: int) -> str:
    """The key of a side effect: the node, and how often it has begun."""
    return f"{path}#{count}"


def _is_counted(key: str, begun: dict[str, int]) -> bool:
    """True if `begun` has gone past this key already: whoever goes on will not ask for it again."""
    path, _, count = key.rpartition("#")
    return count.isdigit() and int(count) <= begun.get(path, 0)


def _make_sure(folder: Path) -> None:
    """Have what was renamed in a folder on the disk."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


class Journal:
    """One journal, open for writing by one thread."""

    def __init__(self, path: Path, past: Past) -> None:
        """Begin with what `past` tells: nothing but hashes for a mission that begins, all of it for one that goes on.

        Raises: OSError if the file cannot be written.
        """
        self.path, self._past = path, past
        self._file: IO[bytes] = self._rewritten()

    def write(self, line: Line, is_sure: bool) -> None:
        """Append a line; `is_sure`: it is on the disk when this returns."""
        _take(self._past, line)
        self._file.write(msgspec.json.encode(line) + b"\n")
        self._file.flush()
        if is_sure:
            os.fsync(self._file.fileno())
        if self._file.tell() > COMPACT_BYTES:
            self._file.close()
            self._file = self._rewritten()

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()

    def _rewritten(self) -> IO[bytes]:
        """The file with what is true now, put in the place of the old one at once."""
        past = self._past
        begin = Line("begin", past.wall_ns, past.hashes)
        now = Line("step", past.wall_ns, {}, past.tick, tuple(past.finished), past.state, past.begun, tuple(past.keys), past.pose, past.truth)
        draft = self.path.with_name(self.path.name + ".new")
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with draft.open("wb") as file:
            file.write(b"".join(msgspec.json.encode(line) + b"\n" for line in ((begin, now) if past.has_begun else (begin,))))
            file.flush()
            os.fsync(file.fileno())
        os.replace(draft, self.path)
        _make_sure(self.path.parent)
        return self.path.open("ab")
