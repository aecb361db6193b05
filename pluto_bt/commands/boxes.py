"""Black boxes as the commands need them: found and read, or refused with a fault."""

from __future__ import annotations

import sys
import tempfile
import weakref
from pathlib import Path
from typing import TYPE_CHECKING

from pluto_bt.commands.extras import need
from pluto_bt.source import Faults, Place

if TYPE_CHECKING:
    from pluto_bt.record.box import Box
    from pluto_bt.record.mcap_reader import McapFile


def read_box(name: str, *, needs_ticks: bool = True) -> Box:
    """The black box of that name; one that was cut short by a crash is read as far as it goes, with a warning.

    A log of CARMEN is read as a recording from outside, which has topics alone; with `needs_ticks` that is refused. Raises: InputError.
    """
    faults = Faults()
    box = None
    if need("record", name, faults):
        from pluto_bt.commands.carmen_box import is_carmen
        from pluto_bt.record.box import open_box
        from pluto_bt.record.entries import WATCHED

        box = _of_carmen(name, faults) if is_carmen(name) else open_box(Path(name), name, faults)
        if box is not None and not box.file.is_whole:
            told = "is damaged; read what is good of it" if box.file.is_damaged else "was cut short; read as far as it goes"
            print(f"{name}: the recording {told} (`pluto repair {name}` makes it whole)", file=sys.stderr)
        if box is not None and needs_ticks and box.run.mode == WATCHED:
            what, mend = f'"{name}" was recorded from outside: it has topics, but no ticks of a tree', "`pluto plot` and `pluto export` read it"
            faults.error(Place(name), "no-ticks", what, expected="a file of `pluto run --record`", found="topics alone", mend=mend)
    faults.raise_errors()
    assert box is not None  # else there was a fault
    return box


def _of_carmen(name: str, faults: Faults) -> Box | None:
    from pluto_bt.commands.carmen_box import packed
    from pluto_bt.record.box import open_box

    folder = tempfile.TemporaryDirectory(prefix="pluto-log-")
    path = Path(folder.name, "log.mcap")
    box = open_box(path, name, faults) if packed(name, path, faults) else None
    for fault in faults.in_order() if box is not None else ():
        print(fault.as_text(), file=sys.stderr)
    if box is not None:
        weakref.finalize(box, folder.cleanup)
    return box


def read_mcap(name: str) -> McapFile:
    """The MCAP file of that name. Raises: InputError."""
    faults = Faults()
    if need("record", name, faults):
        from pluto_bt.record.mcap_reader import open_mcap

        file = open_mcap(Path(name), name, faults)
    faults.raise_errors()
    assert file is not None  # else there was a fault
    return file
