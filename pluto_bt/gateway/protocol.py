"""One client's side of the protocol without a socket: bytes in, messages out; lines in, bytes out. Time is passed in."""

from __future__ import annotations

import re
from collections.abc import Iterator

from pluto_bt.gateway.encode import encode
from pluto_bt.gateway.framing import Framer, FramingError, Message
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.replies import Error

_A_STOP, _AN_ESTOP = re.compile(rb"<stop[\s/>]"), re.compile(rb"<estop[\s/>]")
_LONGEST_STOP = len(b"<estop")
STOPS = frozenset({"stop", "estop"})
"""Messages that are heard from anyone, at any time, at any rate."""


class Connection:
    """The framing, the rate and the end of one connection.

    Attributes:
        queue: what `to_send` will give; only to be looked at.
        closing: a fatal error was said or the client is gone: send what is left, half-close, discard input for `linger_s`.
    """

    def __init__(self, limits: Limits | None = None) -> None:
        self._limits = limits or Limits()
        self._framer: Framer | None = Framer(self._limits)
        self.queue = self._out = bytearray()
        self._tokens = self._limits.messages_per_s
        self._refilled_s: float | None = None
        self._too_fast = False
        self._seen = b""  # of a flood: an end that may be the beginning of a stop
        self.closing = False

    def feed(self, data: bytes, now_s: float) -> Iterator[Message]:
        """The messages that `data` completes, one by one, so that the replies to them stand before the error that may follow.

        A fault ends the stream: the error stands in `to_send` and `closing` is true. A client that is too fast is closed, but a
        stop behind its flood is still heard. The iterator must be used up.
        """
        if self._too_fast:
            yield from self._stops_in(data)
            return
        try:
            for message in self._framer.feed(data) if self._framer else ():
                if message.tag in STOPS or (not self.closing and self._may_pass(message, now_s)):
                    yield message
                elif self.closing:
                    self._framer = None
                    yield from self._stops_in(data)
                    break
        except FramingError as error:
            self._framer = None
            self.fail(error.code, error.text, line=error.line, column=error.column)

    def _stops_in(self, data: bytes) -> Iterator[Message]:
        """The stops in a flood, found without a parser: it costs nearly nothing, and a stop too many is on the safe side.

        Of each kind one says as much as a thousand.
        """
        if not self._too_fast:
            return
        seen = self._seen + data
        for tag, pattern in (("stop", _A_STOP), ("estop", _AN_ESTOP)):
            if pattern.search(seen):
                yield Message(tag, {}, (), "", 0, 0, f"<{tag}/>".encode())
        last = seen.rfind(b"<")
        self._seen = seen[last:] if last >= len(seen) - _LONGEST_STOP and not _A_STOP.match(seen, last) else b""

    def _may_pass(self, message: Message, now_s: float) -> bool:
        """Take one token; without one the client is closed with `rate-limit`."""
        rate = self._limits.messages_per_s
        if self._refilled_s is not None:
            self._tokens = min(rate, self._tokens + (now_s - self._refilled_s) * rate)
        self._refilled_s = now_s
        if self._tokens < 1.0:
            self.fail("rate-limit", f"expected at most {rate:g} messages a second", line=message.line, column=message.column)
            return False
        self._tokens -= 1.0
        return True

    def fail(self, code: str, text: str, *, id: str = "", line: int = 0, column: int = 0) -> None:
        """Say a fatal error and close, once."""
        if not self.closing:
            self._out += encode(Error(id=id, code=code, text=text, line=line, column=column))
            self.closing = True
            if self.unfinished_bytes:  # it never will be, and may be large
                self._framer = None
            self._too_fast = code == "rate-limit"

    def close(self) -> None:
        """No more messages are taken; what waits is still sent."""
        self.closing = True
        self._framer = None

    def send(self, line: bytes) -> None:
        """Queue one encoded message; nothing follows a fatal error."""
        if not self.closing:
            self._out += line

    @property
    def unfinished_bytes(self) -> int:
        """What is kept of a message whose end has not come."""
        return self._framer.unfinished_bytes if self._framer is not None else 0

    @property
    def waiting_bytes(self) -> int:
        """Bytes that `to_send` would return."""
        return len(self._out)

    def to_send(self) -> bytes:
        """What is to be written to the client now."""
        out = bytes(self._out)
        self._out.clear()
        return out
