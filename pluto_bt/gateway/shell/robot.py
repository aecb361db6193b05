"""The shell's way to the robot: a connection that is opened when it is needed, and again when it was lost; and a stop that does not depend on it."""

from __future__ import annotations

import asyncio
import contextlib

from pluto_bt.gateway.async_client import AsyncClient
from pluto_bt.gateway.client import Element, GatewayError
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.shell.ticket import UNAUTHORISED, Ticket
from pluto_bt.gateway.xml_text import Attribute

NAME = "shell"  # the gateway keeps places for clients whose name begins so
ANSWER_S = 5.0
STOP_S = 0.5


class Robot:
    """The robot at an address; `name` is what others are told of who commands it."""

    def __init__(self, address: Address, name: str = NAME) -> None:
        self.address = address
        self.name = name
        self._ticket = Ticket.of_environment()
        self._client: AsyncClient | None = None
        self._opening = asyncio.Lock()

    async def client(self) -> AsyncClient:
        """The connection of the commands, opened if there is none. Raises: GatewayError."""
        async with self._opening:
            if self._client is None or not self._client.is_connected:
                self._client = await self.connect()
            return self._client

    async def connect(self) -> AsyncClient:
        """One more connection. A command that loses its own has failed, for what it drove has been stopped. Raises: GatewayError."""
        return await self._connect(self.name, self._ticket.token)

    async def _connect(self, name: str, token: str) -> AsyncClient:
        client = AsyncClient(*self.address, name=name, token=token, tls=self._ticket.context(), timeout_s=ANSWER_S, backoff=None)
        return await client.open()

    async def request(self, tag: str, body: str = "", /, **attributes: Attribute) -> Element:
        """One question, one answer. Raises: GatewayError."""
        return await (await self.client()).request(tag, body, **attributes)

    async def stop(self) -> None:
        """Zero velocity at once: on the connection there is, and if that does not answer soon, on a new one. Raises: GatewayError."""
        if self._client is not None and self._client.is_connected:
            with contextlib.suppress(GatewayError, TimeoutError):
                async with asyncio.timeout(STOP_S):
                    await self._client.stop()
                return
        try:
            fresh = await self.connect()
        except GatewayError as error:
            if error.code != UNAUTHORISED:
                raise
            fresh = await self._connect("", "")  # a stop is for anyone: who need not say who he is, is not asked
        try:
            await fresh.stop()
        finally:
            await fresh.close()

    def advice(self, error: GatewayError) -> str:
        """What the environment lacks, if that is why it came to this error; "" if it is not."""
        return self._ticket.advice(error)

    async def close(self) -> None:
        """Let go; a lease that is held ends, and with it what it drove."""
        if self._client is not None:
            await self._client.close()
