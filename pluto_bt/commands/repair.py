"""`pluto repair FILE`: makes a black box whole that was cut short by a crash, or damaged."""

from __future__ import annotations

import sys
from pathlib import Path

from pluto_bt.commands.options import Parser


def main(argv: list[str]) -> int:
    """Write what can be read, with an index, so that every MCAP tool opens it."""
    parser = Parser(prog="pluto repair", description="Make a black box whole that was cut short by a crash, or damaged.")
    parser.add_argument("file", metavar="FILE.mcap")
    parser.add_argument("--output", metavar="FILE.mcap", help="write here instead of in place")
    args = parser.parse_args(argv)
    from pluto_bt.commands.boxes import read_mcap
    from pluto_bt.commands.outputs import check_output
    from pluto_bt.record.repair import kept_as, repair

    check_output(args.output, (".mcap",))
    file = read_mcap(args.file)
    to = Path(args.output or args.file)
    readable = sum(1 for _ in file.lines())  # reads it all, so that it is known whether it is whole
    if not readable and not file.is_whole:
        print(f"pluto repair: {args.file} holds no message that could be saved; it is left as it is", file=sys.stderr)
        return 1
    if file.is_whole and args.output is None:
        print(f"{args.file} is whole already")
        return 0
    kept = kept_as(to) if file.is_damaged and args.output is None else None
    try:
        saved = repair(file, to)
    except OSError as error:
        print(f"pluto repair: cannot write {to}: {error.strerror or error}", file=sys.stderr)
        return 2
    lost = "" if not file.is_damaged else ", what was damaged is lost" + (f"; the file as it was: {kept}" if kept is not None else "")
    print(f"{to}: {saved} messages saved{lost}")
    return 0
