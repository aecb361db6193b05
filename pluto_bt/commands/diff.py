"""`pluto diff A.xml B.xml`: what differs between two missions, in terms of trees, nodes and ports."""

from __future__ import annotations

import sys

from pluto_bt.commands.options import Parser
from pluto_bt.files import find_file
from pluto_bt.source import Faults


def main(argv: list[str]) -> int:
    """Print the differences, includes taken in; exit 0 if there are none, 1 if there are some, 2 for files that cannot be read."""
    parser = Parser(prog="pluto diff", description="Say what differs between two missions, in trees, nodes and ports.")
    parser.add_argument("old", metavar="A.xml")
    parser.add_argument("new", metavar="B.xml")
    args = parser.parse_args(argv)
    from pluto_bt.trees.compare import Comparison
    from pluto_bt.trees.loader.files import MissionFiles

    faults = Faults()
    sides = []
    for name in (args.old, args.new):
        files = MissionFiles(Faults())
        path = find_file("mission", name, faults)
        if path is not None:
            files.read_file(path, name)
            faults.extend(fault for fault in files.faults.in_order() if fault.severity == "error")
        sides.append(files)
    faults.raise_errors()
    changes = Comparison(*sides).changes
    for change in changes:
        print(change.as_text())
    print(f"{len(changes)} difference{'s' * (len(changes) != 1)}" if changes else "no difference", file=sys.stderr)
    return 1 if changes else 0
