"""A line to the gateway that is kept, by asyncio: what `keeper.py` is to `Client`, this is to `AsyncClient`."""

from __future__ import annotations

import asyncio
import contextlib
import math
import ssl
from collections.abc import Awaitable, Callable
from typing import cast

from pluto_bt.gateway.backoff import STEADY_S, Backoff
from pluto_bt.gateway.dialogue import Dialogue
from pluto_bt.gateway.errors import NoConnectionError
from pluto_bt.gateway.keeper import not_reached

Wait = Callable[[float], Awaitable[None]]


class _Ear(asyncio.Protocol):
    """One connection, as asyncio calls it."""

    def __init__(self, keeper: AsyncKeeper) -> None:
        self._keeper = keeper
        self._wire: asyncio.Transport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._wire = cast(asyncio.Transport, transport)  # uvloop's transports are of no asyncio class
        self._keeper.opened(self._wire)

    def data_received(self, data: bytes) -> None:
        self._keeper.heard(data)

    def connection_lost(self, exc: Exception | None) -> None:
        assert self._wire is not None
        self._keeper.lost(self._wire, exc)


class AsyncKeeper:
    """Keeps the line of one dialogue. `place` is its address for people; `wait` lets seconds pass."""

    def __init__(self, dialogue: Dialogue, host: str, port: int, tls: ssl.SSLContext | None, backoff: Backoff | None, wait: Wait) -> None:
        self.wire: asyncio.Transport | None = None
        self.place = f"{host}:{port}"
        self._dialogue, self._address, self._tls, self._backoff, self._wait = dialogue, (host, port), tls, backoff, wait
        self._attempt, self._opened_s = 0, 0.0
        self._loop: asyncio.AbstractEventLoop
        self._changed = asyncio.Event()
        self._timer: asyncio.TimerHandle | None = None
        self._coming_back: asyncio.Task[None] | None = None

    async def open(self) -> None:
        """The first connection. Raises: NoConnectionError."""
        self._loop = asyncio.get_running_loop()
        await self._dial()

    def hang_up(self) -> None:
        """Let go."""
        if self._timer is not None:
            self._timer.cancel()
        if self._coming_back is not None:
            self._coming_back.cancel()
        wire, self.wire = self.wire, None
        if wire is not None:
            wire.close()
        self._changed.set()

    def clock(self) -> float:
        """Seconds of the event loop."""
        return self._loop.time()

    def turn(self) -> None:
        """After everything that may have changed something: send, look whether it is over, set the timer, wake who waits."""
        dialogue, wire = self._dialogue, self.wire
        if wire is not None:
            if out := dialogue.to_send():
                wire.write(out)
            if dialogue.is_dead:
                wire.abort()
            elif dialogue.final is not None:
                wire.close()
        if self._timer is not None:
            self._timer.cancel()
        due_s = dialogue.due_s
        self._timer = None if due_s == math.inf or dialogue.final else self._loop.call_at(due_s, self._tick)
        self._changed.set()

    async def until(self, is_over: Callable[[], bool], until_s: float = math.inf) -> bool:
        """Wait for what the line brings; False if the time is over. Raises: the final error of the conversation."""
        while not is_over():
            if self._dialogue.final is not None:
                raise self._dialogue.final
            left_s = until_s - self.clock()
            if left_s <= 0.0:
                return False
            self._changed.clear()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._changed.wait(), None if left_s == math.inf else left_s)
        return True

    def _tick(self) -> None:
        self._dialogue.tick(self.clock())
        self.turn()

    # the line ----------------------------------------------------------------------------------------------------
    async def _dial(self) -> None:
        host, port = self._address
        try:
            async with asyncio.timeout(self._dialogue.timeout_s):
                await self._loop.create_connection(lambda: _Ear(self), host, port, ssl=self._tls)
        except OSError as error:  # TimeoutError is one
            said = error.strerror or str(error) or f"no answer within {self._dialogue.timeout_s:g} s"
            raise not_reached(self.place, error, said) from None

    def opened(self, wire: asyncio.Transport) -> None:
        """The line says that it stands."""
        self.wire, self._opened_s = wire, self.clock()
        self._dialogue.opened(self._opened_s)
        self.turn()

    def heard(self, data: bytes) -> None:
        """The line says what it brought."""
        self._dialogue.feed(data, self.clock())
        self.turn()

    def lost(self, wire: asyncio.Transport, error: Exception | None) -> None:
        """The line says that it is gone."""
        if self.wire is not wire:
            return
        self.wire = None
        why = f"the connection is gone ({error})" if error is not None else "the gateway closed the connection"
        self._dialogue.closed(why, is_plain=self._tls is None)
        if self._backoff is None:
            self._dialogue.end(self._dialogue.reason(NoConnectionError("no-connection", why)))
        elif self._dialogue.final is None:
            self._coming_back = self._loop.create_task(self._come_back(self._backoff))
        self.turn()

    async def _come_back(self, backoff: Backoff) -> None:
        if self.clock() - self._opened_s >= STEADY_S:
            self._attempt = 0
        while self.wire is None and self._dialogue.final is None:
            self._attempt += 1
            await self._wait(backoff.delay_s(self._attempt - 1))
            with contextlib.suppress(NoConnectionError):
                await self._dial()
