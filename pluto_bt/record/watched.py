"""A recording made from outside: the topics that somebody heard of a running robot, without its tree and its files."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from pluto_bt.blackboard import TOPICS, Sample
from pluto_bt.record.codec import encode, schema_of
from pluto_bt.record.entries import RUN, WATCHED, Run
from pluto_bt.record.mcap_chunk import Bulk
from pluto_bt.record.mcap_writer import McapWriter
from pluto_bt.runtime.clock import NS

KINDS: Final = {topic.name: topic.type for topic in TOPICS}


class WatchedWriter:
    """Writes what is heard; `count` messages so far."""

    def __init__(self, path: Path, mission: str, version: str) -> None:
        """Raises: OSError if the file cannot be written."""
        self.count = 0
        self._file = McapWriter(path)
        self._channels: dict[str, int] = {}
        run = Run(version=version, mode=WATCHED, mission=mission)
        self._file.metadata(RUN, {"json": encode(run).decode(), "mission": mission})

    def take(self, topic: str, sample: Sample) -> None:
        """Write one value of a topic of the table."""
        if topic not in self._channels:
            self._channels[topic] = self._file.channel(topic, f"pluto.{KINDS[topic].__name__}", schema_of(KINDS[topic]))
        time_ns = round(sample.written_s * NS)
        self._file.message(self._channels[topic], Bulk.WHOLE, time_ns, sample.seq, encode(sample.value))
        self._file.flush(time_ns)
        self.count += 1

    def finish(self) -> None:
        """Write the index."""
        self._file.finish()
