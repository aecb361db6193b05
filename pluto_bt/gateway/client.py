"""The synchronous client: for scripts, for the proxies, for tests. Needs a socket and the standard library only.

It reads, writes, renews its lease and reconnects inside its calls and nowhere else: no thread. So a program that hangs does not go on
holding the robot; its lease runs out.
"""

from __future__ import annotations

import contextlib
import math
import ssl
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self
from xml.etree import ElementTree

from pluto_bt.gateway.ask import Ask
from pluto_bt.gateway.backoff import AGAIN, Backoff
from pluto_bt.gateway.dialogue import RENEWALS, Dialogue
from pluto_bt.gateway.errors import GatewayError, NoAnswerError, NoConnectionError
from pluto_bt.gateway.keeper import Keeper, Line, dialer, now_s, wait_s
from pluto_bt.gateway.words import OnProgress, RunResult, command_body, hello_of, no_progress, result_of, tell_progress
from pluto_bt.gateway.xml_text import Attribute
from pluto_bt.runtime.clock import calendar_ns

if TYPE_CHECKING:
    from pluto_bt.gateway.async_client import AsyncClient as AsyncClient

Element = ElementTree.Element


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
        self.dialogue = Dialogue(hello_of(name, session, token), timeout_s, new_ids(session))
        self._keeper = Keeper(self.dialogue, f"{host}:{port}", backoff, connect or dialer(host, port, tls), clock, wait, is_plain=tls is None)
        self._keeper.open()
        if (name or session or token) and not self._keeper.pump(lambda: self.dialogue.welcome is not None, self._keeper.clock() + timeout_s):
            self.close()
            raise self.dialogue.reason(NoAnswerError("no-answer", f"{self._keeper.place} did not answer <hello> within {timeout_s:g} s"))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Let go; a lease ends by it."""
        self.dialogue.end(NoConnectionError("no-connection", "the client was closed"))
        self._keeper.hang_up()

    def fileno(self) -> int:
        """For `select`; -1 while there is no connection."""
        return -1 if self._keeper.line is None else self._keeper.line.fileno()

    def now_s(self) -> float:
        """Seconds of the client's clock."""
        return self._keeper.clock()

    @property
    def pending(self) -> deque[Element]:
        """What came and was not asked for."""
        return self.dialogue.inbox

    @property
    def is_connected(self) -> bool:
        """A connection stands, as far as we know."""
        return self._keeper.line is not None

    # asking ------------------------------------------------------------------------------------------------------
    def send(self, tag: str, body: str = "", /, **attributes: Attribute) -> str:
        """Say one thing whose answer, an error also, is read by `receive`; its id. Raises: GatewayError if there is no connection."""
        self._keeper.require_line()
        id = self.dialogue.say_once(tag, body, attributes)
        self._keeper.flush()
        return id

    def send_raw(self, data: bytes) -> None:
        """Send bytes as they are; what is said to them comes by `receive`. Raises: GatewayError if there is no connection."""
        self._keeper.require_line()
        self.dialogue.say(data)
        self._keeper.flush()

    def request(self, tag: str, body: str = "", /, **attributes: Attribute) -> Element:
        """Say something and wait for the answer. Raises: GatewayError if it is an error, or does not come in time."""
        one = self.dialogue.ask(tag, body, attributes, self._keeper.clock())
        self._keeper.pump(lambda: one.is_over, math.inf)
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
        self.dialogue.keep_lease(ttl_s / RENEWALS, self._keeper.clock())
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
        """Run one node or library tree to its end. Whatever else ends this call (Ctrl-C first of all) stops the robot. Raises: GatewayError.

        `on_progress`: called as on_progress(state, text) while it goes on: "running" or another state, and the node's own words.
        """
        one = self.dialogue.ask("run", "", {"node": node, "deadline_s": deadline_s, **ports}, self._keeper.clock(), is_run=True)
        try:
            while not one.is_over:
                self._keeper.pump(lambda: bool(one.is_over or one.told), math.inf)
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
        until_s = self._keeper.clock() + (self.timeout_s if timeout_s is None else timeout_s)
        if self.pending or self._keeper.pump(lambda: bool(self.pending), until_s):
            return self.pending.popleft()
        if self._keeper.line is None:
            raise NoConnectionError("no-connection", f"no connection to {self._keeper.place}, and no other came in time")
        return None


def __getattr__(name: str) -> Any:
    """`AsyncClient` is imported when it is asked for: asyncio costs a command of the shell more than its work."""
    if name == "AsyncClient":
        from pluto_bt.gateway.async_client import AsyncClient

        return AsyncClient
    raise AttributeError(name)


__all__ = ["Ask", "AsyncClient", "Backoff", "Client", "Element", "GatewayError", "RunResult"]
