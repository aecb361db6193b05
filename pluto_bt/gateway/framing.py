"""From a stream of bytes to complete XML elements, with every bound kept before the parser can be hurt.

No socket, no thread, no clock. A fresh parser serves each message (`reading.py`): it is fed a private root first, which makes a DOCTYPE a
syntax error, and positions, names and memory end with the message. It gets whole tags and texts (`cutter.py`), up to the message's end,
so that bytes between messages never reach it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from xml.parsers import expat

import msgspec

from pluto_bt.gateway.child import Child
from pluto_bt.gateway.complaint import complaint
from pluto_bt.gateway.cutter import Cutter
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.opening import OpeningError, opening
from pluto_bt.gateway.plain import PLAIN_ATTRIBUTES, PLAIN_DEPTH, take
from pluto_bt.gateway.reading import ROOT, Reading, RestrictedError

_SPACE = re.compile(rb"[ \t\r\n]*")
_PIECE_BYTES = 4096


class FramingError(Exception):
    """The stream cannot go on. `code` is one of the fatal codes; line and column count from 1 at the start of the stream."""

    def __init__(self, code: str, text: str, line: int, column: int) -> None:
        super().__init__(text)
        self.code = code
        self.text = text
        self.line = line
        self.column = column


class Message(msgspec.Struct, frozen=True, gc=False):
    """One complete top-level element: what is in it, and where it began in the stream.

    `text` is what stands beside the children. Of a `mission` neither is told: its document is in `raw`, the bytes as they came (b"" if the
    message is plain).
    """

    tag: str
    attrib: dict[str, str]
    children: tuple[Child, ...]
    text: str
    line: int
    column: int
    raw: bytes = b""


class Framer:
    """Bytes in, messages out. After an error it is spent: never feed it again."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._line, self._column = 1, 1  # of the first byte not yet in `_raw`, or of the message's first byte
        self._count = 0  # bytes since the last complete message
        self._raw = bytearray()  # of the message, or of what may become one ("<", "<?xml …")
        self._begun = False  # anything but the start of the stream is behind us
        self._parser: expat.XMLParserType | None = None
        self._reading = Reading(limits)
        self._cutter = Cutter()
        self._parsed = 0  # bytes of `_raw` that the parser has had
        self._most = limits.message_bytes
        self._takes_plain = limits.attributes >= PLAIN_ATTRIBUTES and limits.depth >= PLAIN_DEPTH

    def feed(self, data: bytes) -> Iterator[Message]:
        """The messages that `data` completes, as they complete. Raises: FramingError."""
        at = 0
        text = data.decode() if self._takes_plain and data.isascii() else ""
        while at < len(data):
            plain = take(text, at) if text and self._parser is None and not self._raw else None
            if plain is not None and plain[4] - at <= self._most - self._count:
                tag, attrib, children, start, end = plain
                if start - at == 1 and text[at] == "\n":
                    self._line, self._column = self._line + 1, 1
                elif start > at:
                    self._advance(data[at:start])
                yield Message(tag, attrib, children, "", self._line, self._column)
                self._column += end - start
                self._count, self._begun, at = 0, True, end
                continue
            if self._parser is None:
                at = self._between(data, at)
                continue
            at = self._inside(data, at)
            if self._reading.is_complete:
                yield self._complete()

    @property
    def unfinished_bytes(self) -> int:
        """What is kept of a message that has begun."""
        return len(self._raw)

    # between messages --------------------------------------------------------------------------------------------
    def _between(self, data: bytes, at: int) -> int:
        """Take white space, or one byte of what opens a message; the position after it."""
        if not self._raw:
            end = _SPACE.match(data, at).end()  # type: ignore[union-attr]  # matches the empty string too
            if end > at:
                space = data[at : min(end, at + self._room())]
                self._count += len(space)
                self._begun = True
                self._advance(space)
                self._require_room(end - at - len(space))
                return end
        self._require_room(1)
        self._raw += data[at : at + 1]
        self._count += 1
        self._decide()
        return at + 1

    def _decide(self) -> None:
        """Whether the bytes in `_raw` open a message, are the declaration, or break the stream."""
        head = bytes(self._raw)
        try:
            found = opening(head, is_first=not self._begun)
        except OpeningError as error:
            raise self._error(error.code, error.text) from None
        if found == "message":
            self._open()
        elif found == "declaration":
            self._forget(head)

    # inside a message --------------------------------------------------------------------------------------------
    def _open(self) -> None:
        """A message begins: give a fresh parser its private root and the bytes that waited."""
        self._reading, self._cutter, self._parsed = Reading(self._limits), Cutter(), 0
        self._parser = self._reading.parser()
        self._begun = True

    def _inside(self, data: bytes, at: int) -> int:
        """Feed the parser what is whole; the position after what belongs to the message."""
        self._require_room(1)
        piece = data[at : at + min(self._room(), _PIECE_BYTES)]
        self._raw += piece
        cutter = self._cutter
        cutter.advance(self._raw)
        behind = len(self._raw) - cutter.safe if cutter.is_end else 0
        if behind:
            del self._raw[cutter.safe :]
        self._count += len(piece) - behind
        if cutter.safe > self._parsed:
            self._parse(bytes(self._raw[self._parsed : cutter.safe]))
            self._parsed = cutter.safe
            if cutter.is_end and not self._reading.is_complete:
                raise self._error("bad-encoding", "expected UTF-8, found half a character at the message's end")
        return at + len(piece) - behind

    def _parse(self, piece: bytes) -> None:
        """Raises: FramingError at the place of what the parser, or one of the bounds, does not let pass."""
        parser = self._parser
        assert parser is not None
        try:
            parser.Parse(piece, False)
        except RestrictedError as error:
            raise self._error(error.code, error.text) from None
        except expat.ExpatError as error:
            code, text = complaint(error.code, self._raw, parser.ErrorByteIndex - len(ROOT), self._reading.open)
            raise self._error(code, text, parser.ErrorLineNumber, parser.ErrorColumnNumber) from None

    def _complete(self) -> Message:
        raw, reading = bytes(self._raw), self._reading
        message = Message(reading.tag, reading.attrib, tuple(reading.children), reading.text, self._line, self._column, raw)
        self._parser = None
        self._forget(raw)
        return message

    # bookkeeping -------------------------------------------------------------------------------------------------
    def _room(self) -> int:
        return self._limit() - self._count

    def _limit(self) -> int:
        return self._limits.mission_bytes if self._parser is not None and self._reading.is_mission else self._limits.message_bytes

    def _require_room(self, wanted: int) -> None:
        if wanted > self._room():
            raise self._error("too-large", f"expected a complete message within {self._limit()} bytes")

    def _forget(self, head: bytes) -> None:
        """`head` was taken as a whole: count on from behind it."""
        self._advance(head)
        self._raw.clear()
        self._count = 0
        self._begun = True

    def _advance(self, taken: bytes) -> None:
        newlines = taken.count(b"\n")
        if newlines:
            self._line += newlines
            self._column = 1
            taken = taken[taken.rindex(b"\n") + 1 :]
        self._column += len(taken.decode("utf-8", "ignore"))

    def _error(self, code: str, text: str, line: int = 0, column: int = 0) -> FramingError:
        """An error at the parser's line (the private root's is 1) and column (from 0), else at the message's begin."""
        line = max(0, line - 2)
        return FramingError(code, text, self._line + line, column + (1 if line else self._column))
