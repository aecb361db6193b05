"""From a stream of bytes to complete XML elements, with every bound kept before the parser can be hurt.

No socket, no thread, no clock. A fresh parser serves each message: it is fed a private root first, which makes a DOCTYPE a syntax
error, and positions and memory end with the message. Pieces are cut behind each `>`, so that a message ends where a piece ends
and bytes between messages never reach the parser.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import msgspec
from lxml import etree

from pluto_bt.gateway.child import Child, child_of, text_of
from pluto_bt.gateway.complaint import complaint
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.opening import OpeningError, opening
from pluto_bt.gateway.plain import PLAIN_ATTRIBUTES, PLAIN_DEPTH, take

_SPACE = re.compile(rb"[ \t\r\n]*")


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
        self._parser: Any = None
        self._depth = 0
        self._in_mission = False
        self._end: re.Pattern[bytes] | None = None  # of the message's end tag, once its start tag is complete
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
            at, element = self._inside(data, at)
            if element is not None:
                yield self._complete(element)

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
        # huge_tree lifts libxml2's own depth limit, which is one short of ours; all sizes are bounded here.
        self._parser = etree.XMLPullParser(
            events=("start", "end", "pi"),
            resolve_entities="internal",  # type: ignore[arg-type]  # the stubs know lxml 4 only
            no_network=True,
            load_dtd=False,
            huge_tree=True,
            encoding="utf-8",
        )
        self._parser.feed(b"<private>\n")
        for _ in self._parser.read_events():
            pass
        self._begun = True
        self._depth = 0
        self._in_mission = False
        self._parse(bytes(self._raw))

    def _inside(self, data: bytes, at: int) -> tuple[int, Any]:
        """Feed the parser up to where the message may end; the position after it, and the element if it is complete."""
        self._require_room(1)
        end = self._next_cut(data, at)
        piece = data[at : min(end, at + self._room())]
        self._raw += piece
        self._count += len(piece)
        return at + len(piece), self._parse(piece)

    def _next_cut(self, data: bytes, at: int) -> int:
        """Behind the next `>`, if that may be of the last tag; else behind all that surely stands before it."""
        if self._end is not None and b">" in self._raw[self._raw.rfind(b"<") :]:  # no tag is open, so that an end tag is whole or not here
            found = self._end.search(data, at)
            if found is not None:
                return found.end()
            last = data.rfind(b"<", at)
            if last < 0 or data.find(b">", last) >= 0:
                return len(data)
            if last > at:
                return last
        return data.find(b">", at) + 1 or len(data)

    def _parse(self, piece: bytes) -> Any:
        """The message's element if this piece completes it."""
        failure: etree.XMLSyntaxError | None = None
        try:
            self._parser.feed(piece)
        except etree.XMLSyntaxError as error:
            failure = error
        done = None
        for event, element in self._parser.read_events():
            done = self._event(event, element)
        if failure is not None:
            raise self._syntax(failure)
        return done

    def _event(self, event: str, element: Any) -> Any:
        """Keep the bounds that show at a tag; the element if it is the end of the message."""
        if event == "pi":
            raise self._error("restricted-xml", "expected elements and text, found a processing instruction", element.sourceline)
        if event == "end":
            self._depth -= 1
            if self._in_mission and self._depth > 0:  # its document is wanted as text: no tree of it piles up
                element.getparent().remove(element)
            return element if self._depth == 0 else None
        self._depth += 1
        if self._depth == 1:
            self._in_mission = element.tag == "mission"
            self._end = re.compile(rb"</" + re.escape(self._raw_name()) + rb"\s*>")
        limit = self._limits.mission_depth + 1 if self._in_mission else self._limits.depth
        if self._depth > limit:
            raise self._error("too-deep", f"expected at most {limit} elements inside each other", element.sourceline)
        if any(":" in name and name[0] != "{" for name in (element.tag, *element.attrib)):  # libxml2 complains of these sooner or later
            raise self._error("not-well-formed", f"expected names without a stray colon, found <{element.tag}>", element.sourceline)
        count = len(element.attrib) + (len(element.nsmap) if element.nsmap else 0)
        if count > self._limits.attributes:
            raise self._error("too-large", f"expected at most {self._limits.attributes} attributes, found {count}", element.sourceline)
        return None

    def _syntax(self, error: etree.XMLSyntaxError) -> FramingError:
        """libxml2's complaint, under our code and at the stream's position."""
        code, text = complaint(error, self._raw)
        line, column = error.position
        return self._error(code, text, line, column)

    def _raw_name(self) -> bytes:
        """The message's tag as it was written, prefix and all."""
        return bytes(re.split(rb"[\s/>]", self._raw[1:], maxsplit=1)[0])

    def _complete(self, element: Any) -> Message:
        raw, in_mission = bytes(self._raw), self._in_mission
        inside = () if in_mission else tuple(child_of(one) for one in element if isinstance(one.tag, str))
        text = "" if in_mission else text_of(element)
        message = Message(element.tag, dict(element.attrib), inside, text, self._line, self._column, raw)
        self._parser = self._end = None
        self._forget(raw)
        return message

    # bookkeeping -------------------------------------------------------------------------------------------------
    def _room(self) -> int:
        return (self._limits.mission_bytes if self._in_mission else self._limits.message_bytes) - self._count

    def _require_room(self, wanted: int) -> None:
        if wanted > self._room():
            limit = self._limits.mission_bytes if self._in_mission else self._limits.message_bytes
            raise self._error("too-large", f"expected a complete message within {limit} bytes")

    def _forget(self, head: bytes) -> None:
        """`head` was taken as a whole: count on from behind it."""
        self._advance(head)
        self._raw.clear()
        self._count = 0
        self._in_mission = False
        self._begun = True

    def _advance(self, taken: bytes) -> None:
        newlines = taken.count(b"\n")
        if newlines:
            self._line += newlines
            self._column = 1
            taken = taken[taken.rindex(b"\n") + 1 :]
        self._column += len(taken.decode("utf-8", "ignore"))

    def _error(self, code: str, text: str, line: int = 0, column: int = 0) -> FramingError:
        """An error at the parser's line and column (which begin behind the private root's line), else at the message's begin."""
        line = max(0, line - 2)
        return FramingError(code, text, self._line + line, (column if line else self._column + max(0, column - 1)))
