"""How values are handed out: at the rate that was asked for, young, spread in time, to nobody who has gone."""

from __future__ import annotations

import pytest

from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.channels import GRACE_S, Channels
from pluto_bt.gateway.newest import Newest
from pluto_bt.gateway.requests import Subscribe
from pluto_bt.gateway.subscriptions import Flow, Sink

TOPIC = "operator/word"


class Street:
    """Channels with one topic, and what came through."""

    def __init__(self) -> None:
        self.channels = Channels([TOPIC])
        self.seq = 0
        self.sent: list[tuple[float, int, int]] = []  # when, to whom, which

    def add(self, client: int, rate_hz: float, sink: Sink | None = None) -> Flow:
        flow = Flow(client, TOPIC, Subscribe(topic=TOPIC, max_rate_hz=rate_hz), sink)
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
    for client in range(100):
        street.add(client, 10.0)
    for i in range(50):
        street.write(0.02 * i)
    at_once = [sum(1 for sent_s, _, _ in street.sent if sent_s == 0.02 * i) for i in range(20, 50)]
    assert max(at_once) <= 40 and {client for _, client, _ in street.sent} == set(range(100))


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


def test_a_line_that_can_be_sent_at_once_passes_all_queues() -> None:
    street, lines = Street(), []
    is_free = [True]
    flow = street.add(0, 0.0, lambda line: is_free[0] and (lines.append(line) is None))
    for i in range(4):
        is_free[0] = i != 2
        street.write(0.1 * i)
    assert [sent[2] for sent in street.sent] == [1, 3], "the first by the usual way, and the one that could not be sent at once"
    assert len(lines) == 2 and flow.seq == 4


def test_who_has_gone_leaves_nothing_behind() -> None:
    street = Street()
    flows = [street.add(client, rate) for client in range(50) for rate in (0.0, 3.0)]
    for flow in flows:
        street.channels.leave(TOPIC, flow)
    street.write(1.0)
    assert street.sent == [] and not street.channels._lanes[TOPIC]
