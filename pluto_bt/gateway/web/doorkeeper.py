"""Keeps a listening socket for people: not too many connections at once, and none that sits there without asking for anything."""

from __future__ import annotations

import asyncio
import socket
import ssl

from aiohttp import web
from aiohttp.typedefs import Middleware
from aiohttp.web_protocol import RequestHandler

from pluto_bt.gateway.web.house import Handler

CONNECTIONS = 128
"""Connections at one time, WebSockets included. Are all places taken, who has not asked for longest gives way: the page with STOP comes in."""
HANDSHAKE_S = 3.0
PATIENCE_S = 10.0
"""A connection must have asked for something within this time, and again after each answer."""


class Doorkeeper:
    """Serves `app` on a socket until the loop ends."""

    def __init__(self, app: web.Application) -> None:
        app.middlewares.append(self._noting())
        self._runner = web.AppRunner(app, access_log=None, keepalive_timeout=PATIENCE_S, lingering_time=0.5)
        self._busy: set[int] = set()  # ids of the connections whose request is being answered
        self._since_s: dict[RequestHandler, float] = {}  # admitted: since when it has not asked
        self._open: set[RequestHandler] = set()

    async def listen(self, listener: socket.socket, tls: ssl.SSLContext | None = None) -> None:
        """Take connections, and go round from time to time."""
        await self._runner.setup()
        loop = asyncio.get_running_loop()
        await loop.create_server(self._admit, sock=listener, ssl=tls, ssl_handshake_timeout=None if tls is None else HANDSHAKE_S)
        while True:
            await asyncio.sleep(PATIENCE_S / 4)
            self._round(loop.time())

    def _admit(self) -> asyncio.Protocol:
        server = self._runner.server
        assert server is not None, "set up before it listens"
        now_s = asyncio.get_running_loop().time()
        self._forget(now_s)
        if len(self._since_s) >= CONNECTIONS and not self._let_one_go():
            return _Closed()
        connection = server()
        self._since_s[connection] = now_s
        return connection

    def _is_idle(self, connection: RequestHandler) -> bool:
        return connection.transport is not None and id(connection) not in self._busy

    def _let_one_go(self) -> bool:
        """Make room; False if each of them is being answered."""
        oldest = min(filter(self._is_idle, self._since_s), key=self._since_s.__getitem__, default=None)
        if oldest is None or oldest.transport is None:
            return False
        del self._since_s[oldest]  # now, not when the loop comes round to it: many may come at once
        self._open.discard(oldest)
        oldest.transport.abort()
        return True

    def _forget(self, now_s: float) -> None:
        """Those that are gone; one that was admitted just now has no transport yet."""
        self._open |= {connection for connection in self._since_s if connection.transport is not None}
        for connection, since_s in list(self._since_s.items()):
            if connection.transport is None and (connection in self._open or now_s - since_s > HANDSHAKE_S):
                del self._since_s[connection]
                self._open.discard(connection)

    def _noting(self) -> Middleware:
        @web.middleware
        async def note(request: web.Request, handler: Handler) -> web.StreamResponse:
            connection = request.protocol
            self._busy.add(id(connection))
            try:
                return await handler(request)
            finally:
                self._busy.discard(id(connection))
                self._since_s[connection] = asyncio.get_running_loop().time()

        return note

    def _round(self, now_s: float) -> None:
        self._forget(now_s)
        for connection, since_s in self._since_s.items():
            if self._is_idle(connection) and now_s - since_s >= PATIENCE_S and connection.transport is not None:
                connection.transport.abort()


class _Closed(asyncio.Protocol):
    """For who comes when all places are taken."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        transport.close()
