"""What `AsyncClient` needs of asyncio: the ear on a connection, and waiting for an answer."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Protocol, cast

from pluto_bt.gateway.ask import Ask


class Listener(Protocol):
    """Who is told what happens on a connection."""

    def opened(self, wire: asyncio.Transport) -> None:
        """It stands."""

    def heard(self, data: bytes) -> None:
        """It brought this."""

    def lost(self, wire: asyncio.Transport, error: Exception | None) -> None:
        """It is gone."""


class Ear(asyncio.Protocol):
    """One connection, as asyncio calls it."""

    def __init__(self, listener: Listener) -> None:
        self._listener = listener
        self._wire: asyncio.Transport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._wire = cast(asyncio.Transport, transport)  # uvloop's transports are of no asyncio class
        self._listener.opened(self._wire)

    def data_received(self, data: bytes) -> None:
        self._listener.heard(data)

    def connection_lost(self, exc: Exception | None) -> None:
        assert self._wire is not None
        self._listener.lost(self._wire, exc)


async def changes(one: Ask, is_enough: Callable[[], bool]) -> None:
    """Wait until enough has been said to the request."""
    changed = asyncio.Event()
    one.on_change = lambda ask: changed.set()
    while not is_enough():
        changed.clear()
        await changed.wait()
