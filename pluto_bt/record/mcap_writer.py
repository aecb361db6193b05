"""Writes MCAP: chunks that are on disk soon, an index at the end, and a limit of size that costs the oldest bulky data first.

Messages of one kind share chunks of their own, so that dropping old bulk means leaving chunks out: nothing is decoded again.
The format: https://mcap.dev/spec. A file that was not finished (a crash) can be read up to its last whole chunk, and repaired.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections import Counter
from dataclasses import dataclass, field
from enum import IntEnum
from pathlib import Path
from typing import IO

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)

MAGIC = b"\x89MCAP0\r\n"
PROFILE = "pluto"
CHUNK_BYTES = 256 * 1024
CHUNK_NS = 2_000_000_000  # older messages than this do not wait for a full chunk
KEPT_SHARE = 0.75  # of the limit, once it was reached: else each new chunk would cost a copy of the file
_MESSAGE = struct.Struct("<BQHIQQ")
_CHUNK = struct.Struct("<BQQQQI")


class Bulk(IntEnum):
    """What a message is worth when room runs out; the highest goes first."""

    KEPT = 0  # what the rest cannot be read without: never dropped
    LOG = 1  # ticks, commands, events
    WHOLE = 2  # topics that a leaf reads: without them a run can be looked at, but not be executed again
    THINNED = 3  # a sample now and then of all other topics


@dataclass
class _OpenChunk:
    """Messages on their way into a chunk."""

    records: bytearray = field(default_factory=bytearray)
    index: dict[int, list[tuple[int, int]]] = field(default_factory=dict)
    start_ns: int = 0
    end_ns: int = 0


@dataclass
class _Written:
    """A chunk on disk with its message indexes."""

    bulk: Bulk
    at: ChunkIndex
    counts: Counter[int]

    @property
    def length(self) -> int:
        """Bytes of the chunk and its message indexes."""
        return self.at.chunk_length + self.at.message_index_length


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
        self._open = {bulk: _OpenChunk() for bulk in Bulk}
        self._chunks: list[_Written] = []
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
        if not chunk.records:
            chunk.start_ns = chunk.end_ns = time_ns
        chunk.index.setdefault(channel, []).append((time_ns, len(chunk.records)))
        chunk.records += _MESSAGE.pack(Opcode.MESSAGE, 22 + len(data), channel, sequence & 0xFFFFFFFF, time_ns, time_ns)
        chunk.records += data
        chunk.start_ns, chunk.end_ns = min(chunk.start_ns, time_ns), max(chunk.end_ns, time_ns)
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
        self._open[bulk] = _OpenChunk()
        self._write_chunk(bulk, bytes(chunk.records), chunk)

    def _write_chunk(self, bulk: Bulk, records: bytes, chunk: _OpenChunk) -> None:
        packed, kind, at = self._compress(records), b"zstd", self._file.tell()
        length = 8 + 8 + 8 + 4 + 4 + len(kind) + 8 + len(packed)
        head = _CHUNK.pack(Opcode.CHUNK, length, chunk.start_ns, chunk.end_ns, len(records), zlib.crc32(records))
        self._file.write(b"".join((head, struct.pack("<I", len(kind)), kind, struct.pack("<Q", len(packed)), packed)))
        indexes_at, offsets = self._file.tell(), {}
        for channel, entries in chunk.index.items():
            offsets[channel] = self._file.tell()
            flat = [number for entry in entries for number in entry]
            self._file.write(struct.pack(f"<BQHI{len(flat)}Q", Opcode.MESSAGE_INDEX, 6 + 8 * len(flat), channel, 8 * len(flat), *flat))
        index = ChunkIndex(indexes_at - at, at, kind.decode(), len(packed), chunk.end_ns, self._file.tell() - indexes_at, offsets, chunk.start_ns,
                           len(records))  # fmt: skip
        self._chunks.append(_Written(bulk, index, Counter({channel: len(entries) for channel, entries in chunk.index.items()})))

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
        kept = self._kept()
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
                self._copy(old, chunk)
            new.flush()
        self.dropped += len(self._chunks) - len(kept)
        self._chunks = kept
        os.replace(draft, self.path)

    def _kept(self) -> list[_Written]:
        """What fits: of the oldest, what is worth least goes first; the newest chunk of each kind stays."""
        size, wanted = self._preamble + sum(chunk.length for chunk in self._chunks), KEPT_SHARE * self.limit_bytes
        newest = {chunk.bulk: number for number, chunk in enumerate(self._chunks)}
        gone: set[int] = set()
        for bulk in (Bulk.THINNED, Bulk.WHOLE, Bulk.LOG):
            for number, chunk in enumerate(self._chunks):
                if size > wanted and chunk.bulk is bulk and number != newest[bulk]:
                    gone.add(number)
                    size -= chunk.length
        return [chunk for number, chunk in enumerate(self._chunks) if number not in gone]

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

    def _copy(self, old: IO[bytes], chunk: _Written) -> None:
        old.seek(chunk.at.chunk_start_offset)
        moved = self._file.tell() - chunk.at.chunk_start_offset
        self._file.write(old.read(chunk.length))
        chunk.at.chunk_start_offset += moved
        chunk.at.message_index_offsets = {channel: at + moved for channel, at in chunk.at.message_index_offsets.items()}
