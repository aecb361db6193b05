"""What one client wants to see, how often, and what he has lost."""

from __future__ import annotations

from collections.abc import Iterable

from pluto_bt.gateway.newest import Newest
from pluto_bt.gateway.outlets import Outlet
from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.requests import Subscribe

WISHES = 64
"""So many topics and patterns may one client subscribe to."""
ALIASES = {"mission": "mission/state"}
"""Short names that the protocol promises."""


class Flow:
    """One topic on its way to one client.

    Attributes:
        outlet: where lines can be sent past all queues; None where that cannot be, or the line is not the same for all clients.
        seq: of the last value taken; a flow that is served along with its lane has the lane's.
        waiting: a value that is not sent yet, because something stands before it.
    """

    __slots__ = ("client", "dropped", "last_body", "outlet", "period_s", "seq", "shown", "waiting", "wish")

    def __init__(self, client: int, topic: str, wish: Subscribe, outlet: Outlet | None) -> None:
        self.client = client
        self.wish = wish
        self.shown = wish.topic if wish.topic in ALIASES else ""
        self.outlet = None if self.shown or wish.id or wish.on_change else outlet
        self.period_s = 1.0 / wish.max_rate_hz if wish.max_rate_hz > 0.0 else 0.0
        self.seq = 0
        self.waiting: Newest | None = None
        self.dropped = 0
        self.last_body = ""

    def take(self, newest: Newest) -> bool:
        """Take a value to be sent; what still waited is lost. False if it says nothing new."""
        if newest.seq == self.seq:
            return False
        if self.waiting is not None:
            self.dropped += 1
        if not self.period_s and self.seq:
            self.dropped += newest.seq - self.seq - 1
        self.seq, self.waiting = newest.seq, newest
        return True

    def line(self, now_s: float) -> bytes:
        """What waits, as the line to send; b"" if the client wants changes only, and nothing has changed."""
        newest, wish, self.waiting = self.waiting, self.wish, None
        if newest is None:
            return b""
        if wish.on_change:
            if newest.body() == self.last_body:
                return b""
            self.last_body = newest.body()
        dropped, self.dropped = self.dropped, 0
        return newest.line(now_s, shown=self.shown, id=wish.id, dropped=dropped)


class Subscriptions:
    """The wishes of one client; of several that name a topic the most exact one counts."""

    def __init__(self, client: int) -> None:
        self._client = client
        self.outlet: Outlet | None = None  # the server's; set before the first wish
        self._wishes: dict[str, Subscribe] = {}
        self.flows: dict[str, Flow] = {}  # by topic
        self.due: dict[Flow, None] = {}  # flows with a value that waits to be sent, in that order

    def add(self, wish: Subscribe, topics: Iterable[str]) -> None:
        """From now on; the same topic or pattern again replaces the old wish. Raises: RefusedError `busy` if there are too many."""
        if wish.topic not in self._wishes and len(self._wishes) >= WISHES:
            raise RefusedError("busy", f"{WISHES} topics and patterns are subscribed to; unsubscribe one, or name several at once: topic/*")
        self._wishes[wish.topic] = wish
        for topic in topics:
            if matches(wish.topic, topic):
                known = self.flows.get(topic)
                if known is None or _rank(wish) >= _rank(known.wish):  # nothing else can have changed
                    self._join(topic, wish)

    def remove(self, pattern: str) -> bool:
        """No more; False if it was never asked for."""
        gone = self._wishes.pop(pattern, None)
        if gone is None:
            return False
        for topic in [topic for topic, flow in self.flows.items() if flow.wish is gone]:
            fitting = [wish for wish in self._wishes.values() if matches(wish.topic, topic)]
            self._join(topic, max(fitting, key=_rank, default=None))
        return True

    def end(self) -> None:
        """The client is gone."""
        self._wishes.clear()
        self.flows.clear()
        self.due.clear()

    def put(self, flow: Flow) -> None:
        """A value waits for the next `take`."""
        self.due[flow] = None
        if self.outlet is not None:
            self.outlet.hold()

    def take(self, now_s: float, room_bytes: int) -> bytes:
        """Lines that are due, as long as there is room; the others wait, and may be replaced by newer ones."""
        due = self.due
        if len(due) == 1 and room_bytes > 0:
            return due.popitem()[0].line(now_s)
        lines: list[bytes] = []
        while due and room_bytes > 0:
            flow = next(iter(due))
            del due[flow]
            lines.append(flow.line(now_s))
            room_bytes -= len(lines[-1])
        return b"".join(lines)

    def _join(self, topic: str, wish: Subscribe | None) -> None:
        """A new flow of this topic in the place of the old one; None = nobody wants one."""
        old = self.flows.pop(topic, None)
        if old is not None:
            self.due.pop(old, None)
        if wish is not None:
            self.flows[topic] = Flow(self._client, topic, wish, self.outlet)


def _rank(wish: Subscribe) -> tuple[bool, int]:
    """The more exact, the greater."""
    return not wish.topic.endswith("*"), len(wish.topic)


def matches(pattern: str, topic: str) -> bool:
    """True if `pattern` (a name, an alias, or a beginning with `*` behind it) means `topic`."""
    return topic.startswith(pattern[:-1]) if pattern.endswith("*") else ALIASES.get(pattern, pattern) == topic
