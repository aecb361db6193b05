"""The shell's way to the robot: a connection that is opened when it is needed, and again when it was lost; and a stop that does not depend on it."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable

from pluto_bt.gateway.client import Element, GatewayError
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.shell.link import Link
from pluto_bt.gateway.shell.ticket import Ticket
from pluto_bt.gateway.xml_text import Attribute

STOP_S = 0.5
PING_S = 20.0


class Robot:
    """The robot at an address. `on_open` is called with each new link, to subscribe anew."""

    def __init__(self, address: Address) -> None:
        self.address = address
        self._ticket = Ticket.of_environment()
        self.on_open: Callable[[Link], None] = lambda link: None
        self._link: Link | None = None
        self._opening = asyncio.Lock()

    async def link(self) -> Link:
        """The connection, opened if there is none. Raises: GatewayError."""
        async with self._opening:
            if self._link is None or self._link.lost.is_set():
                self._link = await Link.open(self.address, self._ticket)
                self.on_open(self._link)
            return self._link

    async def request(self, tag: str, body: str = "", /, **attributes: Attribute) -> Element:
        """One question, one answer. Raises: GatewayError."""
        with (await self.link()).ask(tag, body, **attributes) as talk:
            return await talk.next()

    async def stop(self) -> None:
        """Zero velocity at once: on the connection there is, and if that does not answer soon, on a new one. Raises: GatewayError."""
        link = self._link
        if link is not None and not link.lost.is_set():
            with contextlib.suppress(GatewayError):
                await link.request("stop", timeout_s=STOP_S)
                return
        fresh = await Link.open(self.address, self._ticket)
        try:
            await fresh.request("stop")
        finally:
            fresh.close()

    async def keep(self, retry_s: float = 0.5) -> None:
        """Keep a connection for ever: open it again when it was lost, and never let it fall idle."""
        while True:
            try:
                link = await self.link()
                while not link.lost.is_set():
                    with contextlib.suppress(TimeoutError):
                        async with asyncio.timeout(PING_S):
                            await link.lost.wait()
                    if not link.lost.is_set():
                        await link.request("ping")
            except GatewayError:
                pass
            await asyncio.sleep(retry_s)

    def close(self) -> None:
        """Let go; a lease that is held ends, and with it what it drove."""
        if self._link is not None:
            self._link.close()
