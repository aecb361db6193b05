"""`pluto tree`: a mission's tree drawn."""

from __future__ import annotations

import sys

from pluto_bt.commands.options import Parser

FORMATS = ("ascii", "unicode", "dot", "svg", "xhtml", "xml")


def main(argv: list[str]) -> int:
    """Print the tree in the format asked for."""
    parser = Parser(prog="pluto tree", description="Show a mission's tree. The format xml opens in Groot2.")
    parser.add_argument("mission", metavar="MISSION.xml")
    parser.add_argument("--tree", metavar="ID", help="the tree to show, if not the main one")
    parser.add_argument("--format", choices=FORMATS, default=_format_of_terminal())
    parser.add_argument("--plugin", metavar="MODULE", action="append", default=[], help="a Python module whose nodes may be used")
    args = parser.parse_args(argv)
    from pluto_bt.commands.missions import load_for_drawing
    from pluto_bt.trees.dump import dump

    print(dump(load_for_drawing(args.mission, args.tree, args.plugin), args.format, statuses=False))
    return 0


def _format_of_terminal() -> str:
    encoding = getattr(sys.stdout, "encoding", None) or "ascii"
    return "unicode" if encoding.lower().startswith("utf") else "ascii"
