"""A source text that knows line and column of every character, and the reading of files within a size limit."""

from __future__ import annotations

import codecs
import os
import re
import stat
from pathlib import Path

from pluto_bt.source.faults import Faults, Place, did_you_mean

MIB = 1 << 20
MAX_BYTES = 16 * MIB
_STEP = 4096  # characters between two stored line counts
_DECLARED = re.compile(rb"""<\?xml[^>]{0,200}?encoding\s*=\s*["']([A-Za-z0-9._-]{1,40})["']""")
_BOMS = ((codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"))


class SourceText:
    """A text with the name of its file. Places are made on demand, so a faultless text costs nothing for them.

    Attributes:
        text: the text with every line end (`\\r\\n`, `\\r`) as `\\n`; columns are those of the original.
        file: the name to show.
    """

    __slots__ = ("_line_starts", "_lines_before", "_shown", "file", "text")

    def __init__(self, text: str, file: str = "") -> None:
        self.text = text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text
        self.file = file
        self._lines_before: list[int] = []
        self._line_starts: dict[int, int] = {}
        self._shown: dict[int, str] = {}

    def place(self, offset: int) -> Place:
        """The place of the character at `offset` (0 … length; the length itself is the place just after the last)."""
        line = self._line_of(offset)
        if line not in self._line_starts:
            start = self.text.rfind("\n", 0, offset) + 1
            end = self.text.find("\n", start)
            self._line_starts[line] = start
            self._shown[line] = self.text[start : end if end >= 0 else len(self.text)]
        return Place(self.file, line, offset - self._line_starts[line] + 1, self._shown[line])

    def at(self, line: int, column: int) -> Place:
        """The place of a line and column (both from 1) that another reader counted."""
        lines = self.text.split("\n", line)
        return Place(self.file, line, column, lines[line - 1] if line <= len(lines) else "")

    def _line_of(self, offset: int) -> int:
        if not self._lines_before:
            count = 0
            for start in range(0, len(self.text) + 1, _STEP):
                self._lines_before.append(count)
                count += self.text.count("\n", start, start + _STEP)
        block = offset // _STEP
        return self._lines_before[block] + self.text.count("\n", block * _STEP, offset) + 1


def read_bytes(path: str | Path, shown_name: str, faults: Faults, *, max_bytes: int = MAX_BYTES) -> bytes | None:
    """The content of a file; None and a fault if it is missing, a folder, unreadable or longer than `max_bytes`."""
    path, place = Path(path), Place(shown_name)
    try:
        with open(path, "rb", opener=_open_at_once) as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                faults.error(place, "no-file", f'"{shown_name}" is no ordinary file', expected="a file", found="a pipe or a device")
                return None
            data = file.read(max_bytes + 1)
    except FileNotFoundError:
        faults.error(place, "no-file", f'there is no file "{shown_name}"', expected="a file", found="nothing", mend=_near_name(path))
    except IsADirectoryError:
        faults.error(place, "no-file", f'"{shown_name}" is a folder', expected="a file", found="a folder")
    except (OSError, ValueError) as error:
        found = str(getattr(error, "strerror", None) or error)
        faults.error(place, "no-file", f'"{shown_name}" cannot be read', expected="a file that may be read", found=found)
    else:
        if len(data) <= max_bytes:
            return data
        faults.error(place, "too-large", "the file is too large", expected=f"at most {max_bytes / MIB:g} MiB", found="more")
    return None


def _open_at_once(path: str, flags: int) -> int:
    """Opening a pipe that nobody writes to would wait for ever."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def decode(data: bytes, shown_name: str, faults: Faults, encoding: str = "") -> str | None:
    """The text of a file: UTF-8 unless a byte-order mark, `encoding`, or an XML declaration says otherwise; None and a fault if it is none."""
    for mark, name in _BOMS:
        if data.startswith(mark):
            data, encoding = data[len(mark) :], name
            break
    else:
        encoding = encoding or _declared_encoding(data)
    try:
        return data.decode(encoding)
    except LookupError:
        faults.error(Place(shown_name, 1, 1), "encoding", "unknown encoding", expected="utf-8, utf-16, iso-8859-1, …", found=encoding)
    except UnicodeDecodeError as error:
        _undecodable(data, error, shown_name, encoding, faults)
    except ValueError:  # codecs that are no text encodings
        faults.error(Place(shown_name, 1, 1), "encoding", "this encoding cannot be decoded", expected="utf-8", found=encoding)
    return None


def read_text(path: str | Path, shown_name: str, faults: Faults, *, max_bytes: int = MAX_BYTES) -> str | None:
    """The text of a file, decoded; None and a fault if it cannot be had."""
    data = read_bytes(path, shown_name, faults, max_bytes=max_bytes)
    return None if data is None else decode(data, shown_name, faults)


def _declared_encoding(data: bytes) -> str:
    found = _DECLARED.match(data.lstrip(b" \t\r\n")[:300])
    name = found.group(1).decode("ascii").lower() if found else "utf-8"
    return "utf-8" if name.startswith("utf-16") else name  # ASCII bytes just read as ASCII, so it is not UTF-16


def _undecodable(data: bytes, error: UnicodeDecodeError, shown_name: str, encoding: str, faults: Faults) -> None:
    before = data[: error.start].decode(encoding, "replace").replace("\r\n", "\n").replace("\r", "\n")
    line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
    found = " ".join(f"0x{byte:02x}" for byte in data[error.start : error.start + 4])
    mend = "save the file as UTF-8, or declare its encoding" if encoding == "utf-8" else "the declared encoding is not the real one"
    faults.error(Place(shown_name, line, column), "encoding", f"the file is not {encoding} text", expected=encoding, found=f"byte {found}", mend=mend)


def _near_name(path: Path) -> str:
    try:
        names = sorted(entry.name for entry in path.parent.iterdir())[:2000]
    except (OSError, ValueError):
        return ""
    return did_you_mean(path.name, names)
