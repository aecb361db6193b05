"""The gateway process: started by `GatewayLink`, given its listening sockets and one to the executive, it ends when he does."""

from __future__ import annotations

import asyncio
import signal
import socket
import sys
from typing import cast

from pluto_bt.gateway.burst import fastest
from pluto_bt.gateway.hub import Hub
from pluto_bt.gateway.outlets import Outlets
from pluto_bt.gateway.pulse import BEAT_S
from pluto_bt.gateway.server import Server
from pluto_bt.gateway.wire import Alive, Answer, Batch, Farewell, Frames, Up, Welcome, pack

FAREWELL_S = 0.2


class ExecutiveProtocol(asyncio.Protocol):
    """The way to the executive. It begins with his `Welcome` and ends with his silence."""

    def __init__(self, listener: socket.socket | None, web: socket.socket | None, done: asyncio.Event) -> None:
        self._listener = listener
        self._web = web
        self._done = done
        self._loop = asyncio.get_running_loop()
        self._frames = Frames(up=False)
        self._transport: asyncio.Transport
        self._server: Server | None = None
        self._starting: list[asyncio.Task[None]] = []

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """The socket is ours."""
        self._transport = cast(asyncio.Transport, transport)  # uvloop's own is no subclass

    def data_received(self, data: bytes) -> None:
        """Frames of the executive."""
        for frame in self._frames.feed(data):
            if isinstance(frame, Welcome):
                self._open(frame)
            elif self._server is not None and isinstance(frame, Answer | Batch):
                self._server.flush(self._server.hub.receive(frame, self._loop.time()))
            elif self._server is not None and isinstance(frame, Farewell):
                self._server.shut()
                self._loop.call_later(FAREWELL_S, self._done.set)

    def _open(self, welcome: Welcome) -> None:
        server = self._server = Server(Hub(welcome, self._send, self._loop.time(), Outlets(fastest())))
        server.begin()
        if self._listener is not None:
            self._starting.append(self._loop.create_task(server.listen(self._listener)))
        if self._web is not None and welcome.scenery is not None:
            from pluto_bt.gateway.web.site import Site  # aiohttp is needed only here

            self._starting.append(self._loop.create_task(Site(server, welcome.scenery).listen(self._web)))
        self._beat()

    def _beat(self) -> None:
        """From the same loop that serves: if one hangs, the other is silent."""
        self._send(Alive())
        self._loop.call_later(BEAT_S, self._beat)

    def connection_lost(self, exc: Exception | None) -> None:
        """Without the executive there is nothing to serve."""
        if self._server is not None:
            self._server.shut()
        self._done.set()

    def _send(self, frame: Up) -> None:
        if not self._transport.is_closing():  # clients leave after the executive too, and there is nobody left to tell
            self._transport.write(pack(frame))


async def serve(executive: socket.socket, listener: socket.socket | None, web: socket.socket | None) -> None:
    """Serve until the executive says farewell or is gone."""
    done = asyncio.Event()
    await asyncio.get_running_loop().create_connection(lambda: ExecutiveProtocol(listener, web, done), sock=executive)
    await done.wait()


def main() -> None:
    """`process EXECUTIVE_FD LISTENER_FD WEB_FD`: inherited sockets, -1 = none; everything else comes in the first frame."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the executive's: the gateway serves until he says farewell
    executive, listener, web = (socket.socket(fileno=int(word)) if word != "-1" else None for word in sys.argv[1:4])
    assert executive is not None
    for connection in filter(None, (executive, listener, web)):
        connection.setblocking(False)
    try:
        import uvloop
    except ImportError:
        asyncio.run(serve(executive, listener, web))
    else:
        uvloop.run(serve(executive, listener, web))


if __name__ == "__main__":
    main()
