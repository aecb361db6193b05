"""Where the gateway listens: the address a person types, and the socket behind it."""

from __future__ import annotations

import ipaddress
import socket
from typing import NamedTuple

from pluto_bt.gateway.access import Access
from pluto_bt.source.faults import InputError, Place, fail

DEFAULT_PORT = 7500
WEB_PORT = 7580
EVERYWHERE = ("0.0.0.0", "::")
BACKLOG = 128
"""Callers who wait to be let in. Whoever calls, shouts and hangs up again and again fills it, and every caller behind him waits for all of that."""
RECEIVED_BYTES = 16 * 1024
"""What the kernel takes of each caller before he is read; by itself it takes up to 6 MB."""
GUARDED = {"--gateway": "the gateway", "--web": "the web console"}
"""Options whose address must be the loopback, unless `access` asks everybody who he is; ssh asks by itself."""


class Address(NamedTuple):
    """Host and port; port 0 = any free one."""

    host: str = "127.0.0.1"
    port: int = DEFAULT_PORT

    @property
    def reachable(self) -> Address:
        """The address to type: who listens on all addresses is called by the name of this machine."""
        return Address(socket.gethostname(), self.port) if self.host in EVERYWHERE else self

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


def parse_address(text: str, option: str = "--gateway", default_port: int = DEFAULT_PORT) -> Address:
    """`HOST:PORT`, `HOST` or `:PORT`, an IPv6 host in brackets. Raises: InputError, told at `option`."""
    text = f":{text}" if text.isdigit() else text  # a port alone
    host, colon, port = text.rpartition(":") if not text.endswith("]") else (text, "", "")
    if not colon:
        host, port = text, str(default_port)
    if not port.isascii() or not port.isdigit() or int(port) > 65535:
        fail(Place(file=option), "bad-address", f'bad address "{text}"', expected="HOST:PORT with a port of 0 to 65535", found=text)
    return Address(host.strip("[]") or "127.0.0.1", int(port))


def open_listener(address: Address, access: Access | None = None, option: str = "--gateway") -> socket.socket:
    """A listening socket. Raises: InputError, told at `option`, if the address does not exist or is in use, or is not the loopback and
    `access` lets anybody in."""
    place = Place(file=option)
    try:
        family, _, _, _, target = socket.getaddrinfo(address.host, address.port, type=socket.SOCK_STREAM)[0]
    except OSError as error:
        fail(place, "bad-address", f'unknown host "{address.host}"', found=str(error), mend="give 127.0.0.1, or an address of this machine")
    is_safe = option not in GUARDED or (access is not None and bool(access.keys and access.certificate))
    if not is_safe and not ipaddress.ip_address(str(target[0]).split("%")[0]).is_loopback:
        expected = "a loopback address, or --gateway-tls CERT.pem,KEY.pem and --gateway-tokens FILE.toml"
        mend = f"give both, or listen on 127.0.0.1:{address.port} and come through ssh: ssh -L {address.port}:127.0.0.1:{address.port} ROBOT"
        fail(place, "not-loopback", f"{GUARDED[option]} does not listen on {address} without TLS and tokens", expected=expected, mend=mend)
    listener = socket.socket(family, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVED_BYTES)
        listener.bind(target)
        listener.listen(BACKLOG)
    except OSError as error:
        listener.close()
        mend = f"stop the other program, or give another port: {option} 127.0.0.1:0 takes any free one"
        fail(place, "address-in-use", f"cannot listen on {address}", found=error.strerror or str(error), mend=mend)
    return listener


def is_free(address: Address) -> bool:
    """True if somebody could listen there now."""
    try:
        open_listener(address).close()
    except InputError:
        return False
    return True
