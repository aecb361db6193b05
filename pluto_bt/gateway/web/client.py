"""A browser as a client of the gateway: a WebSocket whose text messages are the protocol itself, so that all its rules hold here too."""

from __future__ import annotations

import asyncio
import contextlib

from aiohttp import WSMsgType, web

from pluto_bt.gateway.client_protocol import SLICE_BYTES
from pluto_bt.gateway.server import Server
from pluto_bt.gateway.session import Session
from pluto_bt.gateway.web.house import known

FULL_S = 0.05
"""How soon it is looked again whether a slow browser has read."""


class WebClient:
    """Moves text between one WebSocket and its session. Values wait for a slow browser, and old ones are lost; replies never are."""

    def __init__(self, server: Server, request: web.Request, connection: web.WebSocketResponse) -> None:
        self._server = server
        self._connection = connection
        self._transport = request.transport
        self._loop = asyncio.get_running_loop()
        self._session: Session = server.hub.open(self._loop.time())
        self._session.peer = ":".join(map(str, (request.transport.get_extra_info("peername") or ())[:2])) if request.transport else ""
        self._session.known_as(known(request, server.hub.access))
        self._wake = asyncio.Event()
        self._may_go_on = asyncio.Event()
        self._session.place.on_free = self._may_go_on.set

    def flush(self) -> None:
        """Something may have to be sent."""
        self._wake.set()

    def tick(self, now_s: float) -> None:
        """Look after the browser's manners: `_write` does, when it is woken."""
        self._wake.set()

    async def serve(self) -> None:
        """Until either side has had enough."""
        self._server.clients[self._session.client] = self
        writing = self._loop.create_task(self._write())
        try:
            async for message in self._connection:
                if message.type is WSMsgType.TEXT:
                    await self._read(message.data.encode())
                elif message.type is WSMsgType.BINARY:
                    self._session.fail("bad-encoding", "expected text messages, found a binary one")
                self.flush()
        finally:
            writing.cancel()
            with contextlib.suppress(asyncio.CancelledError, ConnectionError):
                await writing
            self._server.clients.pop(self._session.client, None)
            self._server.hub.close(self._session)

    async def _read(self, data: bytes) -> None:
        """In slices, so that a big message does not hold up the other clients."""
        for at in range(0, len(data), SLICE_BYTES):
            for _ in self._session.taking(data[at : at + SLICE_BYTES], self._loop.time()):
                if len(self._session.queue) > self._server.hub.limits.write_mark_bytes:
                    self.flush()
                    await asyncio.sleep(0)
            self.flush()
            while self._session.place.is_held_up:
                self._may_go_on.clear()
                await self._may_go_on.wait()
            if at + SLICE_BYTES < len(data):
                await asyncio.sleep(0)

    async def _write(self) -> None:
        while self._transport is not None and not self._transport.is_closing():
            self._wake.clear()
            now_s = self._loop.time()
            mark_bytes, unread_bytes = self._server.hub.limits.write_mark_bytes, self._transport.get_write_buffer_size()
            is_full = unread_bytes > mark_bytes
            self._session.tick(now_s, unread_bytes)
            out = self._session.to_send(now_s, 0 if is_full else mark_bytes)
            if out:
                await self._connection.send_str(out.decode())
            if self._session.closing:
                break
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(FULL_S if is_full else None):
                    await self._wake.wait()
        await self._connection.close()
