"""`pluto tree`: a mission's tree drawn."""

from __future__ import annotations

import sys

from pluto_bt.commands.options import Parser
from pluto_bt.source import InputError

FORMATS = ("ascii", "unicode", "dot", "svg", "xhtml", "xml")


def main(argv: list[str]) -> int:
    """Print the tree in the format asked for."""
    parser = Parser(prog="pluto tree", description="Show a mission's tree. The format xml opens in Groot2.")
    parser.add_argument("mission", metavar="MISSION.xml")
    parser.add_argument("--tree", metavar="ID", help="the tree to show, if not the main one")
    parser.add_argument("--format", choices=FORMATS, default="unicode" if sys.stdout.encoding.lower().startswith("utf") else "ascii")
    parser.add_argument("--plugin", metavar="MODULE", action="append", default=[], help="a Python module whose nodes may be used")
    args = parser.parse_args(argv)
    from pluto_bt.commands.inputs import Request
    from pluto_bt.commands.missions import load_for_drawing
    from pluto_bt.trees.dump import dump

    try:
        print(dump(load_for_drawing(Request(args.mission, tree=args.tree, plugin=args.plugin)), args.format, statuses=False))
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0
