"""The asyncio client: the same conversation as `Client`, with futures in place of waiting."""

from __future__ import annotations

import asyncio
import contextlib
import math
import ssl
from collections import deque
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from types import TracebackType
from typing import Self
from xml.etree.ElementTree import Element

from pluto_bt.gateway.ask import Ask
from pluto_bt.gateway.async_line import Ear, changes
from pluto_bt.gateway.backoff import AGAIN, STEADY_S, Backoff
from pluto_bt.gateway.client import new_ids
from pluto_bt.gateway.dialogue import Dialogue
from pluto_bt.gateway.errors import GatewayError, NoAnswerError, NoConnectionError
from pluto_bt.gateway.words import OnProgress, RunResult, command_body, hello_of, no_progress, result_of, tell_progress
from pluto_bt.gateway.xml_text import Attribute

Wait = Callable[[float], Awaitable[None]]


class AsyncClient:
    """One client of one gateway, over as many connections as it takes: `async with AsyncClient() as client: …`.

    Calls may be made at the same time from several tasks. What answers no request (values, events) is read by `receive` or `messages`.
    """

    def __init__(
        self, host: str = "127.0.0.1", port: int = 7500, *, name: str = "", session: str = "", token: str = "",
        tls: ssl.SSLContext | None = None, timeout_s: float = 5.0, backoff: Backoff | None = AGAIN, wait: Wait = asyncio.sleep,
    ) -> None:  # fmt: skip
        """The arguments are those of `Client`; the connection is made by `async with`."""
        self.timeout_s = timeout_s
        self._address, self._tls, self._backoff, self._wait = (host, port), tls, backoff, wait
        self._has_hello = bool(name or session or token)
        self.dialogue = Dialogue(hello_of(name, session, token), timeout_s, new_ids(session))
        self._wire: asyncio.Transport | None = None
        self._attempt, self._opened_s = 0, 0.0
        self._heard = asyncio.Event()
        self._timer: asyncio.TimerHandle | None = None
        self._coming_back: asyncio.Task[None] | None = None

    async def __aenter__(self) -> Self:
        """Connect and say hello. Raises: GatewayError."""
        self._loop = asyncio.get_running_loop()
        await self._open()
        until_s = self._loop.time() + self.timeout_s
        if self._has_hello and not await self._until(lambda: self.dialogue.welcome is not None, until_s):
            await self.close()
            raise self.dialogue.reason(NoAnswerError("no-answer", f"{self._place} did not answer <hello> within {self.timeout_s:g} s"))
        return self

    async def __aexit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        await self.close()

    async def close(self) -> None:
        """Let go; a lease ends by it."""
        self.dialogue.end(NoConnectionError("no-connection", "the client was closed"))
        if self._timer is not None:
            self._timer.cancel()
        if self._coming_back is not None:
            self._coming_back.cancel()
        wire, self._wire = self._wire, None
        if wire is not None:
            wire.close()
        self._heard.set()

    @property
    def pending(self) -> deque[Element]:
        """What came and was not asked for."""
        return self.dialogue.inbox

    @property
    def is_connected(self) -> bool:
        """A connection stands, as far as we know."""
        return self._wire is not None

    # asking ------------------------------------------------------------------------------------------------------
    async def request(self, tag: str, body: str = "", /, **attributes: Attribute) -> Element:
        """Say something and wait for the answer. Raises: GatewayError if it is an error, or does not come in time."""
        one = self._ask(tag, body, attributes)
        await changes(one, lambda: one.is_over)
        return one.answer()

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
    async def driving(self, ttl_s: float = 3.0, on_loss: str = "stop", op: str = "acquire") -> AsyncIterator[None]:
        """Hold the lease inside; it is renewed as long as the event loop is alive."""
        await self.lease(op, ttl_s=ttl_s, on_loss=on_loss)
        self.dialogue.keep_lease(ttl_s, self._loop.time())
        self._arm()
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
        """Run one node or library tree to its end. Cancelling the task, or whatever else ends this call, stops the robot. Raises: GatewayError."""
        one = self._ask("run", "", {"node": node, "deadline_s": deadline_s, **ports}, is_run=True)
        try:
            while not one.is_over:
                await changes(one, lambda: bool(one.is_over or one.told))
                while one.told:
                    tell_progress(one.told.popleft(), on_progress)
        except GatewayError:
            raise
        except BaseException:
            self._ask("stop", "", {})  # said, not waited for: the task may be cancelled for good
            raise
        return result_of(one.answer())

    # listening ---------------------------------------------------------------------------------------------------
    async def receive(self, timeout_s: float | None = None) -> Element | None:
        """The next message that answers no request; None if none comes in time.

        Raises: GatewayError if the conversation is over, or there is no connection when the time is.
        """
        until_s = self._loop.time() + (self.timeout_s if timeout_s is None else timeout_s)
        if await self._until(lambda: bool(self.pending), until_s):
            return self.pending.popleft()
        if self._wire is None:
            raise NoConnectionError("no-connection", f"no connection to {self._place}, and no other came in time")
        return None

    async def messages(self) -> AsyncIterator[Element]:
        """Everything that answers no request, over all connections, until the conversation is over. Raises: its final GatewayError."""
        while True:
            await self._until(lambda: bool(self.pending), math.inf)
            yield self.pending.popleft()

    # the line ----------------------------------------------------------------------------------------------------
    def _ask(self, tag: str, body: str, attributes: dict[str, Attribute], *, is_run: bool = False) -> Ask:
        one = self.dialogue.ask(tag, body, attributes, self._loop.time(), is_run=is_run)
        self._turn()
        return one

    async def _until(self, is_over: Callable[[], bool], until_s: float) -> bool:
        """Wait for what the line brings; False if the time is over. Raises: the final error of the conversation."""
        while not is_over():
            if self.dialogue.final is not None:
                raise self.dialogue.final
            left_s = until_s - self._loop.time()
            if left_s <= 0.0:
                return False
            self._heard.clear()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._heard.wait(), None if left_s == math.inf else left_s)
        return True

    def _turn(self) -> None:
        """After everything that may have changed something: send, look whether it is over, set the timer, wake who waits."""
        dialogue, wire = self.dialogue, self._wire
        if wire is not None:
            if out := dialogue.to_send():
                wire.write(out)
            if dialogue.is_dead:
                wire.abort()
            elif dialogue.final is not None:
                wire.close()
        self._arm()
        self._heard.set()

    def _arm(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
        due_s = self.dialogue.due_s
        self._timer = None if due_s == math.inf or self.dialogue.final else self._loop.call_at(due_s, self._tick)

    def _tick(self) -> None:
        self.dialogue.tick(self._loop.time())
        self._turn()

    async def _open(self) -> None:
        """One attempt. Raises: NoConnectionError."""
        host, port = self._address
        try:
            async with asyncio.timeout(self.timeout_s):
                await self._loop.create_connection(lambda: Ear(self), host, port, ssl=self._tls)
        except OSError as error:  # TimeoutError is one
            text = f"no gateway at {self._place}: {error.strerror or error}; is a run with --gateway going on?"
            raise NoConnectionError("no-connection", text) from None

    def opened(self, wire: asyncio.Transport) -> None:
        """The line says that it stands."""
        self._wire, self._opened_s = wire, self._loop.time()
        self.dialogue.opened(self._opened_s)
        self._turn()

    def heard(self, data: bytes) -> None:
        """The line says what it brought."""
        self.dialogue.feed(data, self._loop.time())
        self._turn()

    def lost(self, wire: asyncio.Transport, error: Exception | None) -> None:
        """The line says that it is gone."""
        if self._wire is not wire:
            return
        self._wire = None
        why = f"the connection is gone ({error})" if error is not None else "the gateway closed the connection"
        self.dialogue.closed(why)
        if self._backoff is None:
            self.dialogue.end(self.dialogue.reason(NoConnectionError("no-connection", why)))
        elif self.dialogue.final is None:
            self._coming_back = self._loop.create_task(self._come_back(self._backoff))
        self._turn()

    async def _come_back(self, backoff: Backoff) -> None:
        if self._loop.time() - self._opened_s >= STEADY_S:
            self._attempt = 0
        while self._wire is None and self.dialogue.final is None:
            self._attempt += 1
            await self._wait(backoff.delay_s(self._attempt - 1))
            with contextlib.suppress(NoConnectionError):
                await self._open()

    @property
    def _place(self) -> str:
        return f"{self._address[0]}:{self._address[1]}"
