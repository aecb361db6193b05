"""The doors of a run to the outside: gateway, web console, ssh, the monitor of Groot2.

Each that cannot be opened is refused before anything is loaded.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from pluto_bt.commands.extras import need
from pluto_bt.source import Faults, InputError, Place
from pluto_bt.source.faults import fail

if TYPE_CHECKING:
    from pluto_bt.gateway.access import Access
    from pluto_bt.gateway.listen import Address
    from pluto_bt.gateway.ssh_link import SshRequest


class Doors(NamedTuple):
    """Who may come in by the gateway, and where ssh listens (None: nowhere)."""

    access: Access
    ssh: SshRequest | None


def add_door_options(parser: argparse.ArgumentParser) -> None:
    """`--gateway`, `--web`, `--ssh`, `--groot` and what goes with them."""
    parser.add_argument("--gateway", metavar="HOST:PORT", help="serve the TCP/XML gateway (default with --realtime: 127.0.0.1:7500)")
    parser.add_argument("--gateway-tls", metavar="CERT,KEY[,CA]", help="PEM files: serve TLS; with CA, client certificates are accepted too")
    parser.add_argument("--gateway-tokens", metavar="FILE.toml", help="who may come in: a table for each person, with token and scopes")
    parser.add_argument("--gateway-audit", metavar="FILE.jsonl", help="log of every control message (default: in the state folder)")
    parser.add_argument("--web", metavar="HOST:PORT", help="serve the web console, such as 127.0.0.1:7580")
    parser.add_argument("--ssh", metavar="HOST:PORT", help="serve the shell by ssh, for who has a key; such as 127.0.0.1:7522")
    parser.add_argument("--ssh-keys", metavar="FILE", help="with --ssh: the public keys that may come in (default: ~/.ssh/authorized_keys)")
    parser.add_argument("--groot", metavar="[HOST:]PORT", help="serve Groot2's live monitor, read-only (Groot2's own port is 1667)")


def check_doors(args: argparse.Namespace, faults: Faults) -> Doors:
    """The faults of all that was asked for."""
    from pluto_bt.gateway.access import read_access

    access_faults = Faults()
    access = read_access(args.gateway_tls, args.gateway_tokens, access_faults)
    faults.extend(access_faults.in_order())
    if not access_faults.has_errors:
        _check_gateway(args.gateway, access, faults)
        check_web(args.web, faults, access)
    _check_groot(args.groot, faults)
    return Doors(access, _read_ssh(args.ssh, args.ssh_keys, faults))


def _check_gateway(address: str | None, access: Access, faults: Faults) -> None:
    """An asked address that does not exist, is in use or not the loopback is refused before anything is loaded."""
    if address is None:
        return
    from pluto_bt.gateway.listen import open_listener, parse_address

    try:
        open_listener(parse_address(address), access).close()
    except InputError as error:
        faults.extend(error.faults)


def web_address(text: str) -> Address:
    """`--web HOST:PORT`. Raises: InputError."""
    from pluto_bt.gateway.listen import WEB_PORT, parse_address

    return parse_address(text, "--web", WEB_PORT)


def check_web(text: str | None, faults: Faults, access: Access | None = None) -> None:
    """The address of the web console, whether it can be had, and whether its library is there."""
    if text is None:
        return
    need("web", "--web", faults)
    from pluto_bt.gateway.listen import open_listener

    try:
        open_listener(web_address(text), access, "--web").close()
    except InputError as error:
        faults.extend(error.faults)


def groot_address(text: str) -> Address:
    """`--groot [HOST:]PORT`, on the loopback: 127.0.0.1 without a host, 1667 without a port. Raises: InputError."""
    from pluto_bt.gateway.listen import Address, parse_address

    place = Place("--groot")
    text = text if ":" in text or text.isdigit() else f"{text}:1667"
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


def _check_groot(text: str | None, faults: Faults) -> None:
    """The address of the monitor, and whether its library is there."""
    if text is None:
        return
    need("groot", "--groot", faults)
    try:
        groot_address(text)
    except InputError as error:
        faults.extend(error.faults)


def _read_ssh(text: str | None, keys: str | None, faults: Faults) -> SshRequest | None:
    """`--ssh HOST:PORT` with `--ssh-keys FILE`: the address, the library and the keys; None with a fault."""
    if text is None:
        if keys is not None:
            what, mend = "--ssh-keys goes with --ssh", "add --ssh HOST:PORT, or drop --ssh-keys"
            faults.error(Place(f"--ssh-keys {keys}"), "bad-option", what, expected="--ssh", found="--ssh-keys alone", mend=mend)
        return None
    from pluto_bt.gateway.listen import open_listener, parse_address
    from pluto_bt.gateway.ssh_link import DEFAULT_PORT, SshRequest

    if not need("shell", "--ssh", faults):
        return None
    from pluto_bt.gateway.ssh_keys import check_keys, default_keys

    path = default_keys() if keys is None else Path(keys).expanduser()
    check_keys(path, faults)
    try:
        address = parse_address(text, "--ssh", DEFAULT_PORT)
        open_listener(address, option="--ssh").close()
    except InputError as error:
        faults.extend(error.faults)
        return None
    return SshRequest(address, path.absolute())
