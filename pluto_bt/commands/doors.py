"""What the command line says of a run's doors: each that cannot be opened is refused before anything is loaded."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from pluto_bt.commands.extras import need
from pluto_bt.source import Faults, InputError, Place

if TYPE_CHECKING:
    from pluto_bt.doors import Doors
    from pluto_bt.gateway.access import Access
    from pluto_bt.gateway.listen import Address
    from pluto_bt.gateway.ssh_link import SshRequest


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


def read_doors(args: argparse.Namespace, faults: Faults) -> Doors:
    """The doors asked for; those with faults stay closed."""
    from pluto_bt.doors import Doors
    from pluto_bt.gateway.access import read_access

    access_faults = Faults()
    access = read_access(args.gateway_tls, args.gateway_tokens, access_faults)
    faults.extend(access_faults.in_order())
    is_known_who = not access_faults.has_errors
    return Doors(
        gateway=_read_gateway(args.gateway, access, faults) if is_known_who else None,
        web=read_web(args.web, faults, access) if is_known_who else None,
        groot=_read_groot(args.groot, faults), ssh=_read_ssh(args.ssh, args.ssh_keys, faults),
        access=access, audit=Path(args.gateway_audit) if args.gateway_audit else None,
    )  # fmt: skip


def _read_gateway(text: str | None, access: Access, faults: Faults) -> Address | None:
    """An asked address that does not exist, is in use or not the loopback is refused."""
    from pluto_bt.gateway.listen import parse_address

    return _free(text, parse_address, "--gateway", access, faults)


def read_web(text: str | None, faults: Faults, access: Access | None = None) -> Address | None:
    """The address of the web console, whether it can be had, and whether its library is there."""
    from pluto_bt.doors import web_address

    if text is not None:
        need("web", "--web", faults)
    return _free(text, web_address, "--web", access, faults)


def _free(text: str | None, parse: Callable[[str], Address], option: str, access: Access | None, faults: Faults) -> Address | None:
    """The address, if one can listen there."""
    if text is None:
        return None
    from pluto_bt.gateway.listen import open_listener

    try:
        address = parse(text)
        open_listener(address, access, option).close()
    except InputError as error:
        faults.extend(error.faults)
        return None
    return address


def _read_groot(text: str | None, faults: Faults) -> Address | None:
    """The address of the monitor, and whether its library is there."""
    if text is None:
        return None
    from pluto_bt.doors import groot_address

    need("groot", "--groot", faults)
    try:
        return groot_address(text)
    except InputError as error:
        faults.extend(error.faults)
        return None


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
