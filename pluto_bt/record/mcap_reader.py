"""Reads MCAP from the first byte to the last one that makes sense: a file whose writer was killed is read as far as it goes."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import zstandard
from mcap.exceptions import McapError
from mcap.records import Attachment, Channel, Chunk, Footer, McapRecord, Metadata, Schema
from mcap.stream_reader import CRCValidationError, StreamReader, get_chunk_data_stream

from pluto_bt.source import Faults, Place

RECORD_BYTES = 1 << 30  # a length above it is no length
_BROKEN = (McapError, CRCValidationError, EOFError, struct.error, zlib.error, zstandard.ZstdError, ValueError, AttributeError, MemoryError)
_MESSAGE = struct.Struct("<BQHIQQ")
_MESSAGE_OPCODE = 5


class Line(NamedTuple):
    """One message."""

    topic: str
    time_ns: int
    sequence: int
    data: bytes


@dataclass
class McapFile:
    """What a file holds besides its messages, and how far it can be read; `shown` is what the user calls it."""

    path: Path
    shown: str = ""
    is_whole: bool = False
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
        self.is_whole = False
        with self.path.open("rb") as file:
            reader = StreamReader(file, emit_chunks=True, record_size_limit=RECORD_BYTES)
            try:
                for record in reader.records:
                    if isinstance(record, Footer):
                        self.is_whole = True
                        return
                    yield record
            except _BROKEN:
                return

    def _of_chunk(self, chunk: Chunk) -> Iterator[Line]:
        try:
            stream, length = get_chunk_data_stream(chunk, validate_crc=True)
            data = stream.read(length)
        except _BROKEN:  # a chunk that a bad disk has hit: the others are still good
            self.is_whole = False
            return
        at = 0
        while at + 9 <= length:
            opcode, size = struct.unpack_from("<BQ", data, at)
            if opcode == _MESSAGE_OPCODE:
                _, _, channel, sequence, time_ns, _ = _MESSAGE.unpack_from(data, at)
                if channel in self.channels:
                    yield Line(self.channels[channel].topic, time_ns, sequence, data[at + _MESSAGE.size : at + 9 + size])
            at += 9 + size


def open_mcap(path: Path, shown: str, faults: Faults) -> McapFile | None:
    """The file, if it begins as MCAP does; else None and a fault."""
    try:
        with path.open("rb") as file:
            start = file.read(8)
    except OSError as error:
        faults.error(Place(shown), "no-such-file", f'cannot read "{shown}"', expected="a black box (.mcap)", found=error.strerror or str(error))
        return None
    if start != b"\x89MCAP0\r\n":
        faults.error(Place(shown), "not-mcap", f'"{shown}" is no MCAP file', expected="a black box (.mcap), as `pluto run --record` writes it",
                     found=repr(start[:8])[2:-1] or "an empty file")  # fmt: skip
        return None
    return McapFile(path, shown)
