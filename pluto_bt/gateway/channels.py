"""The values of all topics on their way to all clients: who is served with the next one, and who later.

Clients that named a rate are spread over the lanes of their period, which are due one after the other; a lane that is due is served with the
next value that comes, so values are young when they are sent. If none comes for `GRACE_S`, it gets what there is. Who wants each value is in
a lane that is always due. Lanes are all that moves: serving a client costs little more than the write.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from pluto_bt.gateway.newest import Newest
from pluto_bt.gateway.subscriptions import Flow

GRACE_S = 0.05
EARLY_S = 0.005  # a value that comes so little too early is taken: the next one might come a whole period too late
LANE_S, MOST_LANES = 0.02, 16


class Lane:
    """Flows of one topic and one period that are served together."""

    __slots__ = ("flows", "next_s", "period_s", "seq")

    def __init__(self, period_s: float, next_s: float) -> None:
        self.period_s, self.next_s = period_s, next_s
        self.flows: dict[Flow, None] = {}
        self.seq = 0

    def serve(self, newest: Newest, now_s: float) -> Iterator[Flow]:
        """Send the value to all who can take it at once; yields the others, for whom it waits now."""
        self.seq = seq = newest.seq
        if self.period_s:
            late_s = now_s - self.next_s
            self.next_s = self.next_s + self.period_s if late_s < self.period_s else now_s + self.period_s
        line = newest.line(now_s) if self.flows else b""
        has_rate = self.period_s > 0.0
        for flow in self.flows:
            seen, sink = flow.seq, flow.sink
            if sink is not None and seen and seen != seq and (has_rate or seen == seq - 1) and sink(line):
                flow.seq = seq
            elif flow.take(newest):
                yield flow


class Channels:
    """All topics, the newest value of each, and its lanes."""

    def __init__(self, topics: Iterable[str]) -> None:
        self._lanes: dict[str, dict[tuple[float, int], Lane]] = {topic: {} for topic in topics}
        self._newest: dict[str, Newest] = {}

    def newest(self, topic: str) -> Newest | None:
        """The newest value that came for a topic, as long as it is watched."""
        return self._newest.get(topic)

    def forget(self, topics: Iterable[str]) -> None:
        """Nobody watches these any more: what is known of them grows old, and their lanes are empty."""
        for topic in topics:
            self._newest.pop(topic, None)
            self._lanes[topic].clear()

    def join(self, topic: str, flow: Flow, now_s: float) -> bool:
        """A new flow; True if it has been given the value that is there."""
        lanes = _lanes_of(flow)
        key = (flow.period_s, flow.client % lanes)
        lane = self._lanes[topic].get(key)
        if lane is None:
            lane = self._lanes[topic][key] = Lane(flow.period_s, now_s + flow.period_s * key[1] / lanes if flow.period_s else -math.inf)
        lane.flows[flow] = None
        newest = self._newest.get(topic)
        return newest is not None and flow.take(newest)

    def leave(self, topic: str, flow: Flow) -> None:
        """Nobody wants this flow any more; an empty lane goes with it."""
        lanes, key = self._lanes[topic], (flow.period_s, flow.client % _lanes_of(flow))
        if key in lanes:
            lanes[key].flows.pop(flow, None)
            if not lanes[key].flows:
                del lanes[key]

    def offer(self, newest: Newest, now_s: float) -> Iterator[Flow]:
        """A new value: serve the lanes that are due; yields the flows for whom it waits."""
        self._newest[newest.topic] = newest
        for lane in self._lanes[newest.topic].values():
            if now_s >= lane.next_s - min(EARLY_S, 0.25 * lane.period_s):
                yield from lane.serve(newest, now_s)

    def late(self, now_s: float) -> Iterator[Flow]:
        """Serve the lanes that are due and for which no younger value has come in time. Call it now and then."""
        for topic, newest in self._newest.items():
            if now_s - newest.received_s >= GRACE_S:
                for lane in self._lanes[topic].values():
                    if lane.seq != newest.seq and now_s >= lane.next_s:
                        yield from lane.serve(newest, now_s)


def _lanes_of(flow: Flow) -> int:
    """How many lanes the flows of its period are spread over."""
    return min(MOST_LANES, max(1, round(flow.period_s / LANE_S)))
