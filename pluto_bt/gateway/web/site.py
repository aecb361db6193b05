"""The live console in the gateway's process: the page, its scenery, and a WebSocket to the same hub that the TCP clients have."""

from __future__ import annotations

import socket

from aiohttp import web

from pluto_bt.gateway.server import Server
from pluto_bt.gateway.sockets import keep_buffers_small
from pluto_bt.gateway.web.client import WebClient
from pluto_bt.gateway.web.doorkeeper import Doorkeeper
from pluto_bt.gateway.web.house import make_app
from pluto_bt.gateway.wire import Scenery

WRITER_LIMIT_BYTES = 1 << 40  # aiohttp must not wait for a slow browser: the session knows what to drop, and when to end it


class Site:
    """The console of one robot."""

    def __init__(self, server: Server, scenery: Scenery) -> None:
        self._server = server
        app = make_app(scenery, server.hub.access)
        app.router.add_get("/socket", self._socket)
        self._keeper = Doorkeeper(app)

    async def listen(self, listener: socket.socket) -> None:
        """Serve until the loop ends."""
        await self._keeper.listen(listener, self._server.hub.access.context())

    async def _socket(self, request: web.Request) -> web.WebSocketResponse:
        limits = self._server.hub.limits
        connection = web.WebSocketResponse(
            timeout=limits.linger_s, compress=False, max_msg_size=limits.message_bytes, writer_limit=WRITER_LIMIT_BYTES
        )
        await connection.prepare(request)
        if request.transport is not None:
            keep_buffers_small(request.transport, limits.write_mark_bytes)
        await WebClient(self._server, request, connection).serve()
        return connection
