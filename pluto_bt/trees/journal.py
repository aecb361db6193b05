"""The journal of a mission: a file of lines that only grows, so that after a crash one knows what was done.

A line is written when the tree remembers something new, and is on the disk (fsync) before the next tick if a step has finished. A node
with side effects writes its key before it acts: after a crash it does not act twice.

    begin   the hashes of mission and map, and of what else must be the same
    step    what the mission remembers now, as far as it has changed; the leaves that ended; where the robot is
    at      once a second: where the robot is
    act     the key of a side effect that is about to happen
    end     the run came to its end; there is nothing to resume

Each line ends with its own checksum. A last line without its end was being written when the crash came and counts for nothing. Any other line
that cannot be trusted is damage: what the mission remembers is taken up to there and not beyond, for the lines build on each other.
"""

from __future__ import annotations

import os
import shutil
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any, Final, Literal

import msgspec

from pluto_bt.source import PlutoError
from pluto_bt.trees import memory
from pluto_bt.trees.memory import State

Pose = tuple[float, float, float]
FINISHED_KEPT = 200  # of the leaves that ended, for people
COMPACT_BYTES = 1 << 20  # then the file is written anew with what is true now
START: Final = b'{"kind":"begin"'
CHECKSUM: Final = b',"crc":'


class NoJournalError(PlutoError):
    """A file that is something else than a journal, and so must not be written over."""


class Line(msgspec.Struct, omit_defaults=True, forbid_unknown_fields=True):
    """One line. `pose` is believed, `truth` the simulator's; x m, y m, theta rad. `wall_ns`: nanoseconds of the calendar."""

    kind: Literal["begin", "step", "at", "act", "end"]
    wall_ns: int = 0
    hashes: dict[str, str] = {}
    tick: int = 0
    finished: tuple[tuple[str, str], ...] = ()
    change: dict[str, Any] = {}
    begun: dict[str, int] = {}
    keys: tuple[str, ...] = ()
    pose: Pose | None = None
    truth: Pose | None = None
    crc: int = 0  # CRC-32 of the line without it; a line of an older version has none


@dataclass
class Past:
    """What a journal tells: how the mission stood when its run was cut off.

    `damaged_line`: the first line that cannot be trusted, counted from 1; 0 = all can.
    """

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
    damaged_line: int = 0

    @property
    def has_begun(self) -> bool:
        """True if there is something to resume, or was before the file was damaged."""
        return bool(self.state["nodes"] or self.keys or self.damaged_line) and not self.is_over


_lines = msgspec.json.Decoder(Line)


def read_journal(path: Path) -> Past | None:
    """What the journal tells, up to its last whole line; None if there is none.

    Raises: NoJournalError if the file is something else; OSError if it cannot be read.
    """
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return None
    *texts, unfinished = data.split(b"\n")
    lines = [_decoded(text) for text in texts]
    if not any(lines):
        if lines or not unfinished.startswith(START[: len(unfinished)]):
            raise NoJournalError(f"{path} is no journal")
        return None
    past = Past()
    for number, (text, line) in enumerate(zip(texts, lines, strict=True), 1):
        is_good = line is not None and _is_intact(text, line) and (number > 1 or bool(line.hashes))
        if not (is_good or past.damaged_line):
            past.damaged_line = number
        if line is not None:
            _take(past, _without_memory(line) if past.damaged_line else line)
    return past


def _decoded(text: bytes) -> Line | None:
    try:
        return _lines.decode(text)
    except (msgspec.MsgspecError, UnicodeDecodeError):
        return None


def _encoded(line: Line) -> bytes:
    text = msgspec.json.encode(line)
    return b"%s%s%d}\n" % (text[:-1], CHECKSUM, zlib.crc32(text))


def _is_intact(text: bytes, line: Line) -> bool:
    return not line.crc or zlib.crc32(text.rpartition(CHECKSUM)[0] + b"}") == line.crc


def _without_memory(line: Line) -> Line:
    """What still helps of a line that stands behind a damage: side effects that have begun, time and place, the end."""
    return msgspec.structs.replace(line, tick=0, finished=(), change={}, begun={})


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

    def __init__(self, path: Path, past: Past, *, waits: bool = False) -> None:
        """Begin with what `past` tells: nothing but hashes for a mission that begins, all of it for one that goes on.

        One that `waits` for an operator leaves the file as it was found until the first line is written.

        Raises: OSError if the file cannot be written.
        """
        self.path, self._past = path, past
        self._file: IO[bytes] | None = None if waits else self._rewritten()

    def write(self, line: Line, is_sure: bool) -> None:
        """Append a line; `is_sure`: it is on the disk when this returns."""
        file = self._file = self._file or self._rewritten()
        _take(self._past, line)
        file.write(_encoded(line))
        file.flush()
        if is_sure:
            os.fsync(file.fileno())
        if file.tell() > COMPACT_BYTES:
            file.close()
            self._file = self._rewritten()

    def close(self) -> None:
        """Let go of the file."""
        if self._file is not None:
            self._file.close()

    def _rewritten(self) -> IO[bytes]:
        """The file with what is true now, put in the place of the old one at once; of a damaged one a copy stays."""
        past = self._past
        if past.damaged_line:
            shutil.copyfile(self.path, self.path.with_name(self.path.name + ".damaged"))
            past.damaged_line = 0
        begin = Line("begin", past.wall_ns, past.hashes)
        now = Line("step", past.wall_ns, {}, past.tick, tuple(past.finished), past.state, past.begun, tuple(past.keys), past.pose, past.truth)
        draft = self.path.with_name(self.path.name + ".new")
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with draft.open("wb") as file:
            file.write(b"".join(map(_encoded, (begin, now) if past.has_begun else (begin,))))
            file.flush()
            os.fsync(file.fileno())
        os.replace(draft, self.path)
        _make_sure(self.path.parent)
        return self.path.open("ab")
