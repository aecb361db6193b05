"""`pluto tree`: a mission's tree drawn; with statuses that of a black box, or of a running robot."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from pluto_bt.commands.options import Parser
from pluto_bt.source import Faults, Place

if TYPE_CHECKING:
    from pluto_bt.trees.dump import Drawn

FORMATS = ("ascii", "unicode", "dot", "svg", "xhtml", "xml")


def main(argv: list[str]) -> int:
    """Print the tree in the format asked for."""
    args = _parser().parse_args(argv)
    _check(args)
    from pluto_bt.trees.dump import draw, dump

    if args.mission is not None and not _is_box(args.mission):
        from pluto_bt.inputs.missions import load_for_drawing

        print(dump(load_for_drawing(args.mission, args.tree, args.plugin), args.format, statuses=False))
        return 0
    from pluto_bt.commands.gateway_call import tell_refusal
    from pluto_bt.gateway.client import GatewayError

    try:
        root = _of_run(args)
    except GatewayError as error:
        tell_refusal("tree", error)
        return 1
    if root is None:
        print("pluto tree: no tree was ticked yet", file=sys.stderr)
        return 1
    print(draw(root, args.format))
    return 0


def _parser() -> Parser:
    from pluto_bt.commands.tree_now import form_of_terminal

    parser = Parser(prog="pluto tree", description="Show a mission's tree. The format xml opens in Groot2.")
    parser.add_argument("mission", metavar="MISSION.xml|FILE.mcap", nargs="?", help="a black box shows the tree with its statuses")
    parser.add_argument("--tree", metavar="ID", help="the tree to show, if not the main one")
    parser.add_argument("--format", choices=FORMATS, default=form_of_terminal())
    parser.add_argument("--at", metavar="T", help="of a black box: at this time of the run (s); without it the last moment at work")
    parser.add_argument("--gateway", metavar="HOST:PORT", help="in place of a file: the tree of this robot, now")
    parser.add_argument("--plugin", metavar="MODULE", action="append", default=[], help="a Python module whose nodes may be used")
    return parser


def _is_box(name: str) -> bool:
    return name.lower().endswith(".mcap")


def _check(args: argparse.Namespace) -> None:
    """Options that do not go together. Raises: InputError."""
    faults = Faults()
    of_run = args.gateway is not None or (args.mission is not None and _is_box(args.mission))
    if (args.mission is None) == (args.gateway is None):
        faults.error(Place("pluto tree"), "bad-option", "tree takes a file, or --gateway", expected="MISSION.xml, FILE.mcap or --gateway HOST:PORT",
                     found="neither" if args.mission is None else "both")  # fmt: skip
    if args.at is not None and (args.mission is None or not of_run):
        faults.error(Place(f"--at {args.at}"), "bad-option", "--at goes with a black box", expected="FILE.mcap", found=args.mission or "--gateway")
    if of_run and args.format == "xml":
        faults.error(Place("--format xml"), "bad-option", "xml is the form of a mission, not of a run", expected=", ".join(FORMATS[:-1]), found="xml",
                     mend="give the mission file")  # fmt: skip
    if of_run and args.tree is not None:
        faults.error(Place(f"--tree {args.tree}"), "bad-option", "--tree goes with a mission file", expected="MISSION.xml", found="a run")
    faults.raise_errors()


def _of_run(args: argparse.Namespace) -> Drawn | None:
    from pluto_bt.commands.tree_now import last_at_work, of_box, of_gateway

    if args.gateway is not None:
        return of_gateway(args.gateway)
    from pluto_bt.commands.boxes import read_box
    from pluto_bt.inputs.option_values import read_time

    faults = Faults()
    at_s = read_time(args.at, "--at", faults)
    faults.raise_errors()
    box = read_box(args.mission)
    number = last_at_work(box) if at_s is None else box.number_at(at_s)
    return of_box(box, number) if number >= 0 else None
