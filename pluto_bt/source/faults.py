"""Faults of input, collected and told all at once.

    PlutoError                       everything this software raises on purpose
    └── InputError                   bad input; carries every fault found
        └── pluto_bt.trees.MissionError   a mission that cannot be loaded
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar, Final, Literal, NoReturn

Severity = Literal["error", "warning"]


class PlutoError(Exception):
    """The root of all errors that this software raises on purpose."""


@dataclass(frozen=True, slots=True)
class Place:
    """A position in a source text: where a tag, an attribute or a key begins.

    Attributes:
        file: the name as the user gave it ("" for a text that has no file).
        line: counted from 1; 0 where the format has no lines.
        column: counted from 1 in characters; 0 where unknown.
        text: the whole source line, for the caret line of a report.
    """

    file: str = ""
    line: int = 0
    column: int = 0
    text: str = ""


TOO_MANY: Final = "too-many-faults"  # the code of the fault that stands for all further ones
NOWHERE: Final = Place()  # of what no file says


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault of an input, in the shape of `pluto check --format json`."""

    file: str
    line: int
    column: int
    severity: Severity
    code: str
    message: str
    expected: str = ""
    found: str = ""
    mend: str = ""
    source_line: str = ""

    def as_text(self) -> str:
        """The report a person reads: head line, caret line, then what was expected, found and how to mend it."""
        where = _quotable(self.file) or "<text>"
        if self.line:
            where += f":{self.line}:{self.column}" if self.column else f":{self.line}"
        lines = [f"{where}: {self.severity}: {self.message}"]
        if self.source_line.strip() and self.column:
            shown, column = _window(self.source_line, self.column)
            lines += [f"      {shown}", f"      {' ' * (column - 1)}^"]
        lines += [f"      {word:<9} {value}" for word, value in (("expected", self.expected), ("found", self.found), ("mend", self.mend)) if value]
        return "\n".join(lines)

    def as_json(self) -> dict[str, str | int]:
        """The fields of `check --format json` (DESIGN.md, section 4)."""
        names = ("file", "line", "column", "severity", "code", "message", "expected", "found", "mend")
        fields = {name: getattr(self, name) for name in names}
        return fields | {"file": self.file.encode("utf-8", "backslashreplace").decode()}  # file names need be no Unicode text


class InputError(PlutoError):
    """Bad input. `faults` holds every fault found, errors and warnings, in the order of the text."""

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(fault.as_text() for fault in self.faults))


class Faults:
    """Collects the faults of one reading; the reader goes on after each, so that all are told at once."""

    LIMITS: ClassVar[dict[Severity, int]] = {"error": 1000, "warning": 200}  # a broken generator must not fill the memory with reports

    def __init__(self) -> None:
        self._faults: list[Fault] = []
        self._counts: dict[Severity, int] = {"error": 0, "warning": 0}

    def error(self, place: Place, code: str, message: str, *, expected: str = "", found: str = "", mend: str = "") -> None:
        """Note an error; `code` is a short documented word such as `unknown-port`."""
        self._add(place, "error", code, message, expected, found, mend)

    def warning(self, place: Place, code: str, message: str, *, expected: str = "", found: str = "", mend: str = "") -> None:
        """Note something that works but is probably not meant."""
        self._add(place, "warning", code, message, expected, found, mend)

    def _add(self, place: Place, severity: Severity, code: str, message: str, expected: str, found: str, mend: str) -> None:
        limit = self.LIMITS[severity]
        if self._counts[severity] >= limit:
            return
        self._counts[severity] += 1
        if self._counts[severity] == limit:
            place, code, message = Place(place.file), TOO_MANY, f"there are more {severity}s than can be told"
            expected, found, mend = f"at most {limit}", "more", "mend the first ones"
        message, expected, found, mend = map(_quotable, (message, expected, found, mend))
        self._faults.append(Fault(place.file, place.line, place.column, severity, code, message, expected, found, mend, place.text))

    def extend(self, faults: Iterable[Fault]) -> None:
        """Take over faults found by another reader."""
        for fault in faults:
            self._faults.append(fault)
            self._counts[fault.severity] += 1

    @property
    def is_full(self) -> bool:
        """True if no further error is taken: reading on makes no sense. (Warnings never hide an error.)"""
        return self._counts["error"] >= self.LIMITS["error"]

    def __bool__(self) -> bool:
        return bool(self._faults)

    def __len__(self) -> int:
        return len(self._faults)

    @property
    def has_errors(self) -> bool:
        """True if at least one is more than a warning."""
        return self._counts["error"] > 0

    def in_order(self) -> tuple[Fault, ...]:
        """All faults, by file (in the order first seen), line and column; that there are more comes last."""
        files = {file: i for i, file in enumerate(dict.fromkeys(fault.file for fault in self._faults))}
        return tuple(sorted(self._faults, key=lambda fault: (fault.code == TOO_MANY, files[fault.file], fault.line, fault.column)))

    def raise_errors(self, kind: type[InputError] = InputError) -> None:
        """Raise `kind` with all faults if any of them is an error."""
        if self.has_errors:
            raise kind(self.in_order())


def fail(place: Place, code: str, message: str, *, expected: str = "", found: str = "", mend: str = "") -> NoReturn:
    """Raise an InputError for a single fault after which reading on makes no sense."""
    faults = Faults()
    faults.error(place, code, message, expected=expected, found=found, mend=mend)
    raise InputError(faults.in_order())


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """'did you mean "goal"?' for the nearest known word, or "" if none is near."""
    near = nearest_word(word, known)
    return f'did you mean "{near}"?' if near else ""


def nearest_word(word: str, known: Iterable[str]) -> str:
    """The known word that a misspelt one most likely means, or "" if none is near."""
    if len(word) > 100:
        return ""
    by_lower = {name.lower(): name for name in known}
    near = difflib.get_close_matches(word.lower(), by_lower, n=1, cutoff=0.6)
    return by_lower[near[0]] if near else ""


def _quotable(text: str, most: int = 600) -> str:
    """A report quotes the input, which may hold a word of megabytes, or characters that play tricks on a terminal or are no Unicode text."""
    text = text if len(text) <= most else text[: most - 1] + "…"
    return text if text.isprintable() else "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def _window(line: str, column: int, width: int = 150) -> tuple[str, int]:
    """The part of a long line around the column, tabs and control characters shown as blanks; and the column in it."""
    start = max(0, column - 1 - width // 2) if len(line) > width else 0
    clean = "".join(c if c.isprintable() else " " for c in line[start : start + width])
    return clean.rstrip(), column - start
