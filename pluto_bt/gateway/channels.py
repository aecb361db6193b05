"""The values of all topics on their way to all clients: who wants the next one now, and who only later.

A client that wants each value is served with each; one that named a rate rests for a period, then is ready. A value goes to all who are
ready at once, so it is young when it is sent. Who becomes ready while a value lies there that he has not seen waits `GRACE_S` for a
younger one, then gets what there is.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Iterable, Iterator

from pluto_bt.gateway.newest import Newest
from pluto_bt.gateway.subscriptions import Flow

GRACE_S = 0.05


class Channel:
    """One topic: its newest value, and the flows that are served when the next one comes."""

    __slots__ = ("each", "newest", "ready")

    def __init__(self) -> None:
        self.newest: Newest | None = None
        self.each: dict[Flow, None] = {}
        self.ready: dict[Flow, None] = {}


class Channels:
    """All topics. What it yields are flows that have taken a value just now."""

    def __init__(self, topics: Iterable[str]) -> None:
        self._channels = {topic: Channel() for topic in topics}
        self._resting: list[tuple[float, int, Flow, Channel]] = []  # heap by the end of the rest
        self._order = itertools.count()

    def newest(self, topic: str) -> Newest | None:
        """The newest value that came for a topic."""
        return self._channels[topic].newest

    def forget(self, topics: Iterable[str]) -> None:
        """Nobody watches these any more: what is known of them grows old."""
        for topic in topics:
            self._channels[topic].newest = None

    def join(self, topic: str, flow: Flow, now_s: float) -> bool:
        """A new flow; True if it has been given the value that is there."""
        channel = self._channels[topic]
        if flow.period_s == 0.0:
            channel.each[flow] = None
            return channel.newest is not None and flow.take(channel.newest, now_s)
        channel.ready[flow] = None
        return channel.newest is not None and self._serve(flow, channel, channel.newest, now_s)

    def offer(self, newest: Newest, now_s: float) -> Iterator[Flow]:
        """A new value."""
        channel = self._channels[newest.topic]
        channel.newest = newest
        for flow in list(channel.each):
            if flow.is_over:
                del channel.each[flow]
            elif flow.take(newest, now_s):
                yield flow
        for flow in list(channel.ready):
            if flow.is_over:
                del channel.ready[flow]
            elif self._serve(flow, channel, newest, now_s):
                yield flow

    def wake(self, now_s: float) -> None:
        """Whose rest is over is ready."""
        while self._resting and self._resting[0][0] <= now_s:
            _, _, flow, channel = heapq.heappop(self._resting)
            if not flow.is_over:
                channel.ready[flow] = None

    def late(self, now_s: float) -> Iterator[Flow]:
        """Who is ready, has not seen the newest value, and for whom no younger one has come in time. Call it now and then."""
        self.wake(now_s)
        for channel in self._channels.values():
            newest = channel.newest
            if newest is None or not channel.ready or now_s - newest.received_s < GRACE_S:
                continue
            for flow in list(channel.ready):
                if flow.is_over:
                    del channel.ready[flow]
                elif self._serve(flow, channel, newest, now_s):
                    yield flow

    def _serve(self, flow: Flow, channel: Channel, newest: Newest, now_s: float) -> bool:
        """Give a ready flow the value, and let it rest."""
        if not flow.take(newest, now_s):
            return False
        del channel.ready[flow]
        heapq.heappush(self._resting, (flow.next_s, next(self._order), flow, channel))
        return True
