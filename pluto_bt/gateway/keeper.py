"""A line to the gateway that is kept: reading, writing, connecting anew, all inside the caller's thread."""

from __future__ import annotations

import socket
import ssl
import threading
from collections.abc import Callable
from typing import Protocol

from pluto_bt.gateway.backoff import STEADY_S, Backoff
from pluto_bt.gateway.dialogue import Dialogue
from pluto_bt.gateway.errors import NoConnectionError
from pluto_bt.runtime.clock import NS, wait, wall_ns

READ_BYTES = 64 * 1024
LEAST_WAIT_S = 0.001  # a socket with a timeout of 0 would not wait for the rest of a TLS record


class Line(Protocol):
    """What the client needs of a connected socket."""

    def settimeout(self, value: float | None, /) -> None:
        """How long `recv` and `sendall` wait before they raise TimeoutError."""

    def recv(self, size: int, /) -> bytes:
        """Bytes; empty at the end."""

    def sendall(self, data: bytes, /) -> None:
        """Send everything."""

    def fileno(self) -> int:
        """For `select`."""

    def close(self) -> None:
        """Let go."""


def now_s() -> float:
    """Seconds of a clock that never goes back."""
    return wall_ns() / NS


def wait_s(seconds: float) -> None:
    """Let time pass."""
    wait(threading.Event(), seconds)


def dialer(host: str, port: int, tls: ssl.SSLContext | None) -> Callable[[float], Line]:
    """How to connect over TCP, with TLS if a context is given."""

    def dial(timeout_s: float) -> Line:
        plain = socket.create_connection((host, port), timeout=timeout_s)
        plain.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return plain if tls is None else tls.wrap_socket(plain, server_hostname=host)

    return dial


def not_reached(place: str, error: OSError, said: str) -> NoConnectionError:
    """Why there is no line to that place; `said`: the error in words."""
    if isinstance(error, ssl.SSLError):
        mend = "PLUTO_CERTIFICATE (tls= of a program) must be this gateway's certificate, and not set for a gateway without TLS"
        return NoConnectionError("no-connection", f"no TLS with {place}: {said}; {mend}")
    return NoConnectionError("no-connection", f"no gateway at {place}: {said}; is a run with --gateway going on?")


class Keeper:
    """Keeps the line of one dialogue. `place` is its address for people; `connect` and `wait` take seconds, `clock` gives them.

    `is_plain`: what `connect` gives speaks no TLS.
    """

    def __init__(
        self, dialogue: Dialogue, place: str, backoff: Backoff | None, connect: Callable[[float], Line],
        clock: Callable[[], float], wait: Callable[[float], None], *, is_plain: bool = False,
    ) -> None:  # fmt: skip
        self.line: Line | None = None
        self.place = place
        self.clock = clock
        self._dialogue, self._timeout_s, self._backoff = dialogue, dialogue.timeout_s, backoff
        self._connect, self._wait, self._is_plain = connect, wait, is_plain
        self._attempt, self._retry_s, self._opened_s = 0, 0.0, 0.0

    def pump(self, is_over: Callable[[], bool], until_s: float) -> bool:
        """Read, write and reconnect until it is over, or the time is; True if it is over. Raises: the final error of the conversation."""
        dialogue = self._dialogue
        while not is_over():
            if dialogue.final is not None:
                self.hang_up()
                raise dialogue.final
            if self.clock() >= until_s:
                return False
            if self.line is None:
                self._try_again(until_s)
            else:
                self.flush()
                self._read(min(until_s, dialogue.due_s) - self.clock())
            dialogue.tick(self.clock())
            if dialogue.is_dead:
                self._lost("the gateway fell silent")
        return True

    def require_line(self) -> None:
        """Raises: GatewayError if there is none."""
        if self._dialogue.final is not None or self.line is None:
            raise self._dialogue.final or NoConnectionError("no-connection", f"no connection to {self.place}")

    def flush(self) -> None:
        """Send what the dialogue has to say, if there is a line."""
        out = self._dialogue.to_send()
        if not out or self.line is None:
            return
        try:
            self.line.settimeout(self._timeout_s)
            self.line.sendall(out)
        except OSError as error:
            while not isinstance(error, TimeoutError) and self._read(LEAST_WAIT_S):
                pass  # who closed the line on us may have said why
            if self.line is not None:
                self._lost(f"the connection is gone ({error.strerror or error})")

    def _read(self, for_s: float) -> bool:
        """Hear what comes in that time; False if nothing does."""
        if self.line is None:
            return False
        try:
            self.line.settimeout(max(for_s, LEAST_WAIT_S))
            data = self.line.recv(READ_BYTES)
        except TimeoutError:
            return False
        except OSError as error:
            self._lost(f"the connection is gone ({error.strerror or error})")
            return False
        if data:
            self._dialogue.feed(data, self.clock())
        else:
            self._lost("the gateway closed the connection")
        return bool(data)

    def _lost(self, why: str) -> None:
        self.hang_up()
        self._dialogue.closed(why, is_plain=self._is_plain)
        if self.clock() - self._opened_s >= STEADY_S:
            self._attempt = 0
        if self._backoff is None:
            self._dialogue.end(self._dialogue.reason(NoConnectionError("no-connection", why)))
        else:
            self._put_off(self._backoff)

    def _put_off(self, backoff: Backoff) -> None:
        self._retry_s = self.clock() + backoff.delay_s(self._attempt)
        self._attempt += 1

    def _try_again(self, until_s: float) -> None:
        """One attempt if it is time for it; else wait for that time, but no longer than somebody waits for us."""
        assert self._backoff is not None
        left_s = min(self._retry_s, until_s, self._dialogue.due_s) - self.clock()
        if left_s > 0.0:
            self._wait(left_s)
            return
        try:
            self.open()
        except NoConnectionError:
            self._put_off(self._backoff)

    def open(self) -> None:
        """One attempt. Raises: NoConnectionError."""
        try:
            self.line = self._connect(self._timeout_s)
        except OSError as error:
            raise not_reached(self.place, error, error.strerror or str(error)) from None
        self._opened_s = self.clock()
        self._dialogue.opened(self._opened_s)

    def hang_up(self) -> None:
        """Close the line."""
        line, self.line = self.line, None
        if line is not None:
            line.close()
