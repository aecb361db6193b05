"""What one client wants to see, how often, and what he has lost."""

from __future__ import annotations

from collections.abc import Iterable

from pluto_bt.gateway.newest import Newest
from pluto_bt.gateway.requests import Subscribe

ALIASES = {"mission": "mission/state"}
"""Short names that the protocol promises."""


class Flow:
    """One topic on its way to one client."""

    __slots__ = ("dropped", "last_body", "next_s", "seq", "waiting", "wish")

    def __init__(self, wish: Subscribe) -> None:
        self.wish = wish
        self.waiting: Newest | None = None
        self.next_s = 0.0
        self.seq = 0  # of the last value seen
        self.dropped = 0
        self.last_body = ""

    def offer(self, newest: Newest, now_s: float) -> None:
        """A new value; one that was due and still waits is lost."""
        if newest.seq == self.seq:
            return
        if self.wish.max_rate_hz == 0.0:
            self.dropped += newest.seq - self.seq - 1 if self.seq else 0
        elif self.waiting is not None and now_s >= self.next_s:
            self.dropped += 1
        if self.waiting is not None and self.wish.max_rate_hz == 0.0:
            self.dropped += 1
        self.waiting = newest
        self.seq = newest.seq

    def take(self, now_s: float) -> bytes:
        """The line to send now, or b"" if there is none or it is not due."""
        newest, wish = self.waiting, self.wish
        if newest is None or now_s < self.next_s:
            return b""
        self.waiting = None
        if wish.on_change:
            if newest.body() == self.last_body:
                return b""
            self.last_body = newest.body()
        if wish.max_rate_hz > 0.0:
            period_s = 1.0 / wish.max_rate_hz
            self.next_s = self.next_s + period_s if now_s - self.next_s < period_s else now_s + period_s
        line = newest.line(now_s, shown=wish.topic if wish.topic in ALIASES else "", id=wish.id, dropped=self.dropped)
        self.dropped = 0
        return line


class Subscriptions:
    """The wishes of one client; of several that name a topic the most exact one counts."""

    def __init__(self) -> None:
        self._wishes: dict[str, Subscribe] = {}
        self._flows: dict[str, Flow | None] = {}  # by topic; None = nobody asked for it

    def add(self, wish: Subscribe) -> None:
        """From now on; the same topic or pattern again replaces the old wish."""
        self._wishes[wish.topic] = wish
        self._flows.clear()

    def remove(self, topic: str) -> bool:
        """No more; False if it was never asked for."""
        self._flows.clear()
        return self._wishes.pop(topic, None) is not None

    def flow(self, topic: str) -> Flow | None:
        """How `topic` goes to this client, None if it does not."""
        if topic not in self._flows:
            wish = self._wish(topic)
            self._flows[topic] = Flow(wish) if wish else None
        return self._flows[topic]

    def offer(self, values: Iterable[Newest], now_s: float) -> None:
        """New values of any topics."""
        for newest in values:
            flow = self.flow(newest.topic)
            if flow is not None:
                flow.offer(newest, now_s)

    def take(self, now_s: float, room_bytes: int) -> bytes:
        """Lines that are due, as long as there is room; the others wait, and may be replaced by newer ones."""
        lines: list[bytes] = []
        for flow in self._flows.values():
            if room_bytes <= 0:
                break
            if flow is not None and flow.waiting is not None:
                line = flow.take(now_s)
                lines.append(line)
                room_bytes -= len(line)
        return b"".join(lines)

    def next_due_s(self) -> float:
        """When the next waiting value is due; infinity if none waits."""
        return min((flow.next_s for flow in self._flows.values() if flow is not None and flow.waiting is not None), default=float("inf"))

    def _wish(self, topic: str) -> Subscribe | None:
        fitting = [wish for pattern, wish in self._wishes.items() if matches(pattern, topic)]
        return max(fitting, key=lambda wish: (not wish.topic.endswith("*"), len(wish.topic)), default=None)


def matches(pattern: str, topic: str) -> bool:
    """True if `pattern` (a name, an alias, or a beginning with `*` behind it) means `topic`."""
    return topic.startswith(pattern[:-1]) if pattern.endswith("*") else ALIASES.get(pattern, pattern) == topic
