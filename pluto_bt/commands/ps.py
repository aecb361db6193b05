"""`pluto ps`: the modules of a running robot, asked of its gateway."""

from __future__ import annotations

import json

from pluto_bt.commands.gateway_call import call, gateway_parser

COLUMNS = ("name", "group", "state", "steps", "failures", "overruns", "worst_ms", "text")


def main(argv: list[str]) -> int:
    """Print one line a module."""
    parser = gateway_parser("ps", "Show the modules of a running robot.")
    parser.add_argument("--json", action="store_true", help="one JSON object")
    args = parser.parse_args(argv)
    modules = call("ps", args.gateway, "modules")
    if modules is None:
        return 1
    rows = [dict(row.attrib, text=row.text or "") for row in modules]
    if args.json:
        print(json.dumps({"modules": rows}))
        return 0
    widths = [max(len(column), *(len(str(row.get(column, ""))) for row in rows)) for column in COLUMNS]
    for cells in [list(COLUMNS), *([str(row.get(column, "")) for column in COLUMNS] for row in rows)]:
        print("  ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True)).rstrip())
    return 0
