"""The blackboard: one immutable newest value a topic, one writer each, sequence numbers, short histories, consistent snapshots.

All calls are thread-safe. A lock guards only the bookkeeping; values are frozen, so readers share them freely.
"""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator

import msgspec

from pluto_bt.blackboard.messages import Message
from pluto_bt.blackboard.topics import TOPICS, Topic
from pluto_bt.source import PlutoError, did_you_mean


class Sample(msgspec.Struct, frozen=True, gc=False):
    """A value with its bookkeeping. "Changed" means that `seq` moved; it counts from 1 for each topic."""

    value: Message
    seq: int
    written_s: float


class TopicError(PlutoError):
    """A topic that does not exist, a second writer, or a value of the wrong type."""


class Publisher:
    """The one right to write a topic."""

    __slots__ = ("_board", "_index", "_name", "_type")

    def __init__(self, board: Blackboard, index: int, topic: Topic) -> None:
        self._board = board
        self._index = index
        self._name = topic.name
        self._type = topic.type

    def put(self, value: Message, now_s: float) -> None:
        """Make `value` the newest one and wake whoever waits for the topic."""
        if type(value) is not self._type:
            raise TopicError(f"{self._name} carries {self._type.__name__}, not {type(value).__name__}")
        board, index = self._board, self._index  # no method of the board's: 500 writes a simulated second, and a call is a tenth of one
        with board._lock:
            last, kept = board._newest[index], board._history[index]
            sample = board._newest[index] = Sample(value, 1 if last is None else last.seq + 1, now_s)
            if kept is not None:
                kept.append(sample)
            if board._tap is not None:
                board._tap(index, sample)
        for wake in board._watchers[index]:
            wake()


def enclosing(samples: tuple[Sample, ...], stamp_s: float) -> tuple[Sample, Sample] | None:
    """The two samples, of those oldest first, whose stamps enclose `stamp_s`, for interpolation; None if it lies outside."""
    i = len(samples)
    while i and samples[i - 1].value.stamp_s >= stamp_s:  # what is asked for is nearly always among the newest
        i -= 1
    if i < len(samples) and samples[i].value.stamp_s == stamp_s:
        return samples[i], samples[i]
    return (samples[i - 1], samples[i]) if 0 < i < len(samples) else None


class Snapshot:
    """All newest samples at one moment; what one tick of the tree sees.

    Attributes:
        reads: rows of the topics that were asked for, in this snapshot and in all that share the set; the black box keeps them whole.
    """

    __slots__ = ("_board", "_samples", "reads", "taken_s")

    def __init__(self, board: Blackboard, samples: tuple[Sample | None, ...], taken_s: float, reads: set[int] | None = None) -> None:
        self._board = board
        self._samples = samples
        self.taken_s = taken_s
        self.reads = set() if reads is None else reads

    def newest(self, name: str) -> Sample | None:
        """The sample that was newest when the snapshot was taken, or None if nobody had written."""
        index = self._board.index_of(name)
        self.reads.add(index)
        return self._samples[index]

    def history(self, name: str) -> tuple[Sample, ...]:
        """The last samples up to that moment, oldest first, as many as the board still keeps."""
        newest = self.newest(name)
        if newest is None:
            return ()
        kept = self._board.history(name)
        return kept if kept[-1] is newest else tuple(sample for sample in kept if sample.seq <= newest.seq)

    def around(self, name: str, stamp_s: float) -> tuple[Sample, Sample] | None:
        """The two samples whose stamps enclose `stamp_s`; None if it lies outside the history up to that moment."""
        return enclosing(self.history(name), stamp_s)

    def seq(self, index: int) -> int:
        """The sequence number of a row's sample, 0 without one; not a read."""
        sample = self._samples[index]
        return 0 if sample is None else sample.seq

    def age_s(self, name: str) -> float:
        """Seconds from the value's stamp to the snapshot; infinite without a value."""
        sample = self.newest(name)
        return math.inf if sample is None else self.taken_s - sample.value.stamp_s

    def is_stale(self, name: str) -> bool:
        """True if the value is missing or older than the table allows."""
        limit_s = self._board.topics[self._board.index_of(name)].stale_after_s
        return self.newest(name) is None or (limit_s > 0.0 and self.age_s(name) > limit_s)

    def __iter__(self) -> Iterator[tuple[Topic, Sample]]:
        return ((topic, sample) for topic, sample in zip(self._board.topics, self._samples, strict=True) if sample is not None)


class Blackboard:
    """The store of one robot. Several may live in one process; they share nothing."""

    def __init__(self, topics: Iterable[Topic] = TOPICS) -> None:
        self.topics = tuple(topics)
        self._index = {topic.name: i for i, topic in enumerate(self.topics)}
        if len(self._index) != len(self.topics):
            raise TopicError("two topics with one name")
        self._newest: list[Sample | None] = [None] * len(self.topics)
        self._history: list[deque[Sample] | None] = [deque(maxlen=topic.history) if topic.history > 1 else None for topic in self.topics]
        self._aging = [(i, topic.stale_after_s, topic.name) for i, topic in enumerate(self.topics) if topic.stale_after_s > 0.0]
        self._given: set[int] = set()  # topics whose publisher has been handed out
        self._watchers: list[tuple[Callable[[], None], ...]] = [()] * len(self.topics)
        self._lock = threading.Lock()
        self._tap: Callable[[int, Sample], None] | None = None

    def index_of(self, name: str) -> int:
        """The row of a topic. Raises TopicError with a suggestion if there is none of that name."""
        try:
            return self._index[name]
        except KeyError:
            raise TopicError(f'no topic "{name}"; {did_you_mean(name, self._index) or "docs/missions.md lists them"}') from None

    def topic(self, name: str) -> Topic:
        """The row of the table."""
        return self.topics[self.index_of(name)]

    def publisher(self, name: str, writer: str) -> Publisher:
        """The right to write `name`, given once and only to the writer named in the table."""
        index = self.index_of(name)
        topic = self.topics[index]
        if topic.writer != writer:
            raise TopicError(f"{name} is written by {topic.writer}, not by {writer}")
        if index in self._given:
            raise TopicError(f"{writer} has the right to write {name} already")
        self._given.add(index)
        return Publisher(self, index, topic)

    def newest(self, name: str) -> Sample | None:
        """The newest sample, or None if nobody has written yet."""
        return self._newest[self.index_of(name)]

    def reader(self, name: str) -> Callable[[], Sample | None]:
        """A fast way to ask for the newest sample of one topic again and again."""
        index, newest = self.index_of(name), self._newest
        return lambda: newest[index]

    def value_reader(self, name: str) -> Callable[[], Message | None]:
        """The same for the newest value."""
        index, newest = self.index_of(name), self._newest

        def value() -> Message | None:
            sample = newest[index]
            return None if sample is None else sample.value

        return value

    def is_stale(self, name: str, now_s: float) -> bool:
        """True if the value is missing or older than the table allows."""
        index = self.index_of(name)
        sample, limit_s = self._newest[index], self.topics[index].stale_after_s
        return sample is None or (limit_s > 0.0 and now_s - sample.value.stamp_s > limit_s)

    def stale(self, now_s: float) -> dict[str, float]:
        """Every topic that was written and is older than the table allows -> the stamp of its newest value (s)."""
        found: dict[str, float] = {}
        for index, limit_s, name in self._aging:
            sample = self._newest[index]
            if sample is not None and now_s - sample.value.stamp_s > limit_s:
                found[name] = sample.value.stamp_s
        return found

    def history(self, name: str) -> tuple[Sample, ...]:
        """The last samples, oldest first, as many as the table keeps."""
        index = self.index_of(name)
        with self._lock:
            kept, newest = self._history[index], self._newest[index]
            return tuple(kept) if kept is not None else () if newest is None else (newest,)

    def around(self, name: str, stamp_s: float) -> tuple[Sample, Sample] | None:
        """The two samples whose stamps enclose `stamp_s`, for interpolation; None if it lies outside the history."""
        return enclosing(self.history(name), stamp_s)

    def snapshot(self, now_s: float, reads: set[int] | None = None) -> Snapshot:
        """A consistent view of all topics; `reads` gathers what is asked of it."""
        with self._lock:
            return Snapshot(self, tuple(self._newest), now_s, reads)

    def tap(self, listen: Callable[[int, Sample], None]) -> None:
        """Let one listener hear every sample (row, sample) in the order of writing, inside the lock: it must only take a note."""
        self._tap = listen

    def put_back(self, name: str, sample: Sample) -> None:
        """Write a recorded sample with the number and time it had; for whoever plays a recording."""
        index = self.index_of(name)
        self._newest[index], kept = sample, self._history[index]
        if kept is not None:
            kept.append(sample)

    def on_change(self, name: str, wake: Callable[[], None]) -> None:
        """Call `wake` after each write of the topic, in the writer's thread; it must be quick and must not raise."""
        index = self.index_of(name)
        with self._lock:
            self._watchers[index] = (*self._watchers[index], wake)
