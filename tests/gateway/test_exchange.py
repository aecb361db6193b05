"""The executive's end of the wire when much waits for it, and when the gateway is killed meanwhile."""

from __future__ import annotations

from collections.abc import Callable

from pluto_bt.gateway.access import Access
from pluto_bt.gateway.exchange import Exchange
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.replies import AnyReply, Error
from pluto_bt.gateway.requests import Get, Lease, MissionOp
from pluto_bt.gateway.wire import Answer, Ask, Down, Gone

from .robot import FakeRobot

BIG = 1024 * 1024


class Office:
    """An exchange whose long work is done when the test says so."""

    def __init__(self) -> None:
        self.robot, self.sent, self.work = FakeRobot(), list[Down](), list[Callable[[], None]]()
        self.read: list[str] = []
        self.robot.on_prepare = self.read.append
        self.exchange = Exchange(self.robot, self.sent.append, aside=self.work.append)
        self.connect()

    def connect(self) -> None:
        self.exchange.welcome(Access(), Limits(), 1)

    def asks(self, client: int, op: str, text: str = "x", size_bytes: int = 100) -> None:
        request = MissionOp(op=op, text=text)  # type: ignore[arg-type]
        self.exchange.receive(Ask(client, "s" if client > 1000 else "", "", request, size_bytes=size_bytes))

    def works(self) -> None:
        """All that is given to do aside, and what it leads to."""
        self.exchange.step(self.robot.time_s)
        while self.work:
            self.work.pop(0)()
            self.exchange.step(self.robot.time_s)

    def answers(self, client: int) -> list[AnyReply]:
        return [frame.reply for frame in self.sent if isinstance(frame, Answer) and frame.client == client]


def is_busy(replies: list[AnyReply]) -> bool:
    return [reply.code for reply in replies if isinstance(reply, Error)] == ["busy"]


def test_what_many_clients_leave_behind_is_bounded_and_forgotten_with_them() -> None:
    office = Office()
    for client in range(1, 101):
        office.asks(client, "check", size_bytes=BIG)
        office.exchange.step(0.0)
        office.exchange.receive(Gone(client))
    assert sum(is_busy(office.answers(client)) for client in range(1, 101)) == 96
    office.exchange.step(0.0)
    office.works()
    assert office.read == [], "nobody wants to know any more"
    office.asks(200, "check", size_bytes=BIG)
    office.works()
    assert office.read == ["x"] and [type(reply).__name__ for reply in office.answers(200)] == ["Ok"]


def test_a_load_is_done_though_its_client_has_hung_up() -> None:
    office = Office()
    office.asks(1, "load")
    office.exchange.receive(Gone(1))
    office.works()
    assert office.read == ["x"] and office.robot.did == [("mission", "load", "", "x")]


def test_a_session_that_comes_back_over_a_new_gateway_is_answered_once() -> None:
    office = Office()
    office.asks(1001, "load", "old")
    office.exchange.step(0.0)
    office.exchange.gateway_lost()
    office.connect()
    office.asks(2001, "load", "new")
    office.exchange.receive(Ask(2001, "s", "", Lease(op="query")))
    office.exchange.receive(Ask(2001, "s", "", Get(topic="tree")))
    office.exchange.step(0.0)
    office.work.pop(0)()
    office.exchange.step(0.0)
    assert (office.read, office.robot.did, office.answers(2001)) == ([], [], []), "the old work frees nobody, and acts for nobody"
    office.works()
    assert office.robot.did == [("mission", "load", "", "new")] and not office.answers(1001)
    assert [type(reply).__name__ for reply in office.answers(2001)] == ["Ok", "LeaseState", "Error"]
