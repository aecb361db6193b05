"""The newest value of each watched topic in the gateway process, encoded once for all clients."""

from __future__ import annotations

from pluto_bt.blackboard.messages import Message
from pluto_bt.gateway.values import body_of, value_line
from pluto_bt.gateway.wire import unpack_value


class Newest:
    """One value, decoded and encoded when the first client wants it.

    `age_s` is the age when the executive sent it, `received_s` our clock at that moment; the difference to now is added.
    """

    __slots__ = ("_age_s", "_body", "_line", "_payload", "_stamp_s", "received_s", "seq", "topic")

    def __init__(self, topic: str, seq: int, age_s: float, received_s: float, payload: bytes | Message) -> None:
        self.topic = topic
        self.seq = seq
        self._age_s = age_s
        self.received_s = received_s
        self._payload = payload
        self._body: str | None = None
        self._stamp_s = 0.0
        self._line = b""

    def body(self) -> str:
        """The children of the `<value>` element."""
        if self._body is None:
            value = unpack_value(self.topic, self._payload) if isinstance(self._payload, bytes) else self._payload
            self._stamp_s = value.stamp_s
            self._body = body_of(value)
            self._payload = b""
        return self._body

    def line(self, now_s: float, *, shown: str = "", id: str = "", dropped: int = 0) -> bytes:
        """The `<value>` line; the plain one is the same bytes for every client. `shown` is the topic's name as the client knows it."""
        plain = not id and not dropped and shown in ("", self.topic)
        if plain and self._line:
            return self._line
        body = self.body()
        age_s = self._age_s + now_s - self.received_s
        line = value_line(shown or self.topic, self.seq, self._stamp_s, age_s, body, id=id, dropped=dropped)
        if plain:
            self._line = line
        return line
