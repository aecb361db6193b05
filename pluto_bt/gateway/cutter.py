"""Where the tags, comments and texts of one message end, found before the parser sees them.

A parser that is given half a tag reads it again from its beginning when the next byte comes; a client who sends a large one byte by byte would
keep it busy. Here every byte is looked at once, and the parser gets whole ones only.
"""

from __future__ import annotations

import re

_MARKS = {b"": re.compile(rb"[\"'><]"), b'"': re.compile(rb'["<]'), b"'": re.compile(rb"['<]")}
"""What matters in a tag, by the quote that is open: `<` may stand nowhere in it, so the parser is given what there is, to say so at once."""
_SPECIAL = ((b"<!--", b"-->"), (b"<![CDATA[", b"]]>"), (b"<?", b"?>"))
_TAG_END = b">"


class Cutter:
    """Goes along one message, which begins with `<`.

    Attributes:
        safe: so many bytes of it are whole tags, comments and texts.
        is_end: the message ends there, if it is well-formed.
    """

    def __init__(self) -> None:
        self.safe = 0
        self.is_end = False
        self._at = 0  # looked at so far
        self._begin = 0  # of the tag or comment that is open
        self._closing = b""  # what closes it; b"" in a text
        self._quote = b""  # that is open in the tag
        self._depth = 0

    def advance(self, raw: bytearray) -> None:
        """Look at what has come; `raw` is the message from its first byte on, and perhaps more."""
        while not self.is_end and (self._closing or self._opened(raw)) and (end := self._closed(raw)):
            if self._closing == _TAG_END:
                self._count(raw[self._begin + 1 : self._begin + 2] == b"/", raw[end - 2 : end - 1] == b"/")
            self._closing, self._at, self.safe = b"", end, end

    def _opened(self, raw: bytearray) -> bool:
        """The text ends and a tag begins; False if not yet."""
        begin = raw.find(b"<", self._at)
        if begin < 0:
            if self.safe == self._at:  # half an entity is like half a tag
                entity = raw.find(b"&", self._at)
                self.safe = entity if entity >= 0 else len(raw)
            self._at = len(raw)
            return False
        self._begin = self._at = self.safe = begin
        head = bytes(raw[begin : begin + 9])
        for opening, closing in _SPECIAL:
            if head.startswith(opening):
                self._closing, self._at = closing, begin + len(opening)
                return True
        if any(opening.startswith(head) for opening, _ in _SPECIAL):
            return False
        self._closing, self._at = _TAG_END, begin + 1
        return True

    def _closed(self, raw: bytearray) -> int:
        """Behind what closes the open tag or comment, 0 if that has not come."""
        if self._closing != _TAG_END:
            found = raw.find(self._closing, self._at)
            self._at = max(self._at, len(raw) - 2)
            return found + len(self._closing) if found >= 0 else 0
        while mark := _MARKS[self._quote].search(raw, self._at):
            self._at = mark.end()
            if mark[0] in b"<>":
                return self._at
            self._quote = b"" if self._quote else bytes(mark[0])
        self._at = len(raw)
        return 0

    def _count(self, is_end_tag: bool, is_empty: bool) -> None:
        self._depth += -1 if is_end_tag else 0 if is_empty else 1
        self.is_end = self._depth <= 0
