"""A real gateway process for a robot in the test's own process."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence

import pytest

from pluto_bt.gateway.access import Access
from pluto_bt.gateway.burst import Burst, Writes
from pluto_bt.gateway.client import Backoff, Client
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.link import Console, GatewayLink
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.replies import Item
from pluto_bt.gateway.uring import Uring
from pluto_bt.runtime.clock import NS, MonotonicClock, wait, wall_ns

from .robot import FakeRobot

PATIENCE_S = 60.0


def whole(token: str) -> Access:
    """An access with one token that may do everything; "" = nobody is asked."""
    return Access().with_token("", token) if token else Access()


class Running:
    """A link that a thread steps, as the scheduler would."""

    def __init__(self, console: Console | None = None, access: Access | None = None, items: Sequence[Item] = ()) -> None:
        self.robot = FakeRobot()
        self.robot.items = list(items)
        self.link = GatewayLink(self.robot, Address("127.0.0.1", 0), access, Limits(linger_s=0.3), console=console)
        self.clock = MonotonicClock()
        self.link.start(0.0)
        self.on_step = lambda: None
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._pump, daemon=True)

    @property
    def address(self) -> Address:
        address = self.link.address
        assert address is not None
        return address

    @property
    def url(self) -> str:
        """Where the web console is."""
        assert self.link.console_address is not None
        return f"http{'s' if self.link._access.certificate else ''}://{self.link.console_address}"

    def wait_until_nobody_is_there(self) -> None:
        """Until the executive knows that every client is gone, and what that entails is done."""
        exchange, pause = self.link._exchange, threading.Event()
        until_ns = wall_ns() + round(PATIENCE_S * NS)
        while exchange._watched or exchange._desk._helm.held is not None:
            assert wall_ns() < until_ns, f"watched: {exchange._watched}, lease: {exchange._desk._helm.held}"
            wait(pause, 0.001)

    def pump(self) -> None:
        """Begin to step."""
        self._thread.start()

    def client(self, backoff: Backoff | None = None, **given: str) -> Client:
        """A client who takes a lost line for the end, unless told when to try again."""
        return Client(*self.address, timeout_s=PATIENCE_S, backoff=backoff, **given)

    def renew(self) -> FakeRobot:
        """The robot as new, for the next test of a file that shares this gateway; its runs stay known, for one may still be watched, and its
        events, for their numbers must go on.
        """
        fresh = FakeRobot()
        fresh.time_s, fresh.runs, fresh.events = self.robot.time_s, self.robot.runs, self.robot.events
        self.on_step = lambda: None
        self.robot.__dict__ = fresh.__dict__  # at once: the other thread must never see half of it
        return self.robot

    def end(self) -> None:
        self._over.set()
        if self._thread.is_alive():
            self._thread.join(10.0)
        self.link.stop()

    def _pump(self) -> None:
        while not self._over.wait(0.005):
            self.robot.time_s = self.clock.now_s()
            self.on_step()
            self.link.step(self.robot.time_s)


@pytest.fixture
def unpumped() -> Iterator[Running]:
    running = Running()
    yield running
    running.end()


@pytest.fixture
def running(unpumped: Running) -> Running:
    unpumped.pump()
    return unpumped


def uring() -> Uring:
    """The kernel's ring, or the end of the test."""
    try:
        return Uring()
    except OSError as error:
        pytest.skip(f"this kernel, or what this process may do in it, has no io_uring: {error}")


@pytest.fixture(params=[Writes, uring], ids=["writes", "uring"])
def burst(request: pytest.FixtureRequest) -> Iterator[Burst]:
    make: Callable[[], Burst] = request.param
    made = make()
    yield made
    if isinstance(made, Uring):
        made.close()


@pytest.fixture(scope="module")
def lasting() -> Iterator[Running]:
    """One gateway for all tests of a file; `renew` wipes off what one of them leaves on the robot."""
    running = Running()
    running.pump()
    yield running
    running.end()
