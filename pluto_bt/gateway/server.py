"""The TCP side of the gateway process: one asyncio protocol a client, thin around its `Session`."""

from __future__ import annotations

import asyncio
import socket
from collections import deque
from collections.abc import Iterable
from typing import Protocol, cast

from pluto_bt.gateway.hub import Hub
from pluto_bt.gateway.session import Session

SLICE_BYTES = 4096
"""Bytes of one client that are read before the others have their turn."""
LOWAT_BYTES = 16 * 1024


class ClientProtocol(asyncio.Protocol):
    """Moves bytes between a socket and a session, fairly, and ends the connection in good order."""

    def __init__(self, server: Server) -> None:
        self._server = server
        self._loop = asyncio.get_running_loop()
        self._transport: asyncio.Transport
        self._session: Session
        self._unread: deque[bytes] = deque()
        self._is_reading = False
        self._is_full = False
        self._at_eof = False
        self._is_ending = False
        self._timer: asyncio.Handle | None = None
        self._timer_due_s = 0.0  # kept here, because uvloop's handles do not tell it

    # asyncio's calls ---------------------------------------------------------------------------------------------
    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """A client."""
        self._transport = cast(asyncio.Transport, transport)  # uvloop's own is no subclass
        _keep_buffers_small(self._transport, self._server.hub.limits.write_mark_bytes)
        self._session = self._server.hub.open(self._loop.time())
        if len(self._server.clients) >= 2 * self._server.hub.limits.clients:  # so many that not even the error can be said to all
            self._transport.abort()
            return
        self._server.clients[self._session.client] = self
        self.flush()

    def data_received(self, data: bytes) -> None:
        """Bytes: taken in slices, so that a big message of one client does not hold up the others."""
        self._unread.extend(data[at : at + SLICE_BYTES] for at in range(0, len(data), SLICE_BYTES))
        if not self._is_reading:
            self._transport.pause_reading()
            self._is_reading = True
            self._read_slice()

    def eof_received(self) -> bool:
        """The client has said all; he may still wait for answers."""
        self._at_eof = True
        if self._is_ending:
            self._transport.close()
        self._end_if_served()
        return not self._transport.is_closing()

    def pause_writing(self) -> None:
        """The client reads too slowly: values wait."""
        self._is_full = True

    def resume_writing(self) -> None:
        """He reads again."""
        self._is_full = False
        self.flush()

    def connection_lost(self, exc: Exception | None) -> None:
        """Gone."""
        if self._timer is not None:
            self._timer.cancel()
        self._unread.clear()
        self._server.clients.pop(self._session.client, None)
        self._server.hub.close(self._session)

    # our own -----------------------------------------------------------------------------------------------------
    def _read_slice(self) -> None:
        if self._transport.is_closing():
            return
        if self._unread:
            self._session.receive(self._unread.popleft(), self._loop.time())
            self.flush()
        if self._unread:
            self._loop.call_soon(self._read_slice)
            return
        self._is_reading = False
        self._transport.resume_reading()
        self._end_if_served()

    def flush(self) -> None:
        """Write what is to be sent, look after the client's manners, and come back when time demands it."""
        if self._transport.is_closing() or self._is_ending:
            return
        now_s = self._loop.time()
        self._session.tick(now_s, self._transport.get_write_buffer_size())
        out = self._session.to_send(now_s, 0 if self._is_full else self._server.hub.limits.write_mark_bytes)
        if out:
            self._transport.write(out)
        if self._session.closing:
            self._end()
            return
        self._end_if_served()
        self._wake_at(self._session.next_due_s() if not self._is_full else now_s + 1.0)

    def _wake_at(self, due_s: float) -> None:
        if self._timer is not None:
            if self._timer_due_s <= due_s and not self._timer.cancelled():
                return
            self._timer.cancel()
        self._timer, self._timer_due_s = self._loop.call_at(due_s, self._on_timer), due_s

    def _on_timer(self) -> None:
        self._timer = None
        self.flush()

    def _end_if_served(self) -> None:
        """A client that has said all is let go when nothing of his is unread or unanswered."""
        if self._at_eof and not self._unread and not self._session.is_waiting:
            self._transport.close()
            self._abort_after(self._server.hub.limits.idle_s)  # one that does not read what waits must go, too

    def _abort_after(self, seconds: float) -> None:
        if self._timer is not None:
            self._timer.cancel()
        self._timer = self._loop.call_later(seconds, self._transport.abort)

    def _end(self) -> None:
        """Half-close, go on discarding input, then close: a reset would swallow the error."""
        self._is_ending = True
        self._abort_after(self._server.hub.limits.linger_s)
        if self._at_eof:
            self._transport.close()
        elif self._transport.can_write_eof():
            self._transport.write_eof()


class Served(Protocol):
    """A client as the server sees it, whatever carries his bytes."""

    def flush(self) -> None:
        """Something of his may have to be sent."""


class Server:
    """The clients of one gateway process: those of its listening socket, and those whom the web console brings."""

    def __init__(self, hub: Hub) -> None:
        self.hub = hub
        self.clients: dict[int, Served] = {}

    async def listen(self, listener: socket.socket) -> None:
        """Take connections."""
        loop = asyncio.get_running_loop()
        await loop.create_server(lambda: ClientProtocol(self), sock=listener)

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


def _keep_buffers_small(transport: asyncio.Transport, mark_bytes: int) -> None:
    """Kernel and library would hide megabytes of stale values from a slow reader."""
    transport.set_write_buffer_limits(high=mark_bytes)
    connection = transport.get_extra_info("socket")
    if connection is not None:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if hasattr(socket, "TCP_NOTSENT_LOWAT"):
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, LOWAT_BYTES)
