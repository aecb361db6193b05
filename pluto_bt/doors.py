"""The doors of a run to the outside: gateway, web console, ssh, the monitor of Groot2."""

from __future__ import annotations

import secrets
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from pluto_bt.gateway.access import Access
from pluto_bt.gateway.audit import default_path
from pluto_bt.gateway.listen import WEB_PORT, Address, is_free, parse_address
from pluto_bt.gateway.ssh_link import SshRequest
from pluto_bt.source import InputError, Place
from pluto_bt.source.faults import fail

GROOT_PORT: Final = 1667  # Groot2's own


@dataclass(frozen=True)
class Doors:
    """Where each listens; None: closed.

    Attributes:
        access: who may come in by gateway and web console.
        audit: the log of every control message.
        is_gateway_asked: False if the gateway is open only because the run is in real time: its port in use is then no fault.
    """

    gateway: Address | None = None
    web: Address | None = None
    groot: Address | None = None
    ssh: SshRequest | None = None
    access: Access | None = None
    audit: Path | None = None
    is_gateway_asked: bool = True

    @classmethod
    def at(cls, *, gateway: str | None = None, web: str | None = None, groot: str | None = None) -> Doors:
        """By addresses in words, "HOST:PORT". Raises: InputError."""
        return cls(
            gateway=None if gateway is None else parse_address(gateway),
            web=None if web is None else web_address(web),
            groot=None if groot is None else groot_address(groot),
        )

    @property
    def take_orders(self) -> bool:
        """True if people or programs can command through one of them."""
        return self.gateway is not None or self.web is not None

    def opened(self, *, realtime: bool) -> Doors:
        """As they stand in a run: in real time there is always a gateway; who comes by ssh talks through it, wherever it listens."""
        doors = replace(self, audit=self.audit or default_path())
        if self.gateway is None and self.ssh is not None and not (realtime and is_free(Address())):
            doors = replace(doors, gateway=Address(port=0))
        elif self.gateway is None and realtime:
            doors = replace(doors, gateway=Address(), is_gateway_asked=False)
        return doors._with_key_for_ssh()

    def _with_key_for_ssh(self) -> Doors:
        """The process behind ssh is a client of the gateway like any other: it needs the certificate, and a token where the gateway asks for one."""
        if self.ssh is None or self.access is None:
            return self
        token = secrets.token_hex(16) if self.access.keys else ""
        access = self.access.with_token("", token) if token else self.access
        return replace(self, ssh=self.ssh._replace(token=token, certificate=access.certificate), access=access)


CLOSED: Final = Doors()


def web_address(text: str) -> Address:
    """`--web HOST:PORT`. Raises: InputError."""
    return parse_address(text, "--web", WEB_PORT)


def groot_address(text: str) -> Address:
    """`--groot [HOST:]PORT`, on the loopback: 127.0.0.1 without a host, 1667 without a port. Raises: InputError."""
    place = Place("--groot")
    text = text if ":" in text or text.isdigit() else f"{text}:{GROOT_PORT}"
    try:
        address = parse_address(text)
    except InputError:
        fail(place, "bad-address", f'bad address "{text}"', expected="[HOST:]PORT with a port of 0 to 65534", found=text)
    if address.host not in ("127.0.0.1", "localhost"):
        mend = f"listen on 127.0.0.1:{address.port} and reach it through ssh: ssh -L {address.port}:127.0.0.1:{address.port} ROBOT"
        fail(place, "not-loopback", f"the monitor does not listen on {address.host}", expected="127.0.0.1 or localhost", found=text, mend=mend)
    if address.port == 65535:
        fail(place, "bad-address", "the monitor needs the port after this one too", expected="a port of 0 to 65534", found=text)
    return Address("127.0.0.1", address.port)
