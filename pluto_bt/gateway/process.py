"""The gateway process: started by `GatewayLink`, given a listening socket and one to the executive, it ends when he does."""

from __future__ import annotations

import asyncio
import signal
import socket
import sys
from typing import cast

from pluto_bt.gateway.hub import Hub
from pluto_bt.gateway.server import Server
from pluto_bt.gateway.wire import Answer, Batch, Farewell, Frames, Up, Welcome, pack

FAREWELL_S = 0.2


class ExecutiveProtocol(asyncio.Protocol):
    """The way to the executive. It begins with his `Welcome` and ends with his silence."""

    def __init__(self, listener: socket.socket, done: asyncio.Event) -> None:
        self._listener = listener
        self._done = done
        self._loop = asyncio.get_running_loop()
        self._frames = Frames(up=False)
        self._transport: asyncio.Transport
        self._server: Server | None = None
        self._starting: asyncio.Task[None] | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """The socket is ours."""
        self._transport = cast(asyncio.Transport, transport)  # uvloop's own is no subclass

    def data_received(self, data: bytes) -> None:
        """Frames of the executive."""
        for frame in self._frames.feed(data):
            if isinstance(frame, Welcome):
                self._server = Server(Hub(frame, self._send, self._loop.time()))
                self._starting = self._loop.create_task(self._server.listen(self._listener))
            elif self._server is not None and isinstance(frame, Answer | Batch):
                self._server.flush(self._server.hub.receive(frame, self._loop.time()))
            elif self._server is not None and isinstance(frame, Farewell):
                self._server.shut()
                self._loop.call_later(FAREWELL_S, self._done.set)

    def connection_lost(self, exc: Exception | None) -> None:
        """Without the executive there is nothing to serve."""
        if self._server is not None:
            self._server.shut()
        self._done.set()

    def _send(self, frame: Up) -> None:
        self._transport.write(pack(frame))


async def serve(listener: socket.socket, executive: socket.socket) -> None:
    """Serve until the executive says farewell or is gone."""
    done = asyncio.Event()
    await asyncio.get_running_loop().create_connection(lambda: ExecutiveProtocol(listener, done), sock=executive)
    await done.wait()


def main() -> None:
    """`process LISTENER_FD EXECUTIVE_FD`: inherited sockets; everything else comes in the first frame."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the executive's: the gateway serves until he says farewell
    listener, executive = (socket.socket(fileno=int(word)) for word in sys.argv[1:3])
    listener.setblocking(False)
    executive.setblocking(False)
    try:
        import uvloop
    except ImportError:
        asyncio.run(serve(listener, executive))
    else:
        uvloop.run(serve(listener, executive))


if __name__ == "__main__":
    main()
