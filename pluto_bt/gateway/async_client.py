"""The asyncio client: the same conversation as `Client`, with futures in place of waiting."""

from __future__ import annotations

import asyncio
import contextlib
import ssl
from collections import deque
from collections.abc import AsyncIterator, Callable, Sequence
from types import TracebackType
from typing import Self
from xml.etree.ElementTree import Element

from pluto_bt.gateway.ask import Ask
from pluto_bt.gateway.async_keeper import AsyncKeeper, Wait
from pluto_bt.gateway.backoff import AGAIN, Backoff
from pluto_bt.gateway.client import new_ids
from pluto_bt.gateway.dialogue import KEPT, RENEWALS, Dialogue
from pluto_bt.gateway.errors import GatewayError, NoAnswerError, NoConnectionError, error_in
from pluto_bt.gateway.words import OnProgress, RunResult, command_body, hello_of, no_progress, result_of, tell_progress
from pluto_bt.gateway.xml_text import Attribute


class AsyncClient:
    """One client of one gateway, over as many connections as it takes: `async with AsyncClient() as client: …`.

    Calls may be made at the same time from several tasks. What answers no request (values, events) is read by `receive` or `messages`, or
    apart from all else by `stream`.
    """

    def __init__(
        self, host: str = "127.0.0.1", port: int = 7500, *, name: str = "", session: str = "", token: str = "",
        tls: ssl.SSLContext | None = None, timeout_s: float = 5.0, backoff: Backoff | None = AGAIN, wait: Wait = asyncio.sleep,
    ) -> None:  # fmt: skip
        """The arguments are those of `Client`; the connection is made by `async with`, or by `open`."""
        self.timeout_s = timeout_s
        self._has_hello = bool(name or session or token)
        self.dialogue = Dialogue(hello_of(name, session, token), timeout_s, new_ids(session))
        self._keeper = AsyncKeeper(self.dialogue, host, port, tls, backoff, wait)

    async def __aenter__(self) -> Self:
        return await self.open()

    async def __aexit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        await self.close()

    async def open(self) -> Self:
        """Connect and say hello. Raises: GatewayError."""
        try:
            await self._keeper.open()
            until_s = self._keeper.clock() + self.timeout_s
            if self._has_hello and not await self._keeper.until(lambda: self.dialogue.welcome is not None, until_s):
                raise self.dialogue.reason(NoAnswerError("no-answer", f"{self._keeper.place} did not answer <hello> within {self.timeout_s:g} s"))
        except BaseException:
            await self.close()
            raise
        return self

    async def close(self) -> None:
        """Let go; a lease ends by it."""
        self.dialogue.end(NoConnectionError("no-connection", "the client was closed"))
        self._keeper.hang_up()

    @property
    def pending(self) -> deque[Element]:
        """What came and was not asked for."""
        return self.dialogue.inbox

    @property
    def is_connected(self) -> bool:
        """A connection stands, as far as we know."""
        return self._keeper.wire is not None

    # asking ------------------------------------------------------------------------------------------------------
    async def request(self, tag: str, body: str = "", /, **attributes: Attribute) -> Element:
        """Say something and wait for the answer. Raises: GatewayError if it is an error, or does not come in time."""
        one = self._ask(tag, body, attributes)
        try:
            await _changes(one, lambda: one.is_over)
        finally:
            self.dialogue.forget(one)
        return one.answer()

    def tell(self, tag: str, body: str = "", /, **attributes: Attribute) -> None:
        """Say something whose answer is of no interest; harmless if nobody hears it."""
        self._ask(tag, body, attributes)

    async def subscribe(self, topic: str, max_rate_hz: float = 0.0, on_change: bool = False) -> str:
        """Values from now on, to be had by `receive`; the id they carry. A new connection has the same subscriptions."""
        return (await self.request("subscribe", topic=topic, max_rate_hz=max_rate_hz, on_change=on_change)).get("id", "")

    async def stop(self) -> None:
        """Zero velocity at once; needs no lease."""
        await self.request("stop")

    async def lease(self, op: str = "acquire", **attributes: Attribute) -> Element:
        """`acquire`, `take`, `renew`, `query` or `release` the right to drive."""
        return await self.request("lease", op=op, **attributes)

    @contextlib.asynccontextmanager
    async def driving(self, ttl_s: float = 3.0, on_loss: str = "stop", op: str = "acquire", renew_s: float = 0.0) -> AsyncIterator[None]:
        """Hold the lease inside; it is renewed each `renew_s` (0 = thrice in `ttl_s`) as long as the event loop is alive."""
        await self.lease(op, ttl_s=ttl_s, on_loss=on_loss)
        self.dialogue.keep_lease(renew_s or ttl_s / RENEWALS, self._keeper.clock())
        self._keeper.turn()
        try:
            yield
        finally:
            self.dialogue.keep_lease(0.0, 0.0)
            with contextlib.suppress(GatewayError):  # lost, or the connection is gone: then there is nothing to give back
                await self.lease("release")

    async def command(
        self, target: str, flags: int, position: Sequence[float] = (), velocity: Sequence[float] = (),
        acceleration: Sequence[float] = (), force: Sequence[float] = (),
    ) -> None:  # fmt: skip
        """A raw `ActuatorState` into a link of the chain, or to the wrist. Raises: GatewayError."""
        await self.request("command", command_body(position, velocity, acceleration, force), target=target, flags=flags)

    async def run(self, node: str, /, *, deadline_s: float = 0.0, on_progress: OnProgress = no_progress, **ports: Attribute) -> RunResult:
        """Run one node or library tree to its end. Cancelling the task, or whatever else ends this call, stops the robot. Raises: GatewayError.

        `on_progress`: called as on_progress(state, text) while it goes on: "running" or another state, and the node's own words.
        """
        one = self._ask("run", "", {"node": node, "deadline_s": deadline_s, **ports}, is_run=True)
        try:
            while not one.is_over:
                await _changes(one, lambda: bool(one.is_over or one.told))
                while one.told:
                    tell_progress(one.told.popleft(), on_progress)
        except GatewayError:
            raise
        except BaseException:
            self.tell("stop")  # not waited for: the task may be cancelled for good
            raise
        return result_of(one.answer())

    # listening ---------------------------------------------------------------------------------------------------
    async def receive(self, timeout_s: float | None = None) -> Element | None:
        """The next message that answers no request; None if none comes in time.

        Raises: GatewayError if the conversation is over, or there is no connection when the time is.
        """
        until_s = self._keeper.clock() + (self.timeout_s if timeout_s is None else timeout_s)
        if await self._keeper.until(lambda: bool(self.pending), until_s):
            return self.pending.popleft()
        if not self.is_connected:
            raise NoConnectionError("no-connection", f"no connection to {self._keeper.place}, and no other came in time")
        return None

    async def messages(self) -> AsyncIterator[Element]:
        """Everything that answers no request, over all connections, until the conversation is over. Raises: its final GatewayError."""
        while True:
            await self._keeper.until(lambda: bool(self.pending))
            yield self.pending.popleft()

    @contextlib.asynccontextmanager
    async def stream(self, tag: str, body: str = "", /, **attributes: Attribute) -> AsyncIterator[Stream]:
        """What follows the answer to this request, apart from all else: the values of a `subscribe`, as long as the `async with` goes on and
        over all connections; the events of a `log`. One stream a topic. Raises: GatewayError.
        """
        one = self._ask(tag, body, attributes)
        streams, id = self.dialogue.streams, one.id
        streams[id] = deque(maxlen=KEPT)
        try:
            await _changes(one, lambda: one.is_over)
            one.answer()
            yield Stream(streams[id], self._keeper)
        finally:
            if tag == "subscribe":  # what was on its way meanwhile is not for the inbox
                self._ask("unsubscribe", "", {"topic": attributes["topic"]}).when_over(lambda ask: streams.__delitem__(id))
            else:
                del streams[id]

    def _ask(self, tag: str, body: str, attributes: dict[str, Attribute], *, is_run: bool = False) -> Ask:
        one = self.dialogue.ask(tag, body, attributes, self._keeper.clock(), is_run=is_run)
        self._keeper.turn()
        return one


class Stream:
    """Messages that follow the answer to one request, oldest first; a loop over it ends with the conversation, by its final GatewayError.

    Attributes:
        waiting: those that came and were not read yet.
    """

    def __init__(self, waiting: deque[Element], keeper: AsyncKeeper) -> None:
        self.waiting = waiting
        self._keeper = keeper

    async def next(self) -> Element:
        """The next message. Raises: GatewayError if it is an error, or the conversation is over."""
        await self._keeper.until(lambda: bool(self.waiting))
        message = self.waiting.popleft()
        if message.tag == "error":
            raise error_in(message)
        return message

    async def __aiter__(self) -> AsyncIterator[Element]:
        while True:
            yield await self.next()


async def _changes(one: Ask, is_enough: Callable[[], bool]) -> None:
    """Wait until enough has been said to the request."""
    changed = asyncio.Event()
    one.on_change = lambda ask: changed.set()
    while not is_enough():
        changed.clear()
        await changed.wait()
