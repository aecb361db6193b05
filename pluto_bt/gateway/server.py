"""The TCP side of the gateway process: the clients of a listening socket, and what is due for all of them."""

from __future__ import annotations

import asyncio
import socket
import ssl
from collections.abc import Iterable
from typing import Protocol

from pluto_bt.gateway.client_protocol import ClientProtocol
from pluto_bt.gateway.hub import Hub
from pluto_bt.gateway.listen import BACKLOG

TICK_S, TICKS_A_SWEEP, HANDSHAKE_S = 0.05, 10, 3.0


class Served(Protocol):
    """A client as the server sees it, whatever carries his bytes."""

    def flush(self) -> None:
        """Something of his may have to be sent."""

    def tick(self, now_s: float) -> None:
        """Look after his manners."""


class Server:
    """The clients of one gateway process: those of its listening socket, and those whom the web console brings."""

    def __init__(self, hub: Hub) -> None:
        self.hub = hub
        self.loop = asyncio.get_running_loop()
        self.clients: dict[int, Served] = {}
        self._ticks = 0

    async def listen(self, listener: socket.socket) -> None:
        """Take connections."""
        context: ssl.SSLContext | None = self.hub.access.context()
        wait_s = None if context is None else HANDSHAKE_S
        await self.loop.create_server(lambda: ClientProtocol(self), sock=listener, backlog=BACKLOG, ssl=context, ssl_handshake_timeout=wait_s)

    def begin(self) -> None:
        """Look after rates and manners from now on."""
        self._tick()

    def flush(self, clients: Iterable[int]) -> None:
        """These clients have something to be sent."""
        for client in clients:
            protocol = self.clients.get(client)
            if protocol is not None:
                protocol.flush()

    def shut(self) -> None:
        """Tell everybody that it is over."""
        self.hub.shut()
        self.flush(tuple(self.clients))

    def let_one_go(self) -> bool:
        """Make room for a newcomer, who may be an operator, among those who linger; False if nobody does."""
        return any(isinstance(client, ClientProtocol) and client.let_go() for client in self.clients.values())

    def _tick(self) -> None:
        now_s = self.loop.time()
        self.loop.call_at(now_s + TICK_S, self._tick)
        self.flush(self.hub.tick(now_s))
        self._ticks += 1
        for protocol in tuple(self.clients.values()) if self._ticks % TICKS_A_SWEEP == 0 else ():
            protocol.tick(now_s)
