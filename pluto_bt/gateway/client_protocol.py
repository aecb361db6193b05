"""One client's socket in the gateway process: an asyncio protocol, thin around the client's `Session`."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, cast

from pluto_bt.gateway.outlets import Outlet
from pluto_bt.gateway.session import Session
from pluto_bt.gateway.sockets import common_name, keep_buffers_small
from pluto_bt.runtime.clock import wall_ns

if TYPE_CHECKING:
    from pluto_bt.gateway.server import Server

SLICE_BYTES, TURN_NS = 4096, 2_000_000
"""How much of one client's input is read, and for how long, before the others have their turn."""


class ClientProtocol(asyncio.Protocol):
    """Moves bytes between a socket and a session, fairly, and ends the connection in good order."""

    def __init__(self, server: Server) -> None:
        self._server = server
        self._loop = server.loop
        self._transport: asyncio.Transport
        self._session: Session
        self._unread: deque[bytes] = deque()
        self._taking: Iterator[None] | None = None  # goes through what is unread
        self._timers: list[asyncio.TimerHandle] = []
        self._is_full = False
        self._at_eof = False
        self._is_ending = False
        self._discarded = 0  # bytes since the end began
        self._outlet: Outlet | None = None

    # asyncio's calls ---------------------------------------------------------------------------------------------
    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """A client."""
        self._transport = cast(asyncio.Transport, transport)  # uvloop's own is no subclass
        hub = self._server.hub
        keep_buffers_small(self._transport, hub.limits.write_mark_bytes)
        self._session = hub.open(self._loop.time())
        self._session.place.on_free = self._go_on
        if len(self._server.clients) >= 2 * hub.limits.clients and not self._server.let_one_go():
            self._session.fail("too-many-connections", "too many others are being turned away just now")
            self._transport.write(self._session.to_send(self._loop.time(), 0))
            self._transport.close()  # at once, so that the error may be lost on the way
            return
        self._session.peer = ":".join(map(str, (self._transport.get_extra_info("peername") or ())[:2]))
        self._session.known_as(hub.access.by_certificate(common_name(self._transport)))
        self._server.clients[self._session.client] = self
        connection = transport.get_extra_info("socket")
        if connection is not None and transport.get_extra_info("sslcontext") is None:
            self._outlet = self._session.subscriptions.outlet = hub.outlets.add(connection.fileno(), self)
        self.flush()

    def data_received(self, data: bytes) -> None:
        """Bytes: taken in turns, so that what one client asks for does not hold up the others."""
        if self._is_ending and self._taking is None:
            self._discard(data)
            return
        self._unread.extend(data[at : at + SLICE_BYTES] for at in range(0, len(data), SLICE_BYTES))
        if self._taking is None:
            self._taking = self._messages()
            self._turn()

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
        """Gone: its socket is closed after this, and the number may be another's then; and nothing may keep this object alive."""
        if self._outlet is not None:
            self._outlet.close()
        self._unread.clear()
        self._taking = None
        for timer in self._timers:
            timer.cancel()
        self._server.clients.pop(self._session.client, None)
        self._server.hub.close(self._session)

    # our own -----------------------------------------------------------------------------------------------------
    def let_go(self) -> bool:
        """Give up a client who has been told that it is over and lingers on; False for any other."""
        if not self._is_ending or self._transport.is_closing():
            return False
        self._server.clients.pop(self._session.client, None)  # now, not when the loop comes round to it: many may come at once
        self._transport.abort()
        return True

    def _discard(self, data: bytes) -> None:
        """What comes after the end: only a stop in a flood is still heard. Who goes on and on is not read any more."""
        self._session.receive(data, self._loop.time())
        self._discarded += len(data)
        if self._discarded > self._server.hub.limits.discard_bytes:
            self._transport.pause_reading()

    def _messages(self) -> Iterator[None]:
        while self._unread:
            yield from self._session.taking(self._unread.popleft(), self._loop.time())
            yield

    def _turn(self) -> None:
        """Take a message after the other, as long as one's turn lasts; one a turn while the answers cannot be sent. The rest in the next turn."""
        if self._taking is None or self._transport.is_closing():
            return
        mark_bytes, until_ns = self._server.hub.limits.write_mark_bytes, wall_ns() + TURN_NS
        for _ in self._taking:
            if len(self._session.queue) > mark_bytes:
                self.flush()
            if self._session.place.is_held_up or self._is_full or wall_ns() > until_ns:
                self.flush()
                self._transport.pause_reading()
                if not self._session.place.is_held_up:
                    self._go_on()
                return
        self._taking = None
        self.flush()
        if not self._transport.is_closing() and self._discarded <= self._server.hub.limits.discard_bytes:
            self._transport.resume_reading()
        self._end_if_served()

    def _go_on(self) -> None:
        self._loop.call_soon(self._turn)

    def flush(self) -> None:
        """Write what is to be sent: values only if the client reads."""
        session = self._session
        if self._is_ending or self._transport.is_closing():
            return
        if self._is_full:
            session.tick(self._loop.time(), self._transport.get_write_buffer_size())
        out = session.to_send(self._loop.time(), 0 if self._is_full else self._server.hub.limits.write_mark_bytes)
        if out:
            self._hold()
            self._transport.write(out)
        if session.closing:
            self._end()
        elif self._at_eof:
            self._end_if_served()

    def is_clear(self) -> bool:
        """See `Owner`."""
        session, transport = self._session, self._transport
        return not (self._is_ending or session.queue or session.subscriptions.due or transport.get_write_buffer_size() or transport.is_closing())

    def send_rest(self, rest: bytes) -> None:
        """See `Owner`."""
        self._transport.write(rest)

    def _hold(self) -> None:
        """Lines do not go past the transport for now."""
        if self._outlet is not None:
            self._outlet.hold()

    def tick(self, now_s: float) -> None:
        """Look after the client's manners."""
        if not self._is_ending and not self._transport.is_closing():
            self._session.tick(now_s, self._transport.get_write_buffer_size())
            if self._session.closing:
                self.flush()

    def _end_if_served(self) -> None:
        """A client that has said all is let go when nothing of his is unread or unanswered.

        A run that goes on does not keep him: he may as well have been killed, and then what he drives must stop.
        """
        if self._at_eof and self._taking is None and not self._session.is_waiting and not self._transport.is_closing():
            self._hold()
            self._transport.close()
            self._later(self._server.hub.limits.idle_s, self._transport.abort)  # one that does not read what waits must go, too

    def _end(self) -> None:
        """Half-close, go on discarding input, then close: a reset would swallow the error."""
        self._is_ending = True
        self._hold()
        linger_s = self._server.hub.limits.linger_s
        if self._at_eof:
            self._transport.close()
        elif self._transport.can_write_eof():
            self._transport.write_eof()
        else:  # TLS has no half-close: the error is sent, then all ends
            self._later(linger_s, self._transport.close)
        self._later(2.0 * linger_s if not self._transport.can_write_eof() else linger_s, self._transport.abort)

    def _later(self, wait_s: float, act: Callable[[], None]) -> None:
        self._timers.append(self._loop.call_later(wait_s, act))
