"""Where everybody leaves what belongs into the black box: cheap, at once, from any thread. The recorder writes it out later."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any, NamedTuple

from pluto_bt.blackboard import Sample, Topic

RARE = ("tree", "modules", "map/local", "world/state")  # written on change but often, or large, and mostly said by the ticks


class Heard(NamedTuple):
    """A sample of a topic (row of the table), and whether every sample of it is kept."""

    topic: int
    sample: Sample
    is_whole: bool


class Notebook:
    """The queue of the black box, and which topics are kept whole."""

    def __init__(self, topics: Sequence[Topic], thinned_period_s: float) -> None:
        self.queue: deque[Any] = deque()
        self._period_s = thinned_period_s
        self._is_whole = [topic.period_s == 0.0 and topic.name not in RARE for topic in topics]
        self._next_s = [0.0] * len(topics)
        self._passed: list[Sample | None] = [None] * len(topics)

    def note(self, entry: Any) -> None:
        """A tick or a tree."""
        self.queue.append(entry)

    def hear(self, topic: int, sample: Sample) -> None:
        """A sample that was just written; inside the board's lock, so it must cost nothing."""
        if self._is_whole[topic]:
            self.queue.append(Heard(topic, sample, True))
        elif sample.written_s >= self._next_s[topic]:
            self._next_s[topic] = sample.written_s + self._period_s
            self.queue.append(Heard(topic, sample, False))
        else:
            self._passed[topic] = sample

    def will_keep(self, topic: int) -> None:
        """From here on every sample of the topic is kept."""
        self._is_whole[topic] = True

    def keep(self, topic: int, samples: Sequence[Sample]) -> None:
        """Keep what was written before; with it goes the last sample that was passed over."""
        last = self._passed[topic]
        self.queue.extend(Heard(topic, sample, True) for sample in (*samples, *(() if last is None else (last,))))
