"""`pluto module start|stop NAME`: one module of a running robot."""

from __future__ import annotations

from pluto_bt.commands.gateway_call import call, gateway_parser

DONE = {"start": "started", "stop": "stopped"}


def main(argv: list[str]) -> int:
    """Start or stop a module; starting one that runs is harmless."""
    parser = gateway_parser("module", "Start or stop one module of a running robot; `pluto ps` lists them.")
    parser.add_argument("op", choices=tuple(DONE))
    parser.add_argument("name", metavar="NAME")
    args = parser.parse_args(argv)
    if call("module", args.gateway, "module", name=args.name, op=args.op) is None:
        return 1
    print(f"{args.name} {DONE[args.op]}")
    return 0
