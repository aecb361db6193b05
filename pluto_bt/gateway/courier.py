"""Moves bytes between the executive and the gateway process: a thread that reads, and a buffer that never makes a writer wait."""

from __future__ import annotations

import contextlib
import select
import socket
import threading
from collections.abc import Callable

import msgspec

from pluto_bt.gateway.pulse import Pulse
from pluto_bt.gateway.wire import Alive, Down, Frames, Up, pack
from pluto_bt.runtime.clock import wall_ns
from pluto_bt.runtime.precedence import take_precedence

READ_BYTES = 256 * 1024


class Courier:
    """One Unix socket. `on_frame` is called in the courier's thread.

    Attributes:
        pulse: what comes is heard there.
        ended: the other side is gone; the socket is closed.
    """

    def __init__(self, connection: socket.socket, on_frame: Callable[[Up], None]) -> None:
        connection.setblocking(False)
        self._socket = connection
        self._on_frame = on_frame
        self._lock = threading.Lock()
        self._out = bytearray()
        self._wake_read, self._wake_write = socket.socketpair()
        self.pulse = Pulse(wall_ns())
        self.ended = False
        self._thread = threading.Thread(target=self._move, name="gateway-courier", daemon=True)
        self._thread.start()

    @property
    def waiting_bytes(self) -> int:
        """Bytes that the other side has not taken."""
        return len(self._out)

    def send(self, frame: Down) -> None:
        """Send at once what the socket takes; the thread sends the rest. Never blocks; after the end it does nothing."""
        data = pack(frame)
        with self._lock:
            if self.ended:
                return
            self._out += data
            self._flush()
            left = bool(self._out)
        if left:
            self._wake()

    def close(self) -> None:
        """End the connection and the thread."""
        with self._lock:
            self.ended = True
        self._wake()
        if threading.current_thread() is not self._thread:
            self._thread.join(timeout=2.0)

    def _wake(self) -> None:
        with contextlib.suppress(OSError):  # a wake-up is waiting already, or the thread has ended
            self._wake_write.send(b"!", socket.MSG_DONTWAIT)

    def _flush(self) -> None:
        """Under the lock: send what the socket takes."""
        try:
            while self._out:
                del self._out[: self._socket.send(self._out)]
        except BlockingIOError:
            pass
        except OSError:
            self._out.clear()  # the reader will notice the end

    def _move(self) -> None:
        take_precedence()  # it brings the stops
        frames = Frames(up=True)
        # A gateway that breaks, or speaks nonsense, is gone; the link starts another.
        with contextlib.suppress(OSError, ValueError, msgspec.DecodeError):
            while not self.ended and self._turn(frames):
                pass
        with self._lock:
            self.ended = True
            for connection in (self._socket, self._wake_read, self._wake_write):
                connection.close()

    def _turn(self, frames: Frames) -> bool:
        """Wait until something can be moved, and move it; False at the end of the stream."""
        poll = select.poll()
        with self._lock:
            poll.register(self._socket, select.POLLIN | (select.POLLOUT if self._out else 0))
        poll.register(self._wake_read, select.POLLIN)
        ready = dict(poll.poll())
        if self._wake_read.fileno() in ready:
            self._wake_read.recv(4096)
        state = ready.get(self._socket.fileno(), 0)
        if state & select.POLLOUT:
            with self._lock:
                self._flush()
        if state & ~select.POLLOUT:
            data = self._socket.recv(READ_BYTES)
            if not data:
                return False
            self.pulse.hear()
            for frame in frames.feed(data):
                if not isinstance(frame, Alive):
                    self._on_frame(frame)
        return True
