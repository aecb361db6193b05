"""Reads MCAP from the first byte to the last one that makes sense.

A file whose writer was killed is read as far as it goes. Where a bad disk has hit a record, reading goes on at the next one that makes sense:
a head that is followed, at its own length, by another head or the end of the file. By chance that is met once in 10^20 bytes.
"""

from __future__ import annotations

import io
import mmap
import re
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, NamedTuple

import zstandard
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, Footer, McapRecord, Metadata, Schema
from mcap.stream_reader import CRCValidationError, StreamReader, get_chunk_data_stream

from pluto_bt.source import Faults, Place

MAGIC: Final = b"\x89MCAP0\r\n"
READ: Final = frozenset({Opcode.SCHEMA, Opcode.CHANNEL, Opcode.CHUNK, Opcode.METADATA, Opcode.ATTACHMENT, Opcode.FOOTER})
HEAD: Final = struct.Struct("<BQ")
HEAD_LIKE: Final = re.compile(rb"(?=[\x01-\x0f].{4}\x00{4})", re.DOTALL)  # at each byte: an opcode, and a length below 4 GiB
CHUNK_FIXED_BYTES: Final = 40  # of a chunk, without the name of its compression and its data
_BROKEN = (McapError, CRCValidationError, EOFError, struct.error, zlib.error, zstandard.ZstdError, ValueError, AttributeError, MemoryError,
           OverflowError)  # fmt: skip
_MESSAGE = struct.Struct("<BQHIQQ")


class Line(NamedTuple):
    """One message."""

    topic: str
    time_ns: int
    sequence: int
    data: bytes


@dataclass
class McapFile:
    """What a file holds besides its messages, and how far it can be read; `shown` is what the user calls it.

    `is_whole`: read to its end without a fault. `is_damaged`: something in it was changed; else what is not whole was cut short.
    """

    path: Path
    shown: str = ""
    is_whole: bool = False
    is_damaged: bool = False
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, Attachment] = field(default_factory=dict)

    def lines(self) -> Iterator[Line]:
        """Every message, in the order of the file; notes all else on the way."""
        for record in self._records():
            if isinstance(record, Chunk):
                yield from self._of_chunk(record)
            elif isinstance(record, Schema):
                self.schemas[record.id] = record
            elif isinstance(record, Channel):
                self.channels[record.id] = record
            elif isinstance(record, Metadata):
                self.metadata[record.name] = record.metadata
            elif isinstance(record, Attachment):
                self.attachments[record.name] = record

    def _records(self) -> Iterator[McapRecord]:
        self.is_whole = self.is_damaged = False
        with self.path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            at = len(MAGIC)
            while (end := _end_of(data, at)) or (at := _next_record(data, at)):
                if not end:
                    self.is_damaged = True
                    continue
                opcode = data[at]
                record = _read(data[at:end]) if opcode in READ else None
                self.is_damaged |= opcode in READ and record is None
                if isinstance(record, Footer):
                    self.is_whole = not self.is_damaged
                    return
                if record is not None:
                    yield record
                is_sound = opcode not in READ or (record is not None and _is_of_length(record, end - at))
                at = end if is_sound or _end_of(data, end) else at + 1

    def _of_chunk(self, chunk: Chunk) -> Iterator[Line]:
        try:
            stream, length = get_chunk_data_stream(chunk, validate_crc=True)
            data = stream.read(length)
        except _BROKEN:  # the others are still good
            self.is_damaged = True
            return
        at = 0
        while at + 9 <= length:
            opcode, size = HEAD.unpack_from(data, at)
            if opcode == Opcode.MESSAGE:
                _, _, channel, sequence, time_ns, _ = _MESSAGE.unpack_from(data, at)
                if channel in self.channels:
                    yield Line(self.channels[channel].topic, time_ns, sequence, data[at + _MESSAGE.size : at + 9 + size])
            at += 9 + size


def _end_of(data: mmap.mmap, at: int) -> int:
    """Where the record that begins at `at` ends; 0 if what stands there is no head of one."""
    if HEAD_LIKE.match(data, at) is None:
        return 0
    end = at + HEAD.size + int(HEAD.unpack_from(data, at)[1])
    return end if end <= len(data) else 0


def _next_record(data: mmap.mmap, at: int) -> int:
    """Where, behind `at`, a record begins that another one follows, or the end of the file; 0 if there is none."""
    for found in HEAD_LIKE.finditer(data, at + 1):
        end = _end_of(data, found.start())
        if end and (end == len(data) or _end_of(data, end) or data[end:] == MAGIC):
            return found.start()
    return 0


def _read(record: bytes) -> McapRecord | None:
    """One record, decoded; None if it makes no sense."""
    try:
        return next(StreamReader(io.BytesIO(record), skip_magic=True, emit_chunks=True).records)
    except _BROKEN:
        return None


def _is_of_length(record: McapRecord, length: int) -> bool:
    """A chunk knows its length twice; where they differ, the head is damaged and does not tell where the next record begins."""
    return not isinstance(record, Chunk) or length == HEAD.size + CHUNK_FIXED_BYTES + len(record.compression) + len(record.data)


def open_mcap(path: Path, shown: str, faults: Faults) -> McapFile | None:
    """The file, if it begins as MCAP does; else None and a fault."""
    try:
        with path.open("rb") as file:
            start = file.read(8)
    except OSError as error:
        faults.error(Place(shown), "no-such-file", f'cannot read "{shown}"', expected="a black box (.mcap)", found=error.strerror or str(error))
        return None
    if start != MAGIC:
        faults.error(Place(shown), "not-mcap", f'"{shown}" is no MCAP file', expected="a black box (.mcap), as `pluto run --record` writes it",
                     found=repr(start[:8])[2:-1] or "an empty file")  # fmt: skip
        return None
    return McapFile(path, shown)
