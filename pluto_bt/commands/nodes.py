"""`pluto nodes`: every node with its ports, generated from the classes."""

from __future__ import annotations

from pluto_bt.commands.options import Parser
from pluto_bt.source import Faults, Place, did_you_mean


def main(argv: list[str]) -> int:
    """Print the palette as a table, or as XML for Groot2."""
    parser = Parser(prog="pluto nodes", description="List every node with its ports.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="only these nodes")
    parser.add_argument("--format", choices=("table", "xml"), default="table")
    parser.add_argument("--builtin", action="store_true", help="with --format xml: the nodes of BehaviorTree.CPP too, which Groot2 knows by itself")
    parser.add_argument("--plugin", metavar="MODULE", action="append", default=[], help="a Python module whose nodes are listed too")
    args = parser.parse_args(argv)
    from pluto_bt.inputs.plugins import load_plugins
    from pluto_bt.trees.dump import nodes_table, nodes_xml
    from pluto_bt.trees.loader.registry import node_types

    faults = Faults()
    load_plugins(args.plugin, faults)
    types = node_types()
    for name in args.names:
        if name not in types:
            what, expected = f'there is no node "{name}"', "a name that `pluto nodes` lists"
            faults.error(Place(name or 'node ""'), "unknown-node", what, expected=expected, found=name or "nothing", mend=did_you_mean(name, types))
    faults.raise_errors()
    shown = {name: types[name] for name in args.names} if args.names else types
    print(nodes_table(shown) if args.format == "table" else nodes_xml(shown, builtin=args.builtin or bool(args.names)))
    return 0
