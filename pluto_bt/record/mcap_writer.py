"""Writes MCAP: chunks that are on disk soon, an index at the end, and a limit of size that costs the oldest bulky data first.

Messages of one kind share chunks of their own, so that dropping old bulk means leaving chunks out: nothing is decoded again.
The format: https://mcap.dev/spec. A file that was not finished (a crash) can be read up to its last whole chunk, and repaired.
"""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path
from typing import IO

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)

from pluto_bt.record.mcap_chunk import Bulk, OpenChunk, WrittenChunk, packed, that_fit

MAGIC = b"\x89MCAP0\r\n"
PROFILE = "pluto"
CHUNK_BYTES = 256 * 1024
CHUNK_NS = 2_000_000_000  # older messages than this do not wait for a full chunk
KEPT_SHARE = 0.75  # of the limit, once it was reached: else each new chunk would cost a copy of the file


class McapWriter:
    """One file. Not thread-safe: one thread writes."""

    def __init__(self, path: Path, limit_bytes: int = 1 << 62, library: str = "pluto_bt") -> None:
        """Raises: OSError if the file cannot be written."""
        self.path, self.limit_bytes, self.dropped = path, limit_bytes, 0
        self._file: IO[bytes] = path.open("wb")
        self._compress = zstandard.ZstdCompressor(level=1).compress
        self._schemas: dict[str, Schema] = {}
        self._channels: list[Channel] = []
        self._attachments: list[AttachmentIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._open = {bulk: OpenChunk() for bulk in Bulk}
        self._chunks: list[WrittenChunk] = []
        self._preamble = 0  # bytes before the first chunk, and of channels between chunks: never dropped
        self._file.write(MAGIC)
        self._put(Header(PROFILE, library))

    # -- what a file holds

    def channel(self, topic: str, schema_name: str, schema: bytes) -> int:
        """A channel of JSON messages; its number."""
        known = self._schemas.get(schema_name)
        if known is None:
            known = self._schemas[schema_name] = Schema(len(self._schemas) + 1, schema, "jsonschema", schema_name)
            self._put(known)
        channel = Channel(len(self._channels) + 1, topic, "json", {}, known.id)
        self._channels.append(channel)
        self._put(channel)
        return channel.id

    def message(self, channel: int, bulk: Bulk, time_ns: int, sequence: int, data: bytes) -> None:
        """Add a message; it is on disk with its chunk."""
        chunk = self._open[bulk]
        chunk.add(channel, time_ns, sequence, data)
        if len(chunk.records) >= CHUNK_BYTES:
            self._close_chunk(bulk)

    def attachment(self, name: str, media_type: str, data: bytes) -> None:
        """Add a file within the file."""
        at, length = self._put(Attachment(0, 0, name, media_type, data))
        self._attachments.append(AttachmentIndex(at, length, 0, 0, len(data), name, media_type))

    def metadata(self, name: str, values: dict[str, str]) -> None:
        """Add a table of words."""
        at, length = self._put(Metadata(name, values))
        self._metadata.append(MetadataIndex(at, length, name))

    def flush(self, now_ns: int) -> None:
        """Bring to disk what is older than a moment, and keep the limit."""
        for bulk, chunk in self._open.items():
            if chunk.records and now_ns - chunk.start_ns >= CHUNK_NS:
                self._close_chunk(bulk)
        self._file.flush()
        self._keep_limit()

    def finish(self) -> None:
        """Write what waits, and the index; close the file."""
        for bulk in Bulk:
            self._close_chunk(bulk)
        self._keep_limit()
        self._put(DataEnd(0))
        start = self._file.tell()
        for record in self._summary():
            self._put(record)
        self._put(Footer(start, 0, 0))
        self._file.write(MAGIC)
        self._file.close()

    # -- bytes

    def _put(self, record: McapRecord) -> tuple[int, int]:
        """Write a record; (where it stands, its length)."""
        builder = RecordBuilder()
        record.write(builder)
        data, at = bytes(builder.end()), self._file.tell()  # type: ignore[no-untyped-call]  # the library types only half of itself
        self._file.write(data)
        if not isinstance(record, (DataEnd, Footer)):
            self._preamble += len(data)
        return at, len(data)

    def _close_chunk(self, bulk: Bulk) -> None:
        chunk = self._open[bulk]
        if not chunk.records:
            return
        self._open[bulk] = OpenChunk()
        data, written = packed(bulk, chunk, self._file.tell(), self._compress)
        self._file.write(data)
        self._chunks.append(written)

    def _summary(self) -> list[McapRecord]:
        counts: Counter[int] = sum((chunk.counts for chunk in self._chunks), Counter())
        start_ns = min((chunk.at.message_start_time for chunk in self._chunks), default=0)
        end_ns = max((chunk.at.message_end_time for chunk in self._chunks), default=0)
        statistics = Statistics(
            attachment_count=len(self._attachments), channel_count=len(self._channels), channel_message_counts=dict(counts),
            chunk_count=len(self._chunks), message_count=counts.total(), metadata_count=len(self._metadata), message_start_time=start_ns,
            message_end_time=end_ns, schema_count=len(self._schemas),
        )  # fmt: skip
        chunks = [chunk.at for chunk in self._chunks]
        return [*self._schemas.values(), *self._channels, statistics, *chunks, *self._attachments, *self._metadata]

    # -- the limit

    def _keep_limit(self) -> None:
        """Shrink if the file, with the index that it will have, is too large."""
        index = self._preamble + sum(80 + 10 * len(chunk.at.message_index_offsets) for chunk in self._chunks)
        if self._file.tell() + index > self.limit_bytes:
            self._shrink()

    def _shrink(self) -> None:
        """Copy the file without its oldest, bulkiest chunks; the old one stays until the new one is whole."""
        kept = that_fit(self._chunks, KEPT_SHARE * self.limit_bytes - self._preamble)
        if len(kept) == len(self._chunks):
            return
        self._file.flush()
        draft = self.path.with_name(self.path.name + ".new")
        with self.path.open("rb") as old:
            new = draft.open("wb")
            self._file.close()
            self._file, self._preamble = new, 0
            self._begin_again(old)
            for chunk in kept:
                old.seek(chunk.at.chunk_start_offset)
                data = old.read(chunk.length)
                chunk.move_to(self._file.tell())
                self._file.write(data)
            new.flush()
        self.dropped += len(self._chunks) - len(kept)
        self._chunks = kept
        os.replace(draft, self.path)

    def _begin_again(self, old: IO[bytes]) -> None:
        """Everything but chunks, in front."""
        self._file.write(MAGIC)
        self._put(Header(PROFILE, "pluto_bt"))
        records: list[McapRecord] = [*self._schemas.values(), *self._channels]
        for record in records:
            self._put(record)
        known: list[MetadataIndex | AttachmentIndex] = [*self._metadata, *self._attachments]
        for index in known:
            old.seek(index.offset)
            data = old.read(index.length)
            index.offset = self._file.tell()
            self._file.write(data)
            self._preamble += len(data)
