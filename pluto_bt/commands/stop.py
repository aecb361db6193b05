"""`pluto stop`: zero velocity at once, for anyone, at any time."""

from __future__ import annotations

from pluto_bt.commands.gateway_call import call, gateway_parser


def main(argv: list[str]) -> int:
    """Stop the robot; 0 once it has taken the stop."""
    args = gateway_parser("stop", "Stop a running robot at once; its mission pauses.").parse_args(argv)
    if call("stop", args.gateway, "stop") is None:
        return 1
    print("stopped")
    return 0
