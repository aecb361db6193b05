"""The values of all topics on their way to all clients: who is served with the next one, and who later.

Clients that named a rate fill the lanes of their period one after the other. The lanes are due at different times, and a lane that is due is
served with the next value that comes, so values are young when they are sent. If none comes for `GRACE_S`, it gets what there is. Who wants
each value is in a lane that is always due. Few lanes and full ones: waking up for a burst costs both sides as much as ten sends.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from pluto_bt.gateway.lanes import FLOWS, Lane
from pluto_bt.gateway.newest import Newest
from pluto_bt.gateway.outlets import Outlets
from pluto_bt.gateway.subscriptions import Flow

GRACE_S = 0.05
EARLY_S = 0.005  # a value that comes so little too early is taken: the next one might come a whole period too late
LANE_S, MOST_LANES = 0.02, 16


class Channels:
    """All topics, the newest value of each, and its lanes; `outlets` are those of the flows."""

    def __init__(self, topics: Iterable[str], outlets: Outlets) -> None:
        self._outlets = outlets
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
        self._lane_for(flow, self._lanes[topic], now_s).join(flow)
        newest = self._newest.get(topic)
        return newest is not None and flow.take(newest)

    def _lane_for(self, flow: Flow, lanes: dict[tuple[float, int], Lane], now_s: float) -> Lane:
        """The first lane of its period that has room, else a new one, else the one with the fewest."""
        period_s = flow.period_s
        n_lanes = _most(period_s)
        for k in range(n_lanes):
            lane = lanes.get((period_s, k))
            if lane is None:
                lane = lanes[period_s, k] = Lane(self._outlets, period_s, now_s + period_s * _spread(k) if period_s else -math.inf)
            if len(lane) < FLOWS:
                return lane
        return min((lanes[period_s, k] for k in range(n_lanes)), key=len)

    def leave(self, topic: str, flow: Flow) -> None:
        """Nobody wants this flow any more; an empty lane goes with it."""
        lanes = self._lanes[topic]
        for key in [key for key in lanes if key[0] == flow.period_s]:
            lanes[key].leave(flow)
            if not lanes[key]:
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


def _most(period_s: float) -> int:
    """How many lanes a period may have."""
    return min(MOST_LANES, max(1, round(period_s / LANE_S)))


def _spread(k: int) -> float:
    """0, 1/2, 1/4, 3/4, 1/8, …: where in a period lane `k` is due, far from all before it, whatever comes later (van der Corput)."""
    share, part = 0.0, 0.5
    while k:
        share, part, k = share + part * (k & 1), 0.5 * part, k >> 1
    return share
