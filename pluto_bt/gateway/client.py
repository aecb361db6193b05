"""A small synchronous client: for the shell, for scripts and for tests. Needs a socket and the standard library only."""

from __future__ import annotations

import select
import socket
from collections import deque
from types import TracebackType
from typing import Self
from xml.etree import ElementTree

from pluto_bt.gateway.xml_text import Attribute, element
from pluto_bt.source import PlutoError

Element = ElementTree.Element
READ_BYTES = 64 * 1024


class GatewayError(PlutoError):
    """The gateway refused, or is not there. `code` is the protocol's, or `no-connection`, `no-answer`."""

    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.code = code
        self.text = text


class Client:
    """One connection.

    Replies are told from other messages by their `id`; what is not asked for now (values, events, progress) waits in `pending`.
    """

    def __init__(
        self, host: str = "127.0.0.1", port: int = 7500, *, name: str = "", session: str = "", token: str = "", timeout_s: float = 5.0
    ) -> None:
        """Connect and, if a name, session or token is given, say hello. Raises: GatewayError."""
        self.timeout_s = timeout_s
        self.pending: deque[Element] = deque()
        self._buffer = bytearray()
        self._count = 0
        try:
            self._socket = socket.create_connection((host, port), timeout=timeout_s)
        except OSError as error:
            text = f"no gateway at {host}:{port}: {error.strerror or error}; is a run with --gateway going on?"
            raise GatewayError("no-connection", text) from None
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        given: dict[str, Attribute] = {key: value for key, value in (("name", name), ("session", session), ("token", token)) if value}
        if given:
            self.request("hello", version="1.0", **given)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Let go; a lease ends by it."""
        self._socket.close()

    def fileno(self) -> int:
        """For `select`."""
        return self._socket.fileno()

    # asking ------------------------------------------------------------------------------------------------------
    def send(self, tag: str, body: str = "", /, **attributes: Attribute) -> str:
        """Send one message; the id it was given."""
        self._count += 1
        attributes.setdefault("id", f"c{self._count}")
        self.send_raw((element(tag, attributes, body) + "\n").encode())
        return str(attributes["id"])

    def send_raw(self, data: bytes) -> None:
        """Send bytes as they are. Raises: GatewayError if the connection is gone."""
        try:
            self._socket.sendall(data)
        except OSError as error:
            raise GatewayError("no-connection", f"the connection is gone: {error.strerror or error}") from None

    def request(self, tag: str, body: str = "", /, **attributes: Attribute) -> Element:
        """Send one message and wait for its reply. Raises: GatewayError if it is an error, or does not come in time."""
        id = self.send(tag, body, **attributes)
        kept: list[Element] = []
        try:
            while True:
                message = self.receive(self.timeout_s)
                if message is None:
                    raise GatewayError("no-answer", f"no answer to <{tag}> within {self.timeout_s:g} s")
                if message.get("id") == id:
                    break
                if message.tag == "error" and message.get("fatal") == "true":
                    break
                kept.append(message)
        finally:
            self.pending.extendleft(reversed(kept))
        if message.tag == "error":
            raise GatewayError(message.get("code", "internal"), message.text or "")
        return message

    def subscribe(self, topic: str, max_rate_hz: float = 0.0, on_change: bool = False) -> str:
        """Values from now on, to be had by `receive`; the id they carry."""
        reply = self.request("subscribe", topic=topic, max_rate_hz=max_rate_hz, on_change=on_change)
        return reply.get("id", "")

    def lease(self, op: str = "acquire", **attributes: Attribute) -> Element:
        """`acquire`, `take`, `renew`, `query` or `release` the right to drive."""
        return self.request("lease", op=op, **attributes)

    # listening ---------------------------------------------------------------------------------------------------
    def receive(self, timeout_s: float | None = None) -> Element | None:
        """The next message; None if none comes in time. Raises: GatewayError at the end of the connection."""
        if self.pending:
            return self.pending.popleft()
        while b"\n" not in self._buffer:
            ready, _, _ = select.select([self._socket], [], [], self.timeout_s if timeout_s is None else timeout_s)
            if not ready:
                return None
            try:
                data = self._socket.recv(READ_BYTES)
            except OSError:
                data = b""
            if not data:
                raise GatewayError("no-connection", "the gateway closed the connection")
            self._buffer += data
        line, _, rest = self._buffer.partition(b"\n")
        self._buffer = bytearray(rest)
        return ElementTree.fromstring(line.decode())
