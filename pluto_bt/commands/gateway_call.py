"""What the commands share that say one thing to a running robot over its gateway."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Final

from pluto_bt.commands.options import Parser

if TYPE_CHECKING:
    from pluto_bt.gateway.backoff import Backoff
    from pluto_bt.gateway.client import Client, Element, GatewayError

HINT: Final = (
    "\n  start a robot with `pluto run MISSION.xml --realtime`"
    "\n  one that says it is compiling kernels opens its gateway when that is done"
)


def gateway_parser(command: str, description: str) -> Parser:
    """A parser that knows `--gateway`."""
    parser = Parser(prog=f"pluto {command}", description=description)
    parser.add_argument("--gateway", metavar="HOST:PORT", default="127.0.0.1:7500")
    return parser


def reach(address: str, *, name: str = "", backoff: Backoff | None = None) -> Client:
    """The robot at the address, shown what PLUTO_TOKEN and PLUTO_CERTIFICATE hold. Raises: GatewayError; InputError for an address that is none."""
    from pluto_bt.gateway.client import Client
    from pluto_bt.gateway.listen import parse_address
    from pluto_bt.gateway.shell.ticket import Ticket

    host, port = parse_address(address)
    ticket = Ticket.of_environment()
    return Client(host, port, name=name, token=ticket.token, tls=ticket.context(), backoff=backoff)


def call(command: str, address: str, tag: str, **attributes: str) -> Element | None:
    """The robot's answer; None if it refused or is not there, which is told. Raises InputError for an address that is none."""
    from pluto_bt.gateway.client import GatewayError

    try:
        with reach(address) as client:
            return client.request(tag, **attributes)
    except GatewayError as error:
        tell_refusal(command, error)
        return None


def tell_refusal(command: str, error: GatewayError) -> None:
    """What the gateway refused; or that it is not there, and what would help."""
    from pluto_bt.gateway.errors import UnheardError
    from pluto_bt.gateway.shell.ticket import Ticket

    is_there = error.code != "no-connection"
    hint = "" if is_there or isinstance(error, UnheardError) else HINT
    print(f"pluto {command}: {error.code + ': ' if is_there else ''}{error}{Ticket.of_environment().advice(error)}{hint}", file=sys.stderr)
