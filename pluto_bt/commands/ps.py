"""`pluto ps`: the modules of a running robot, asked of its gateway."""

from __future__ import annotations

import json
import sys

from pluto_bt.commands.options import Parser
from pluto_bt.source import PlutoError

COLUMNS = ("name", "group", "state", "steps", "failures", "overruns", "worst_ms", "text")


def main(argv: list[str]) -> int:
    """Print one line a module."""
    parser = Parser(prog="pluto ps", description="Show the modules of a running robot.")
    parser.add_argument("--gateway", metavar="HOST:PORT", default="127.0.0.1:7500")
    parser.add_argument("--json", action="store_true", help="one JSON object")
    args = parser.parse_args(argv)
    from pluto_bt.gateway.client import Client, GatewayError
    from pluto_bt.gateway.listen import parse_address

    try:
        with Client(*parse_address(args.gateway)) as client:
            rows = [dict(row.attrib, text=row.text or "") for row in client.request("modules")]
    except PlutoError as error:
        print(f"pluto ps: {error}\n  start a robot with `pluto run MISSION.xml --realtime`", file=sys.stderr)
        return 1 if isinstance(error, GatewayError) else 2
    if args.json:
        print(json.dumps({"modules": rows}))
        return 0
    widths = [max(len(column), *(len(str(row.get(column, ""))) for row in rows)) for column in COLUMNS]
    for cells in [list(COLUMNS), *([str(row.get(column, "")) for column in COLUMNS] for row in rows)]:
        print("  ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True)).rstrip())
    return 0
