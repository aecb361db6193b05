"""How values are handed out: at the rate that was asked for, young, spread in time, to nobody who has gone."""

from __future__ import annotations

import errno
import itertools
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.burst import Ints
from pluto_bt.gateway.channels import GRACE_S, Channels
from pluto_bt.gateway.lanes import FLOWS
from pluto_bt.gateway.newest import Newest
from pluto_bt.gateway.outlets import Outlet, Outlets
from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.requests import Subscribe
from pluto_bt.gateway.subscriptions import WISHES, Flow, Subscriptions, matches

TOPIC = "operator/word"


class Sockets:
    """A `Burst` whose sockets take everything, or nothing if they are `full`."""

    def __init__(self) -> None:
        self.lines: dict[int, list[bytes]] = {}
        self.full: set[int] = set()

    def send(self, fds: Ints, line: bytes) -> Ints:
        for fd in fds.tolist():
            if fd not in self.full:
                self.lines.setdefault(fd, []).append(line)
        return np.array([-errno.EAGAIN if fd in self.full else len(line) for fd in fds.tolist()], np.int32)


class Street:
    """Channels with one topic, and what came through by the queues."""

    def __init__(self) -> None:
        self.sockets = Sockets()
        self.outlets = Outlets(self.sockets)
        self.channels = Channels([TOPIC], self.outlets)
        self.seq = 0
        self.sent: list[tuple[float, int, int]] = []  # when, to whom, which

    def add(self, client: int, rate_hz: float, outlet: Outlet | None = None) -> Flow:
        flow = Flow(client, TOPIC, Subscribe(topic=TOPIC, max_rate_hz=rate_hz), outlet)
        self.channels.join(TOPIC, flow, 0.0)
        return flow

    def write(self, now_s: float) -> None:
        self.seq += 1
        self._note(self.channels.offer(Newest(TOPIC, self.seq, 0.0, now_s, m.Flag(now_s, str(self.seq))), now_s), now_s)

    def wait(self, now_s: float) -> None:
        self._note(self.channels.late(now_s), now_s)

    def _note(self, flows: object, now_s: float) -> None:
        for flow in list(flows):  # type: ignore[call-overload]
            assert flow.line(now_s)
            self.sent.append((now_s, flow.client, flow.seq))


@pytest.mark.parametrize(("rate_hz", "expected"), [(0.0, 100), (50.0, 100), (10.0, 20), (1.0, 2)])
def test_a_client_gets_as_many_as_he_asked_for(rate_hz: float, expected: int) -> None:
    street = Street()
    street.add(7, rate_hz)
    for i in range(100):  # two seconds at 50 Hz
        street.write(0.02 * i)
    assert abs(len(street.sent) - expected) <= 1


def test_clients_with_one_rate_are_served_at_different_times() -> None:
    street = Street()
    n_clients = 3 * FLOWS
    for client in range(n_clients):
        street.add(client, 10.0)
    for i in range(50):
        street.write(0.02 * i)
    at_once = [sum(1 for sent_s, _, _ in street.sent if sent_s == 0.02 * i) for i in range(20, 50)]
    assert max(at_once) <= FLOWS and {client for _, client, _ in street.sent} == set(range(n_clients))


def test_more_clients_than_lanes_have_room_for_are_served_all_the_same() -> None:
    street = Street()
    flows = [street.add(client, 50.0) for client in range(2 * FLOWS)]  # so short a period has one lane
    street.write(0.0)
    assert len(street.sent) == len(flows)


def test_a_value_that_came_too_early_is_sent_when_no_other_comes() -> None:
    street = Street()
    street.add(0, 10.0)
    street.write(0.0)
    street.write(0.02)
    street.wait(0.09)
    assert [seq for _, _, seq in street.sent] == [1]
    street.wait(0.11 + GRACE_S)
    street.wait(9.0)
    assert [seq for _, _, seq in street.sent] == [1, 2]


class Client:
    """One who reads or does not, with his one subscription; `heard` = the numbers of the values he got, and what they said he lost."""

    def __init__(self, street: Street, number: int, rate_hz: float, *, has_outlet: bool) -> None:
        self.reads = True
        self.subscriptions = Subscriptions(number)
        self.subscriptions.outlet = street.outlets.add(number, self) if has_outlet else None
        self.heard: list[tuple[int, int]] = []
        self._street, self._fd = street, number
        self.flow = street.add(number, rate_hz, self.subscriptions.outlet)

    def is_clear(self) -> bool:
        return self.reads and not self.subscriptions.due

    def send_rest(self, rest: bytes) -> None:
        raise AssertionError("these sockets take all or nothing")

    def reads_or_not(self, reads: bool) -> None:
        """From now on."""
        self.reads = reads
        self._street.sockets.full = self._street.sockets.full - {self._fd} if reads else self._street.sockets.full | {self._fd}

    def flush(self, now_s: float) -> None:
        """Hear what came past the queue, then what waited there."""
        for line in [*self._street.sockets.lines.pop(self._fd, []), *([self.subscriptions.take(now_s, 1)] if self.reads else [])]:
            if line:
                lost = re.search(rb'dropped="(\d+)"', line)
                self.heard.append((int(re.search(rb'seq="(\d+)"', line)[1]), int(lost[1]) if lost else 0))  # type: ignore[index]


@settings(deadline=None)
@given(
    st.sampled_from([0.0, 5.0, 10.0, 40.0]),
    st.lists(st.tuples(st.integers(1, 3), st.booleans(), st.booleans()), min_size=5, max_size=60),
)
def test_who_is_served_past_the_queues_hears_what_the_queues_would_have_given_him(rate_hz: float, steps: list[tuple[int, bool, bool]]) -> None:
    street = Street()
    fast, slow = Client(street, 1, rate_hz, has_outlet=True), Client(street, 2, rate_hz, has_outlet=False)
    for i, (n_values, reads, is_late) in enumerate(steps):
        fast.reads_or_not(reads)
        slow.reads_or_not(reads)
        now_s = 0.02 * i
        street.seq += n_values - 1  # the executive tells the newest alone
        street.seq += not is_late
        newest = Newest(TOPIC, street.seq, 0.0, now_s, m.Flag(now_s, "x"))
        for flow in street.channels.late(now_s + GRACE_S) if is_late else street.channels.offer(newest, now_s):
            {1: fast, 2: slow}[flow.client].subscriptions.put(flow)
        fast.flush(now_s)
        slow.flush(now_s)
    assert fast.heard == slow.heard
    seqs = [seq for seq, _ in fast.heard]
    assert seqs == sorted(set(seqs))
    if rate_hz == 0.0:
        lost = [after - before - 1 for before, after in itertools.pairwise(seqs)]
        assert lost == [dropped for _, dropped in fast.heard[1:]], "he is told of each value that he did not get"


def test_nobody_is_asked_as_long_as_nothing_waits() -> None:
    street = Street()
    clients = [Client(street, number, 0.0, has_outlet=True) for number in range(1, 6)]
    asked: list[Client] = []
    for client in clients:
        client.is_clear = lambda client=client: asked.append(client) is None  # type: ignore[method-assign, misc]
    for i in range(10):
        street.write(0.1 * i)
    assert asked == clients, "each once, when he had his first value"
    assert all(len(lines) == 9 for lines in street.sockets.lines.values()) and len(street.sockets.lines) == len(clients)
    clients[2].subscriptions.put(clients[2].flow)
    street.write(1.0)
    assert asked == [*clients, clients[2]]


def test_who_has_gone_leaves_nothing_behind() -> None:
    street = Street()
    flows = [street.add(client, rate) for client in range(50) for rate in (0.0, 3.0)]
    for flow in flows:
        street.channels.leave(TOPIC, flow)
    street.write(1.0)
    assert street.sent == [] and not street.channels._lanes[TOPIC]


PLACES = ("a/x", "a/xy", "b/x", "mission/state")
WISHED = st.sampled_from((*PLACES, "mission", "*", "a/*", "a/x*", "b/*", "m*"))


@given(st.lists(st.tuples(st.booleans(), WISHED), max_size=12))
def test_of_all_wishes_the_most_exact_one_counts(steps: list[tuple[bool, str]]) -> None:
    """Each topic's flow is that of the most exact wish that stands, whatever came and went before; a wish that stands keeps its flow."""
    subscriptions = Subscriptions(1)
    wishes: dict[str, Subscribe] = {}
    for is_new, pattern in steps:
        before = dict(subscriptions.flows)
        if is_new:
            wishes[pattern] = Subscribe(topic=pattern)
            subscriptions.add(wishes[pattern], PLACES)
        else:
            assert subscriptions.remove(pattern) == (wishes.pop(pattern, None) is not None)
        for topic in PLACES:
            fitting = [wish for wish in wishes.values() if matches(wish.topic, topic)]
            best = max(fitting, key=lambda wish: (not wish.topic.endswith("*"), len(wish.topic)), default=None)
            flow = subscriptions.flows.get(topic)
            assert (flow.wish if flow else None) is best
            if topic in before and before[topic].wish is best:
                assert flow is before[topic]


def test_a_client_may_have_so_many_wishes_and_no_more() -> None:
    subscriptions = Subscriptions(1)
    for number in range(WISHES):
        subscriptions.add(Subscribe(topic=f"topic {number}"), ())
    with pytest.raises(RefusedError, match="unsubscribe one"):
        subscriptions.add(Subscribe(topic="one more"), ())
    subscriptions.add(Subscribe(topic="topic 0", max_rate_hz=5.0), ())
    assert subscriptions.remove("topic 1")
    subscriptions.add(Subscribe(topic="one more"), ())
