"""The synchronous client: for scripts, for the proxies, for tests. Needs a socket and the standard library only.

It reads, writes, renews its lease and reconnects inside its calls and nowhere else: no thread. So a program that hangs does not go on
holding the robot; its lease runs out.
"""

from __future__ import annotations

import contextlib
import math
import socket
import ssl
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any, Protocol, Self
from xml.etree import ElementTree

from pluto_bt.gateway.ask import Ask
from pluto_bt.gateway.backoff import AGAIN, Backoff
from pluto_bt.gateway.dialogue import Dialogue
from pluto_bt.gateway.errors import GatewayError, NoAnswerError, NoConnectionError
from pluto_bt.gateway.words import OnProgress, RunResult, command_body, hello_of, no_progress, result_of, tell_progress
from pluto_bt.gateway.xml_text import Attribute
from pluto_bt.runtime.clock import NS, calendar_ns, wait, wall_ns

if TYPE_CHECKING:
    from pluto_bt.gateway.async_client import AsyncClient as AsyncClient

Element = ElementTree.Element
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


def new_ids(session: str) -> str:
    """What the ids of a client begin with. In a named session an id acts once, so that ids of an earlier program must not come again."""
    return f"{calendar_ns():x}." if session else "c"


class Client:
    """One client of one gateway, over as many connections as it takes.

    Replies are told from other messages by their `id`; what is not asked for now (values, events) waits in `pending`.
    """

    def __init__(
        self, host: str = "127.0.0.1", port: int = 7500, *, name: str = "", session: str = "", token: str = "",
        tls: ssl.SSLContext | None = None, timeout_s: float = 5.0, backoff: Backoff | None = AGAIN,
        connect: Callable[[float], Line] | None = None, clock: Callable[[], float] = now_s, wait: Callable[[float], None] = wait_s,
    ) -> None:  # fmt: skip
        """Connect once and, if a name, session or token is given, say hello.

        Args:
            session: under this name commands and runs act once, also over a lost connection, and the lease survives a gateway that dies.
            token, tls: for a gateway that is not on this machine; `ssl.create_default_context(cafile=…)` trusts its certificate.
            timeout_s: how long each answer may take, reconnecting included.
            backoff: how long to wait before each new connection; None = a lost connection is the end.
            connect, clock, wait: (timeout in s) → connected socket, seconds, let seconds pass; for tests and for other kinds of lines.

        Raises: GatewayError if there is no gateway, or it turns us away.
        """
        self.timeout_s = timeout_s
        self._address = (host, port)
        self._tls, self._backoff = tls, backoff
        self._connect, self._clock, self._wait = connect or self._dial, clock, wait
        self._line: Line | None = None
        self._attempt, self._retry_s = 0, 0.0
        self.dialogue = Dialogue(hello_of(name, session, token), timeout_s, new_ids(session))
        self._open()
        if (name or session or token) and not self._pump(lambda: self.dialogue.welcome is not None, self._clock() + timeout_s):
            self.close()
            raise NoAnswerError("no-answer", f"{self._place} did not answer <hello> within {timeout_s:g} s")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Let go; a lease ends by it."""
        self.dialogue.end(NoConnectionError("no-connection", "the client was closed"))
        self._hang_up()

    def fileno(self) -> int:
        """For `select`; -1 while there is no connection."""
        return -1 if self._line is None else self._line.fileno()

    def now_s(self) -> float:
        """Seconds of the client's clock."""
        return self._clock()

    @property
    def pending(self) -> deque[Element]:
        """What came and was not asked for."""
        return self.dialogue.inbox

    @property
    def is_connected(self) -> bool:
        """A connection stands, as far as we know."""
        return self._line is not None

    # asking ------------------------------------------------------------------------------------------------------
    def send(self, tag: str, body: str = "", /, **attributes: Attribute) -> str:
        """Say something whose answer is not waited for; its id."""
        one = self.dialogue.ask(tag, body, attributes, self._clock())
        self._flush()
        return one.id

    def send_raw(self, data: bytes) -> None:
        """Send bytes as they are; what is said to them comes by `receive`. Raises: GatewayError if there is no connection."""
        if self._line is None:
            raise NoConnectionError("no-connection", f"no connection to {self._place}")
        self.dialogue.say(data)
        self._flush()

    def request(self, tag: str, body: str = "", /, **attributes: Attribute) -> Element:
        """Say something and wait for the answer. Raises: GatewayError if it is an error, or does not come in time."""
        one = self.dialogue.ask(tag, body, attributes, self._clock())
        self._pump(lambda: one.is_over, math.inf)
        return one.answer()

    def subscribe(self, topic: str, max_rate_hz: float = 0.0, on_change: bool = False) -> str:
        """Values from now on, to be had by `receive`; the id they carry. A new connection has the same subscriptions."""
        return self.request("subscribe", topic=topic, max_rate_hz=max_rate_hz, on_change=on_change).get("id", "")

    def stop(self) -> None:
        """Zero velocity at once; needs no lease."""
        self.request("stop")

    def lease(self, op: str = "acquire", **attributes: Attribute) -> Element:
        """`acquire`, `take`, `renew`, `query` or `release` the right to drive."""
        return self.request("lease", op=op, **attributes)

    @contextlib.contextmanager
    def driving(self, ttl_s: float = 3.0, on_loss: str = "stop", op: str = "acquire") -> Iterator[None]:
        """Hold the lease inside; it is renewed while calls of this client go on, so let none of your own steps take as long as `ttl_s`."""
        self.lease(op, ttl_s=ttl_s, on_loss=on_loss)
        self.dialogue.keep_lease(ttl_s, self._clock())
        try:
            yield
        finally:
            self.dialogue.keep_lease(0.0, 0.0)
            with contextlib.suppress(GatewayError):  # lost, or the connection is gone: then there is nothing to give back
                self.lease("release")

    def command(
        self, target: str, flags: int, position: Sequence[float] = (), velocity: Sequence[float] = (),
        acceleration: Sequence[float] = (), force: Sequence[float] = (),
    ) -> None:  # fmt: skip
        """A raw `ActuatorState` into a link of the chain, or to the wrist. Raises: GatewayError."""
        self.request("command", command_body(position, velocity, acceleration, force), target=target, flags=flags)

    def run(self, node: str, /, *, deadline_s: float = 0.0, on_progress: OnProgress = no_progress, **ports: Attribute) -> RunResult:
        """Run one node or library tree to its end. Whatever else ends this call (Ctrl-C first of all) stops the robot. Raises: GatewayError."""
        one = self.dialogue.ask("run", "", {"node": node, "deadline_s": deadline_s, **ports}, self._clock(), is_run=True)
        try:
            while not one.is_over:
                self._pump(lambda: bool(one.is_over or one.told), math.inf)
                while one.told:
                    tell_progress(one.told.popleft(), on_progress)
        except GatewayError:
            raise
        except BaseException:
            with contextlib.suppress(GatewayError):
                self.stop()
            raise
        return result_of(one.answer())

    # listening ---------------------------------------------------------------------------------------------------
    def receive(self, timeout_s: float | None = None) -> Element | None:
        """The next message that answers no request; None if none comes in time.

        Raises: GatewayError if the conversation is over, or there is no connection when the time is.
        """
        until_s = self._clock() + (self.timeout_s if timeout_s is None else timeout_s)
        if self.pending or self._pump(lambda: bool(self.pending), until_s):
            return self.pending.popleft()
        if self._line is None:
            raise NoConnectionError("no-connection", f"no connection to {self._place}, and no other came in time")
        return None

    # the line ----------------------------------------------------------------------------------------------------
    def _pump(self, is_over: Callable[[], bool], until_s: float) -> bool:
        """Read, write and reconnect until it is over, or the time is; True if it is over. Raises: the final error of the conversation."""
        dialogue = self.dialogue
        while not is_over():
            if dialogue.final is not None:
                self._hang_up()
                raise dialogue.final
            if self._clock() >= until_s:
                return False
            if self._line is None:
                self._try_again(until_s)
            else:
                self._flush()
                self._read(min(until_s, dialogue.due_s) - self._clock())
            dialogue.tick(self._clock())
            if dialogue.is_dead:
                self._lost("the gateway fell silent")
        return True

    def _flush(self) -> None:
        out = self.dialogue.to_send()
        if not out or self._line is None:
            return
        try:
            self._line.settimeout(self.timeout_s)
            self._line.sendall(out)
        except OSError as error:
            self._lost(f"the connection is gone ({error.strerror or error})")

    def _read(self, for_s: float) -> None:
        if self._line is None:
            return
        try:
            self._line.settimeout(max(for_s, LEAST_WAIT_S))
            data = self._line.recv(READ_BYTES)
        except TimeoutError:
            return
        except OSError as error:
            self._lost(f"the connection is gone ({error.strerror or error})")
            return
        if data:
            self.dialogue.feed(data, self._clock())
        else:
            self._lost("the gateway closed the connection")

    def _lost(self, why: str) -> None:
        self._hang_up()
        self.dialogue.closed(why)
        self._attempt = 0
        if self._backoff is None:
            self.dialogue.end(NoConnectionError("no-connection", why))
        else:
            self._retry_s = self._clock() + self._backoff.delay_s(0)

    def _try_again(self, until_s: float) -> None:
        """One attempt if it is time for it; else wait for that time, but no longer than somebody waits for us."""
        assert self._backoff is not None
        left_s = min(self._retry_s, until_s, self.dialogue.due_s) - self._clock()
        if left_s > 0.0:
            self._wait(left_s)
            return
        try:
            self._open()
        except NoConnectionError:
            self._attempt += 1
            self._retry_s = self._clock() + self._backoff.delay_s(self._attempt)

    def _open(self) -> None:
        try:
            self._line = self._connect(self.timeout_s)
        except OSError as error:
            text = f"no gateway at {self._place}: {error.strerror or error}; is a run with --gateway going on?"
            raise NoConnectionError("no-connection", text) from None
        self.dialogue.opened(self._clock())

    def _dial(self, timeout_s: float) -> Line:
        plain = socket.create_connection(self._address, timeout=timeout_s)
        plain.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return plain if self._tls is None else self._tls.wrap_socket(plain, server_hostname=self._address[0])

    def _hang_up(self) -> None:
        line, self._line = self._line, None
        if line is not None:
            line.close()

    @property
    def _place(self) -> str:
        return f"{self._address[0]}:{self._address[1]}"


def __getattr__(name: str) -> Any:
    """`AsyncClient` is imported when it is asked for: asyncio costs a command of the shell more than its work."""
    if name == "AsyncClient":
        from pluto_bt.gateway.async_client import AsyncClient

        return AsyncClient
    raise AttributeError(name)


__all__ = ["Ask", "AsyncClient", "Backoff", "Client", "Element", "GatewayError", "RunResult"]
