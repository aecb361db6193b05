"""`pluto check`: every fault of missions, worlds, maps and platform files, all at once, before anything moves."""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from pluto_bt.commands.fault_formats import FORMATS
from pluto_bt.commands.options import Parser
from pluto_bt.files import find_shipped, shipped_names
from pluto_bt.inputs.option_values import Pose, read_start
from pluto_bt.source import Fault, Faults, InputError, Place, did_you_mean
from pluto_bt.source.faults import TOO_MANY
from pluto_bt.source.text import read_bytes

if TYPE_CHECKING:
    from pluto_bt.inputs.legs_in_world import LegTold
    from pluto_bt.maps.world import World
    from pluto_bt.modules.robot_file import RobotFile

ROBOTS = ("atrv2", "car", "jbot", "pioneer")  # as pluto_bt.modules.robot_file knows them, without its imports


def main(argv: list[str]) -> int:
    """Check files; exit 0 without errors (warnings alone are 0), else 2."""
    args = _parser().parse_args(argv)
    faults = Faults()
    start = read_start(args.start, faults)
    world, robot = _check_options(args, start, faults)
    legs: list[LegTold] = []
    for name in args.files:
        legs += _check(name, args, world, robot, start, faults)
    _print(args, faults, legs)
    return 2 if faults.has_errors else 0


def _parser() -> Parser:
    parser = Parser(prog="pluto check", description="Find every fault of missions, worlds, maps and platform files.")
    parser.add_argument("files", nargs="+", metavar="FILE")
    parser.add_argument("--format", choices=tuple(FORMATS), default="text")
    parser.add_argument("--world", metavar="W", help="drive the legs of the missions in thought through this world")
    parser.add_argument("--start", metavar="X,Y,DEG", help="with --world: where the robot starts (default: the world's, else not known)")
    parser.add_argument("--platform", metavar="P", help="the robot that is to run the missions (default: the world's)")
    parser.add_argument("--tree", metavar="ID", help="the tree to check, if not the main one")
    parser.add_argument("--port", metavar="NAME=VALUE", action="append", default=[], help="an input of the main tree; may be repeated")
    parser.add_argument("--model", metavar="FILE", action="append", default=[], help="a file whose TreeNodesModel describes nodes of other systems")
    parser.add_argument("--plugin", metavar="MODULE", action="append", default=[], help="a Python module whose nodes may be used")
    return parser


def _check_options(args: argparse.Namespace, start: Pose | None, faults: Faults) -> tuple[World | None, RobotFile | None]:
    """The faults of what serves all the files: plugins, and the world and the robot to check against."""
    from pluto_bt.inputs.plugins import load_plugins
    from pluto_bt.inputs.reading import check_world, read_robot

    load_plugins(args.plugin, faults)
    if args.world is not None:
        return check_world(args.world, args.platform, faults, start, args.start)
    return None, None if args.platform is None else read_robot(args.platform, faults)


def _check(
    name: str, args: argparse.Namespace, world: World | None, robot: RobotFile | None, start: Pose | None, faults: Faults
) -> list[LegTold]:
    """The faults of one file, whatever kind it is of; the legs of a mission in a world."""
    path = find_shipped(name) if not os.path.lexists(name) else Path(name)
    if Path(name).suffix.lower() == ".toml" or (path is None and name in ROBOTS):
        _check_robot(name, faults)
    elif path is not None and (path.suffix.lower() in (".yaml", ".yml", ".map") or _is_world(path)):
        from pluto_bt.inputs.reading import check_world

        check_world(name, args.platform, faults)
    elif path is None:
        _no_such_file(name, faults)
    else:
        from pluto_bt.inputs.missions import check_mission_file

        examined = check_mission_file(name, args.tree, args.port, args.model, faults)
        if examined is not None and examined.plan is not None and (world is not None or robot is not None):
            from pluto_bt.inputs.mission_in_world import check_on_robot

            return check_on_robot(examined.plan, world, robot, start, faults)
    return []


def _no_such_file(name: str, faults: Faults) -> None:
    known = [*shipped_names(), *ROBOTS]
    what = f'there is no file "{name}", and no shipped mission, world or platform of that name'
    expected, mend = f"a path, or one of: {', '.join(known)}", did_you_mean(Path(name).name, known)
    faults.error(Place(name or 'file ""'), "no-such-file", what, expected=expected, found=name or "nothing", mend=mend)


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
    first = re.search(rb"<([A-Za-z_][\w.-]*)", re.sub(rb"<!--.*?-->", b"", head, flags=re.DOTALL))
    return first is not None and first[1] == b"world"


def _print(args: argparse.Namespace, faults: Faults, legs: list[LegTold]) -> None:
    found = list(dict.fromkeys(faults.in_order()))  # a file that several missions include is told once
    if args.format == "json" and args.world is not None:
        print(json.dumps({"faults": [fault.as_json() for fault in found], "legs": [leg.as_json() for leg in legs]}, ensure_ascii=False))
    elif found or args.format in ("json", "sarif"):
        print(FORMATS[args.format](found))
    if args.format != "text":
        return
    for leg in legs:
        print(leg.as_text())
    if legs:
        from pluto_bt.inputs.legs_in_world import sum_of

        print(sum_of(legs))
    print(f"{len(args.files)} checked, {_count(found, 'error')}, {_count(found, 'warning')}", file=sys.stderr)


def _count(found: list[Fault], severity: str) -> str:
    """How many there are of a severity; "more than" where not all could be told."""
    told = [fault for fault in found if fault.severity == severity and fault.code != TOO_MANY]
    more = "more than " * any(fault.severity == severity and fault.code == TOO_MANY for fault in found)
    return f"{more}{len(told)} {severity}{'s' * (len(told) != 1)}"
