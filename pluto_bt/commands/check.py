"""`pluto check`: every fault of missions, worlds, maps and platform files, all at once, before anything moves."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

from pluto_bt.commands.options import Parser
from pluto_bt.source import Fault, Faults, InputError

FORMATS: dict[str, Callable[[list[Fault]], str]] = {
    "text": lambda faults: "\n".join(fault.as_text() for fault in faults),
    "json": lambda faults: json.dumps({"faults": [fault.as_json() for fault in faults]}, ensure_ascii=False),
}


def main(argv: list[str]) -> int:
    """Check files; exit 0 without errors (warnings alone are 0), else 2."""
    args = _parser().parse_args(argv)
    faults = Faults()
    for name in args.files:
        try:
            faults.extend(_check(name, args))
        except InputError as error:
            faults.extend(error.faults)
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


def _check(name: str, args: object) -> tuple[Fault, ...]:
    """The faults of one file, whatever kind it is of."""
    from pluto_bt.commands.inputs import Request, check_world

    path = Path(name)
    if path.suffix == ".toml":
        from pluto_bt.modules.robot_file import load_robot_file

        load_robot_file(name)
        return ()
    if path.suffix in (".yaml", ".yml", ".map") or _is_world(path):
        check_world(name, getattr(args, "platform", None))
        return ()
    from pluto_bt.commands.missions import check_mission_file

    world = getattr(args, "world", None)
    if world is not None:
        check_world(world, getattr(args, "platform", None))
    request = Request(name, tree=getattr(args, "tree", None), port=getattr(args, "port", ()), plugin=getattr(args, "plugin", ()))
    return check_mission_file(request)


def _is_world(path: Path) -> bool:
    """True if the file's first element is `<world>`; looks at its head only."""
    try:
        with path.open("rb") as file:
            head = file.read(8192)
    except OSError:
        return False
    import re

    first = re.search(rb"<([A-Za-z_][\w.-]*)", re.sub(rb"<!--.*?-->", b"", head, flags=re.S))
    return first is not None and first[1] == b"world"
