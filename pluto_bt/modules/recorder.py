"""The recorder: fills the black box of a run (`--record FILE.mcap`). Whoever has something to note leaves it in a queue; the file is written here.

What is kept: every tick; commands, events and whatever else is written on change; every sample of a topic that a leaf of this run reads; of
all other topics a sample now and then. When the file reaches its limit the oldest bulk goes first.
"""

from __future__ import annotations

from collections import deque
from pathlib import Path
from typing import Any

from pluto_bt.blackboard import Sample
from pluto_bt.modules.context import Context
from pluto_bt.modules.record_parameters import RecordParameters
from pluto_bt.modules.tick_log import Whole
from pluto_bt.record.codec import encode, schema_of
from pluto_bt.record.entries import RUN, TICK, TREE, Run, Tick, Tree
from pluto_bt.record.mcap_writer import Bulk, McapWriter
from pluto_bt.runtime.clock import NS

MIB = 1 << 20
SAID_BY_TICKS = ("tree", "modules", "map/local")  # large, and mostly said by the ticks


class Recorder:
    """Steps twice a second of the run: whatever waits is encoded and written."""

    def __init__(self, context: Context) -> None:
        """Raises: OSError if the file cannot be written."""
        options, queue = context.system.options, context.black_box
        assert queue is not None and options.record is not None, "made only for a run that is recorded"
        parameters = context.parameters(RecordParameters)
        self._queue: deque[Any] = queue
        self._topics = context.board.topics
        self._clock = context.clock
        self._period_s = parameters.thinned_period_s
        self._writer: McapWriter | None = McapWriter(Path(options.record.path), round(parameters.limit_mb * MIB))
        self._numbers: dict[str, int] = {}
        self._whole = {i for i, topic in enumerate(self._topics) if topic.period_s == 0.0 and topic.name not in SAID_BY_TICKS}
        self._written: dict[int, int] = {}
        self._next_s = [0.0] * len(self._topics)
        self._passed: dict[int, Sample] = {}  # the newest sample of a topic that was left out
        self._begin(options.record.run, options.record.files)
        context.board.tap(lambda index, sample: queue.append((index, sample)))

    def _begin(self, run: Run, files: dict[str, bytes]) -> None:
        writer = self._writer
        assert writer is not None  # just made
        writer.metadata(RUN, {"json": encode(run).decode(), "mission": run.mission, "world": run.world, "seed": str(run.seed)})
        for name, data in files.items():
            writer.attachment(name, "application/xml" if name.endswith(".xml") else "application/octet-stream", data)
        for name, kind in ((TREE, Tree), (TICK, Tick)):
            self._numbers[name] = writer.channel(name, f"pluto.{kind.__name__}", schema_of(kind))
        for topic in self._topics:
            self._numbers[topic.name] = writer.channel(topic.name, f"pluto.{topic.type.__name__}", schema_of(topic.type))

    def start(self, now_s: float) -> None:
        """The file is open already, so that a bad name is told before anything moves."""

    def step(self, now_s: float) -> None:
        """Write what waits."""
        writer, queue = self._writer, self._queue
        if writer is None:
            return
        now_ns = round(now_s * NS)
        for _ in range(len(queue)):
            self._take(writer, queue.popleft(), now_ns)
        writer.flush(now_ns)

    def stop(self) -> None:
        """Nothing is lost: what comes waits in the queue."""
        self.step(self._clock.now_s())

    def finish(self, result: str) -> None:
        """The run is over: write the rest, the outcome (JSON) and the index."""
        writer = self._writer
        if writer is not None:
            self.step(self._clock.now_s())
            writer.metadata("pluto/result", {"json": result})
            writer.finish()
            self._writer = None

    def _take(self, writer: McapWriter, note: Any, now_ns: int) -> None:
        if type(note) is tuple:
            self._sample(writer, *note)
        elif isinstance(note, Tick):
            writer.message(self._numbers[TICK], Bulk.LOG, note.t_ns, note.step, encode(note))
        elif isinstance(note, Tree):
            writer.message(self._numbers[TREE], Bulk.KEPT, now_ns, note.run, encode(note))
        elif isinstance(note, Whole):
            self._whole.add(note.topic)
            late = self._passed.pop(note.topic, None)  # written while the tick went on that asked for the topic first
            for sample in (*note.samples, *(() if late is None else (late,))):
                self._sample(writer, note.topic, sample)

    def _sample(self, writer: McapWriter, index: int, sample: Sample) -> None:
        topic = self._topics[index]
        if index in self._whole:
            if sample.seq <= self._written.get(index, 0):
                return
            self._written[index] = sample.seq
            bulk = Bulk.LOG if topic.period_s == 0.0 else Bulk.WHOLE
        elif sample.written_s < self._next_s[index]:
            self._passed[index] = sample
            return
        else:
            bulk = Bulk.THINNED
            self._next_s[index] = sample.written_s + self._period_s
        writer.message(self._numbers[topic.name], bulk, round(sample.written_s * NS), sample.seq, encode(sample.value))
