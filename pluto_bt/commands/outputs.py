"""Files that a run will write, checked before it starts: an hour's run must not end with "no such folder"."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from pluto_bt.commands.extras import need
from pluto_bt.source import Faults, Place

INPUT_ENDINGS = (".xml", ".yaml", ".yml", ".map", ".toml", ".py")  # a slip of the hand must not cost a mission


def check_outputs(args: argparse.Namespace, faults: Faults) -> None:
    """A fault for each file that could not be written, and for `--speed` without `--realtime`."""
    check_file(args.plot, "--plot", (".png", ".svg"), faults)
    check_file(args.trace, "--trace", (), faults)
    check_file(args.journal, "--journal", (), faults)
    if args.journal is not None and args.resume is None:
        what, mend = "--journal goes with --resume", "add --resume hold, or drop --journal"
        faults.error(Place(f"--journal {args.journal}"), "bad-option", what, expected="--resume", found="--journal alone", mend=mend)
    check_file(args.record, "--record", (".mcap",), faults)
    if args.record is not None:
        need("record", f"--record {args.record}", faults)
    if not args.realtime and args.speed is not None:
        what, mend = "--speed goes with --realtime; lockstep always runs as fast as it can", "add --realtime, or drop --speed"
        faults.error(Place("--speed"), "bad-option", what, expected="--realtime", found=f"--speed {args.speed} alone", mend=mend)


def check_file(name: str | None, option: str, endings: tuple[str, ...], faults: Faults, *, is_data: bool = False) -> None:
    """A fault if `name` could not be written, or has none of the `endings` (if any is asked for).

    With `is_data` the ending of an input file is allowed: what is written is data of the same form.
    """
    if name is None:
        return
    place, path = Place(f"{option} {name}"), Path(name)
    if endings and path.suffix not in endings:
        what, found = f"{option} does not write this format", path.suffix or name or "nothing"
        faults.error(place, "bad-option", what, expected=" or ".join(endings), found=found)
    elif path.suffix in INPUT_ENDINGS and not is_data:
        faults.error(place, "bad-option", "this is the ending of an input file", expected="FILE.jsonl", found=path.suffix)
    elif os.path.isdir(path):
        faults.error(place, "is-a-folder", f'"{name}" is a folder', expected="a file", found="a folder")
    elif not os.path.isdir(path.parent):
        faults.error(place, "no-such-folder", f"the folder {path.parent} does not exist", expected="a folder", found="nothing", mend="make it first")
    else:
        _try(path, place, faults)


def _try(path: Path, place: Place, faults: Faults) -> None:
    """Whether a file can be written is known for sure only by opening it."""
    is_new = not os.path.lexists(path)
    try:
        with path.open("ab"):
            pass
        if is_new:
            path.unlink()
    except (OSError, ValueError) as error:
        found = str(getattr(error, "strerror", None) or error)
        faults.error(place, "not-writable", f"cannot write {path}", expected="a file that may be written", found=found)
