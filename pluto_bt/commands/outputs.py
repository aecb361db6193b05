"""Files that a run will write, checked before it starts: an hour's run must not end with "no such folder"."""

from __future__ import annotations

import argparse
from pathlib import Path

from pluto_bt.source import Faults, Place


def check_outputs(args: argparse.Namespace) -> None:
    """Raises InputError if a file to be written cannot be."""
    faults = Faults()
    _check(args.plot, "--plot", (".png", ".svg"), faults)
    _check(args.trace, "--trace", (), faults)
    if not args.realtime and args.speed != 1.0:
        faults.error(Place("--speed"), "bad-option", "--speed goes with --realtime; lockstep always runs as fast as it can")
    faults.raise_errors()


def _check(name: str | None, option: str, endings: tuple[str, ...], faults: Faults) -> None:
    if name is None:
        return
    path = Path(name)
    if endings and path.suffix not in endings:
        faults.error(Place(f"{option} {name}"), "bad-option", "unknown picture format", expected=" or ".join(endings), found=path.suffix or name)
    if not path.parent.is_dir():
        faults.error(Place(f"{option} {name}"), "no-such-folder", f"the folder {path.parent} does not exist", mend="make it first")
    elif path.is_dir():
        faults.error(Place(f"{option} {name}"), "is-a-folder", f"{path} is a folder")
