"""`pluto fmt`: missions and worlds in one canonical form; the order of everything and all comments are kept."""

from __future__ import annotations

import os
import stat
import sys
import tempfile
from pathlib import Path

from pluto_bt.commands.options import Parser
from pluto_bt.source import Faults, Place
from pluto_bt.source.text import decode, read_bytes
from pluto_bt.source.xml_reader import read_document
from pluto_bt.source.xml_writer import written


def main(argv: list[str]) -> int:
    """Rewrite files that are not in canonical form; with `--check` only name them. Exit 0; 1 if `--check` found one; 2 for bad input."""
    parser = Parser(prog="pluto fmt", description="Bring missions and worlds (XML) into one canonical form. `-` formats stdin to stdout.")
    parser.add_argument("files", nargs="+", metavar="FILE")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if a file is not in canonical form")
    args = parser.parse_args(argv)
    faults = Faults()
    changed = [name for name in args.files if _format(name, args.check, faults)]
    if faults:
        print("\n".join(fault.as_text() for fault in faults.in_order()), file=sys.stderr)
    for name in changed if args.files != ["-"] else []:
        print(f"{name}: {'not in canonical form' if args.check else 'rewritten'}")
    return 2 if faults.has_errors else 1 if args.check and changed else 0


def _format(name: str, only_check: bool, faults: Faults) -> bool:
    """True if the file was not in canonical form."""
    if name == "-":
        return _format_stream(only_check, faults)
    own = Faults()
    data = read_bytes(name, name, own)
    text = decode(data, name, own) if data is not None else None
    document = read_document(text, name, own) if text is not None else None
    if document is not None and not own.has_errors:
        canonical = written(document)
        if data == canonical.encode():
            return False
        if not only_check:
            _replace(Path(name), canonical, own)
    faults.extend(own.in_order())
    return not own.has_errors


def _format_stream(only_check: bool, faults: Faults) -> bool:
    text = sys.stdin.read()
    document = read_document(text, "", faults)
    if document is None or faults.has_errors:
        return False
    canonical = written(document)
    if not only_check:
        sys.stdout.write(canonical)
    return text != canonical


def _replace(path: Path, text: str, faults: Faults) -> None:
    """The new content takes the place of the old in one step, so that a crash leaves one of them whole."""
    target = path.resolve()
    try:
        with tempfile.NamedTemporaryFile("w", dir=target.parent, prefix=f".{target.name}.", encoding="utf-8", newline="\n", delete=False) as file:
            file.write(text)
        os.chmod(file.name, stat.S_IMODE(target.stat().st_mode))
        os.replace(file.name, target)
    except OSError as error:
        found = str(error.strerror or error)
        faults.error(Place(str(path)), "not-writable", f"cannot write {path}", expected="a file that may be written", found=found)
