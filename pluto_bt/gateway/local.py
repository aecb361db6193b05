"""The whole gateway without a process, a socket or a thread: for tests, and for lockstep runs that want to be asked."""

from __future__ import annotations

from collections import deque

from pluto_bt.gateway.access import Access
from pluto_bt.gateway.audit import Audit
from pluto_bt.gateway.exchange import Exchange
from pluto_bt.gateway.hub import Hub
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.port import RobotPort
from pluto_bt.gateway.session import Session
from pluto_bt.gateway.wire import Answer, Batch, Down


class LocalClient:
    """A client of a `LocalGateway`; `send` and `received` are his socket."""

    def __init__(self, gateway: LocalGateway, session: Session) -> None:
        self._gateway = gateway
        self._session = session

    def send(self, data: bytes | str) -> None:
        """Bytes to the gateway; stops act before this returns, other requests at the next step."""
        self._session.receive(data if isinstance(data, bytes) else data.encode(), self._gateway.now_s)

    def received(self, room_bytes: int = 1 << 20) -> bytes:
        """What the gateway has to send; with no room only what is never dropped."""
        return self._session.to_send(self._gateway.now_s, room_bytes)

    @property
    def is_over(self) -> bool:
        """The gateway has ended the conversation, and all that it said was received."""
        return self._session.closing and not self._session.queue

    def close(self) -> None:
        """The connection is gone."""
        self._gateway.hub.close(self._session)


class LocalGateway:
    """A Component whose clients live in the same thread."""

    def __init__(self, port: RobotPort, limits: Limits | None = None, access: Access | None = None, audit: Audit | None = None) -> None:
        self._down: deque[Down] = deque()
        self._exchange = Exchange(port, self._down.append, audit)
        self.now_s = port.now_s()
        welcome = self._exchange.welcome(access or Access(), limits or Limits(), 1)
        self.hub = Hub(welcome, self._exchange.receive, self.now_s)

    def start(self, now_s: float) -> None:
        """Nothing to take."""

    def step(self, now_s: float) -> None:
        """Answer and publish."""
        self.now_s = now_s
        self._exchange.step(now_s)
        while self._down:
            frame = self._down.popleft()
            if isinstance(frame, Answer | Batch):
                self.hub.receive(frame, now_s)
        self.hub.tick(now_s)

    def stop(self) -> None:
        """Tell the clients."""
        self.hub.shut()

    def connect(self) -> LocalClient:
        """A new client."""
        return LocalClient(self, self.hub.open(self.now_s))
