"""`pluto nodes`: every node with its ports, generated from the classes."""

from __future__ import annotations

from pluto_bt.commands.options import Parser
from pluto_bt.source import Faults


def main(argv: list[str]) -> int:
    """Print the palette as a table, or as XML for Groot2."""
    parser = Parser(prog="pluto nodes", description="List every node with its ports.")
    parser.add_argument("--format", choices=("table", "xml"), default="table")
    parser.add_argument("--builtin", action="store_true", help="with --format xml: the nodes of BehaviorTree.CPP too, which Groot2 knows by itself")
    parser.add_argument("--plugin", metavar="MODULE", action="append", default=[], help="a Python module whose nodes are listed too")
    args = parser.parse_args(argv)
    from pluto_bt.commands.plugins import load_plugins
    from pluto_bt.trees.dump import nodes_table, nodes_xml

    faults = Faults()
    load_plugins(args.plugin, faults)
    faults.raise_errors()
    print(nodes_table() if args.format == "table" else nodes_xml(builtin=args.builtin))
    return 0
