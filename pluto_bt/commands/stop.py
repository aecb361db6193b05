"""`pluto stop`: zero velocity at once, for anyone, at any time."""

from __future__ import annotations

from pluto_bt.commands.gateway_call import gateway_parser, tell_refusal


def main(argv: list[str]) -> int:
    """Stop the robot; 0 once it has taken the stop."""
    args = gateway_parser("stop", "Stop a running robot at once; its mission pauses.").parse_args(argv)
    from pluto_bt.gateway.client import GatewayError
    from pluto_bt.gateway.listen import parse_address
    from pluto_bt.gateway.shell.ticket import Ticket, stop

    address = parse_address(args.gateway)
    try:
        stop(address, Ticket.of_environment())
    except GatewayError as error:
        tell_refusal("stop", error)
        return 1
    print("stopped")
    return 0
