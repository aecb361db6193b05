"""One connection to the gateway: replies are told by their id."""

from __future__ import annotations

import asyncio
import contextlib
from types import TracebackType
from typing import Self
from xml.etree import ElementTree

from pluto_bt.gateway.client import Element, GatewayError
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.shell.ticket import Ticket
from pluto_bt.gateway.xml_text import Attribute, element

NAME = "shell"  # the gateway keeps places for clients of this name
ANSWER_S = 5.0
LINE_BYTES = 16 * 1024 * 1024


class Talk:
    """All messages that carry one id: the reply to a request and what follows it."""

    def __init__(self, link: Link, id: str, tag: str) -> None:
        self._link = link
        self._tag = tag
        self.id = id
        self.heard: asyncio.Queue[Element | None] = asyncio.Queue()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._link.forget(self.id)

    async def next(self, timeout_s: float | None = ANSWER_S) -> Element:
        """The next message. Raises: GatewayError if it is an error, does not come in time, or the connection is gone; TimeoutError never."""
        try:
            async with asyncio.timeout(timeout_s):
                message = await self.heard.get()
        except TimeoutError:
            raise GatewayError("no-answer", f"no answer to <{self._tag}> within {timeout_s:g} s") from None
        if message is None:
            raise self._link.fault
        if message.tag == "error":
            raise GatewayError(message.get("code", "internal"), message.text or "")
        return message


class Link:
    """One connection to the gateway. Made by `Link.open`."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.fault = GatewayError("no-connection", "the gateway closed the connection")
        self.lost = asyncio.Event()
        self._writer = writer
        self._talks: dict[str, Talk] = {}
        self._count = 0
        self._reading = asyncio.create_task(self._read(reader))

    @classmethod
    async def open(cls, address: Address, ticket: Ticket, timeout_s: float = ANSWER_S) -> Link:
        """Connect and say hello. Raises: GatewayError."""
        context = ticket.context()
        try:
            async with asyncio.timeout(timeout_s):
                reader, writer = await asyncio.open_connection(address.host, address.port, limit=LINE_BYTES, ssl=context)
        except (OSError, TimeoutError) as error:
            said = getattr(error, "strerror", None) or str(error) or f"no answer within {timeout_s:g} s"
            raise GatewayError("no-connection", f"no gateway at {address}: {said}; is a run with --gateway going on?") from None
        link = cls(reader, writer)
        try:
            token: dict[str, Attribute] = {"token": ticket.token} if ticket.token else {}
            await link.request("hello", version="1.0", name=NAME, **token)  # type: ignore[arg-type]  # mypy takes them for the timeout
        except BaseException:
            link.close()
            raise
        return link

    def close(self) -> None:
        """Let go; a lease ends by it."""
        self._reading.cancel()
        self._writer.close()
        self._end()

    def ask(self, tag: str, body: str = "", /, **attributes: Attribute) -> Talk:
        """Send one message; what is said to it comes out of the talk. Use it in a `with`. Raises: GatewayError."""
        if self.lost.is_set():
            raise self.fault
        self._count += 1
        talk = Talk(self, f"s{self._count}", tag)
        self._talks[talk.id] = talk
        self._writer.write((element(tag, {"id": talk.id, **attributes}, body) + "\n").encode())
        return talk

    async def request(self, tag: str, body: str = "", /, *, timeout_s: float = ANSWER_S, **attributes: Attribute) -> Element:
        """Send one message and wait for its reply. Raises: GatewayError."""
        with self.ask(tag, body, **attributes) as talk:
            return await talk.next(timeout_s)

    def forget(self, id: str) -> None:
        """What still comes with this id is of no interest."""
        self._talks.pop(id, None)

    async def _read(self, reader: asyncio.StreamReader) -> None:
        with contextlib.suppress(OSError, ValueError, ElementTree.ParseError):  # a gateway that breaks, or speaks nonsense, is gone
            while line := await reader.readline():
                self._take(ElementTree.fromstring(line.decode()))
        self._writer.close()
        self._end()

    def _take(self, message: Element) -> None:
        if message.tag == "error" and message.get("fatal") == "true":
            self.fault = GatewayError(message.get("code", "internal"), message.text or "")
        talk = self._talks.get(message.get("id", ""))
        if talk is not None:
            talk.heard.put_nowait(message)

    def _end(self) -> None:
        self.lost.set()
        for talk in self._talks.values():
            talk.heard.put_nowait(None)
