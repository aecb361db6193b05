"""The recorder: fills the black box of a run (`--record FILE.mcap`). Whoever has something to note leaves it in a queue; the file is written here.

What is kept: every tick; commands, events and whatever else is written on change; every sample of a topic that a leaf of this run reads; of
all other topics a sample now and then. When the file reaches its limit the oldest bulk goes first.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pluto_bt.modules.context import Context
from pluto_bt.modules.notebook import Heard
from pluto_bt.modules.record_parameters import RecordParameters
from pluto_bt.record.codec import encode, schema_of
from pluto_bt.record.entries import RUN, TICK, TREE, Run, Tick, Tree
from pluto_bt.record.mcap_chunk import Bulk
from pluto_bt.record.mcap_writer import McapWriter
from pluto_bt.runtime.clock import NS

MIB = 1 << 20


class Recorder:
    """Steps twice a second of the run: whatever waits is encoded and written."""

    def __init__(self, context: Context) -> None:
        """Raises: OSError if the file cannot be written."""
        options, notebook = context.system.options, context.black_box
        assert notebook is not None and options.record is not None, "made only for a run that is recorded"
        parameters = context.parameters(RecordParameters)
        self._queue = notebook.queue
        self._clock = context.clock
        self._writer: McapWriter | None = McapWriter(Path(options.record.path), round(parameters.limit_mb * MIB))
        self._numbers: dict[str, int] = {}
        self._is_rare = [topic.period_s == 0.0 for topic in context.board.topics]
        self._begin(options.record.run, options.record.files)
        self._of_topic = [self._writer.channel(topic.name, f"pluto.{topic.type.__name__}", schema_of(topic.type)) for topic in context.board.topics]
        context.board.tap(notebook.hear)

    def _begin(self, run: Run, files: dict[str, bytes]) -> None:
        writer = self._writer
        assert writer is not None  # just made
        writer.metadata(RUN, {"json": encode(run).decode(), "mission": run.mission, "world": run.world, "seed": str(run.seed)})
        for name, data in files.items():
            writer.attachment(name, "application/xml" if name.endswith(".xml") else "application/octet-stream", data)
        for name, kind in ((TREE, Tree), (TICK, Tick)):
            self._numbers[name] = writer.channel(name, f"pluto.{kind.__name__}", schema_of(kind))

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
        if type(note) is Heard:
            topic, sample, is_whole = note
            bulk = Bulk.THINNED if not is_whole else Bulk.LOG if self._is_rare[topic] else Bulk.WHOLE
            writer.message(self._of_topic[topic], bulk, round(sample.written_s * NS), sample.seq, encode(sample.value))
        elif isinstance(note, Tick):
            writer.message(self._numbers[TICK], Bulk.LOG, note.t_ns, note.step, encode(note))
        elif isinstance(note, Tree):
            writer.message(self._numbers[TREE], Bulk.KEPT, now_ns, note.run, encode(note))
