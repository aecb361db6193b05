"""A chunk of an MCAP file: messages of one worth, packed together, with an index of where each stands."""

from __future__ import annotations

import struct
import zlib
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import IntEnum

from mcap.opcode import Opcode
from mcap.records import ChunkIndex

_MESSAGE = struct.Struct("<BQHIQQ")
_CHUNK = struct.Struct("<BQQQQI")
_COMPRESSION = b"zstd"


class Bulk(IntEnum):
    """What a message is worth when room runs out; the highest goes first."""

    KEPT = 0  # what the rest cannot be read without: never dropped
    LOG = 1  # ticks, commands, events
    WHOLE = 2  # topics that a leaf reads: without them a run can be looked at, but not be executed again
    THINNED = 3  # a sample now and then of all other topics


@dataclass
class OpenChunk:
    """Messages on their way into a chunk. `index`: channel -> (time, place in `records`) of each of its messages."""

    records: bytearray = field(default_factory=bytearray)
    index: dict[int, list[tuple[int, int]]] = field(default_factory=dict)
    start_ns: int = 0
    end_ns: int = 0

    def add(self, channel: int, time_ns: int, sequence: int, data: bytes) -> None:
        """Take one message."""
        if not self.records:
            self.start_ns = self.end_ns = time_ns
        self.index.setdefault(channel, []).append((time_ns, len(self.records)))
        self.records += _MESSAGE.pack(Opcode.MESSAGE, 22 + len(data), channel, sequence & 0xFFFFFFFF, time_ns, time_ns)
        self.records += data
        self.start_ns, self.end_ns = min(self.start_ns, time_ns), max(self.end_ns, time_ns)


@dataclass
class WrittenChunk:
    """A chunk on disk with its message indexes."""

    bulk: Bulk
    at: ChunkIndex
    counts: Counter[int]

    @property
    def length(self) -> int:
        """Bytes of the chunk and its message indexes."""
        return self.at.chunk_length + self.at.message_index_length

    def move_to(self, start: int) -> None:
        """It stands there now."""
        moved = start - self.at.chunk_start_offset
        self.at.chunk_start_offset = start
        self.at.message_index_offsets = {channel: at + moved for channel, at in self.at.message_index_offsets.items()}


def packed(bulk: Bulk, chunk: OpenChunk, start: int, compress: Callable[[bytes], bytes]) -> tuple[bytes, WrittenChunk]:
    """The bytes of a chunk with its message indexes behind it, and what to remember of it; it will stand at `start` of the file."""
    records = bytes(chunk.records)
    data, counts = compress(records), Counter({channel: len(entries) for channel, entries in chunk.index.items()})
    length = 8 + 8 + 8 + 4 + 4 + len(_COMPRESSION) + 8 + len(data)
    parts = [
        _CHUNK.pack(Opcode.CHUNK, length, chunk.start_ns, chunk.end_ns, len(records), zlib.crc32(records)),
        struct.pack("<I", len(_COMPRESSION)), _COMPRESSION, struct.pack("<Q", len(data)), data,
    ]  # fmt: skip
    chunk_length = sum(map(len, parts))
    at, offsets = start + chunk_length, {}
    for channel, entries in chunk.index.items():
        flat = [number for entry in entries for number in entry]
        parts.append(struct.pack(f"<BQHI{len(flat)}Q", Opcode.MESSAGE_INDEX, 6 + 8 * len(flat), channel, 8 * len(flat), *flat))
        offsets[channel] = at
        at += len(parts[-1])
    index = ChunkIndex(chunk_length, start, _COMPRESSION.decode(), len(data), chunk.end_ns, at - start - chunk_length, offsets, chunk.start_ns,
                       len(records))  # fmt: skip
    return b"".join(parts), WrittenChunk(bulk, index, counts)


def that_fit(chunks: Sequence[WrittenChunk], room_bytes: float) -> list[WrittenChunk]:
    """What fits into so many bytes: of the oldest, what is worth least goes first; the newest chunk of each kind stays."""
    size = sum(chunk.length for chunk in chunks)
    newest = {chunk.bulk: number for number, chunk in enumerate(chunks)}
    gone: set[int] = set()
    for bulk in (Bulk.THINNED, Bulk.WHOLE, Bulk.LOG):
        for number, chunk in enumerate(chunks):
            if size > room_bytes and chunk.bulk is bulk and number != newest[bulk]:
                gone.add(number)
                size -= chunk.length
    return [chunk for number, chunk in enumerate(chunks) if number not in gone]
