"""What the gateway's process keeps of the robot between its clients, without sockets and clocks."""

from __future__ import annotations

from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.access import Access
from pluto_bt.gateway.hub import Hub
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.session import Session
from pluto_bt.gateway.wire import Batch, Stamped, Up, Welcome, pack_value

TOPIC = "operator/word"


def test_a_value_on_its_way_when_the_last_listener_left_is_not_given_to_the_next_one_as_news() -> None:
    sent: list[Up] = []
    hub = Hub(Welcome("pluto", 0.0, (TOPIC,), Access(), Limits(), 1), sent.append, 0.0)

    def write(seq: int, now_s: float) -> None:
        hub.receive(Batch(now_s, (Stamped(TOPIC, seq, now_s, pack_value(m.Flag(now_s, str(seq)))),), ()), now_s)

    def hears(session: Session, now_s: float) -> list[str]:
        return [line.partition(b" ")[0].decode() for line in session.to_send(now_s, 1 << 16).splitlines()]

    first = hub.open(0.0)
    first.receive(b'<subscribe topic="operator/word"/>', 0.0)
    write(1, 1.0)
    assert hears(first, 1.0) == ["<ok/>", "<value"]
    hub.close(first)
    write(2, 1.01)  # the executive has not heard yet that nobody listens
    second = hub.open(40.0)
    second.receive(b'<subscribe topic="operator/word"/>', 40.0)
    assert hears(second, 40.0) == ["<ok/>"], "what is 39 s old is no news"
    write(3, 40.1)
    assert hears(second, 40.1) == ["<value"]
