"""`pluto check`: every fault of missions, worlds, maps and platform files, all at once, before anything moves."""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Callable
from pathlib import Path

from pluto_bt.commands.options import Parser
from pluto_bt.source import Fault, Faults, InputError
from pluto_bt.source.text import read_bytes

FORMATS: dict[str, Callable[[list[Fault]], str]] = {
    "text": lambda faults: "\n".join(fault.as_text() for fault in faults),
    "json": lambda faults: json.dumps({"faults": [fault.as_json() for fault in faults]}, ensure_ascii=False),
}


def main(argv: list[str]) -> int:
    """Check files; exit 0 without errors (warnings alone are 0), else 2."""
    args = _parser().parse_args(argv)
    faults = Faults()
    _check_options(args, faults)
    for name in args.files:
        _check(name, args, faults)
    found = list(faults.in_order())
    if found or args.format != "text":
        print(FORMATS[args.format](found))
    if args.format == "text":
        errors = sum(fault.severity == "error" for fault in found)
        print(f"{len(args.files)} checked, {errors} errors, {len(found) - errors} warnings", file=sys.stderr)
    return 2 if faults.has_errors else 0


def _parser() -> Parser:
    parser = Parser(prog="pluto check", description="Find every fault of missions, worlds, maps and platform files.")
    parser.add_argument("files", nargs="+", metavar="FILE")
    parser.add_argument("--format", choices=tuple(FORMATS), default="text")
    parser.add_argument("--world", metavar="W", help="check start and scripts against this world too")
    parser.add_argument("--platform", metavar="P", help="with --world: the robot that starts in it")
    parser.add_argument("--tree", metavar="ID", help="the tree to check, if not the main one")
    parser.add_argument("--port", metavar="NAME=VALUE", action="append", default=[], help="an input of the main tree; may be repeated")
    parser.add_argument("--plugin", metavar="MODULE", action="append", default=[], help="a Python module whose nodes may be used")
    return parser


def _check_options(args: argparse.Namespace, faults: Faults) -> None:
    """The faults of what serves all the files: plugins, and the world and the robot to check against."""
    from pluto_bt.commands.inputs import check_world
    from pluto_bt.commands.plugins import load_plugins

    load_plugins(args.plugin, faults)
    if args.world is not None:
        check_world(args.world, args.platform, faults)


def _check(name: str, args: argparse.Namespace, faults: Faults) -> None:
    """The faults of one file, whatever kind it is of."""
    path = Path(name)
    if path.suffix.lower() == ".toml":
        _check_robot(name, faults)
    elif path.suffix.lower() in (".yaml", ".yml", ".map") or _is_world(path):
        from pluto_bt.commands.inputs import check_world

        check_world(name, args.platform, faults)
    else:
        from pluto_bt.commands.missions import check_mission_file

        check_mission_file(name, args.tree, args.port, faults)


def _check_robot(name: str, faults: Faults) -> None:
    from pluto_bt.modules.robot_file import load_robot_file

    try:
        load_robot_file(name)
    except InputError as error:
        faults.extend(error.faults)


def _is_world(path: Path) -> bool:
    """True if the file's first element is `<world>`; looks at its head only."""
    unread = Faults()  # a file that cannot be read is told by whoever reads it all
    head = (read_bytes(path, str(path), unread) or b"")[:8192]
    first = re.search(rb"<([A-Za-z_][\w.-]*)", re.sub(rb"<!--.*?-->", b"", head, flags=re.S))
    return first is not None and first[1] == b"world"
