"""Places for long messages: few at one time, in the order of coming, none for ever."""

from __future__ import annotations

from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.local import LocalGateway
from pluto_bt.gateway.places import LONG_BYTES, Places
from pluto_bt.gateway.session import Session

from .robot import FakeRobot

LIMITS = Limits(documents=2, document_s=3.0)
HEAD, TAIL = b'<mission op="check"><root>', b"</root></mission>"
LONG = HEAD + b"<a/>" * (LONG_BYTES // 4)


class Clients:
    """Some connections of one gateway, and whom it has told to go on."""

    def __init__(self, count: int) -> None:
        self.robot, self.woken = FakeRobot(), list[int]()
        self.gateway = LocalGateway(self.robot, LIMITS)
        self.sessions = [self.gateway.hub.open(0.0) for _ in range(count)]
        for number, session in enumerate(self.sessions):
            session.place.on_free = lambda number=number: self.woken.append(number)  # type: ignore[misc]

    def sends(self, number: int, data: bytes, now_s: float = 0.0) -> Session:
        self.sessions[number].receive(data, now_s)
        return self.sessions[number]

    def held_up(self) -> list[int]:
        return [number for number, session in enumerate(self.sessions) if session.place.is_held_up]


def test_the_third_long_message_waits_until_one_is_answered() -> None:
    clients = Clients(4)
    for number in range(4):
        clients.sends(number, LONG)
    assert clients.held_up() == [2, 3]
    clients.sends(0, TAIL)
    assert clients.woken == [], "whole, but not answered"
    clients.gateway.step(0.1)
    assert (clients.woken, clients.held_up()) == ([2], [3])
    clients.gateway.hub.close(clients.sessions[1])
    assert (clients.woken, clients.held_up()) == ([2, 3], [])


def test_short_messages_need_no_place() -> None:
    clients = Clients(3)
    for number in range(2):
        clients.sends(number, LONG)
    clients.sends(2, HEAD + TAIL + b"<ping/>" * 10)
    assert clients.held_up() == [] and clients.sessions[2].to_send(0.0, 1 << 20).count(b"<pong") == 10


def test_who_sends_slowly_gives_way_but_only_to_others() -> None:
    clients = Clients(5)
    for number in range(2):
        clients.sends(number, LONG)
    clients.gateway.step(LIMITS.document_s + 1.0)
    assert not clients.sessions[0].closing
    for number in range(2, 5):
        clients.sends(number, LONG, LIMITS.document_s + 1.0)
    clients.gateway.step(LIMITS.document_s + 1.0)
    assert [session.closing for session in clients.sessions] == [True, True, False, False, False] and clients.woken == [2, 3]
    assert b'code="timeout"' in clients.sessions[0].to_send(0.0, 0)
    clients.gateway.step(2 * LIMITS.document_s)
    clients.gateway.step(3 * LIMITS.document_s + 1.0)
    assert (clients.woken, clients.held_up()) == ([2, 3, 4], []), "who says no more when he has his place loses it as well"


def test_who_waits_and_is_cut_off_is_read_again_to_his_end() -> None:
    clients = Clients(3)
    for number in range(3):
        clients.sends(number, LONG)
    clients.sessions[2].fail("shutdown", "")
    assert (clients.woken, clients.held_up()) == ([2], [])


def test_nothing_is_left_of_a_long_message_whose_client_has_gone() -> None:
    clients = Clients(1)
    session = clients.sends(0, LONG)
    assert session._connection.unfinished_bytes >= LONG_BYTES
    clients.gateway.hub.close(session)
    assert session._connection.unfinished_bytes == 0


def test_who_waits_longest_is_next_and_who_comes_anew_does_not_overtake_him() -> None:
    places, woken = Places(LIMITS), list[int]()
    taken = [places.take(client, 0.0, lambda client=client: woken.append(client)) for client in range(5)]  # type: ignore[misc]
    assert taken == [True, True, False, False, False]
    places.leave(3)  # he gives up waiting
    places.leave(0)
    assert woken == [2] and not places.take(7, 0.0, lambda: None) and places.take(2, 0.0, lambda: None)
    places.leave(1)
    assert woken == [2, 4]
