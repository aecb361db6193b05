"""The key locator for TOML, which `tomllib` does not have: one pass that finds where each key stands and judges nothing but size."""

from __future__ import annotations

import re

from pluto_bt.source.key_places import KeyPath, KeyPlaces
from pluto_bt.source.text import SourceText

MAX_PARTS = 16  # of a dotted key; tomllib's time grows with their square
MAX_NESTING = 32  # of arrays and inline tables; tomllib recurses
_STRING = r'"(?:[^"\\\n]|\\.)*+"' + r"|'[^'\n]*+'"
_LONG_STRING = r'"""(?:[^"\\]|\\.|"{1,2}(?!"))*+"{3,5}' + r"|'''(?:[^']|'{1,2}(?!'))*+'{3,5}"
_PART = re.compile(rf"[ \t]*+({_STRING}|[A-Za-z0-9_\-]++)[ \t]*+")
_BLANK = re.compile(r"(?:[ \t\n]++|#[^\n]*+)*+")
_SCALAR = re.compile(rf"{_LONG_STRING}|{_STRING}|[^,\]\}}#\n]++", re.DOTALL)


class TooDeepError(Exception):
    """A key or a nesting so deep that nobody can have meant it; `offset` is where."""

    def __init__(self, offset: int) -> None:
        super().__init__(offset)
        self.offset = offset


class TomlKeys:
    """One pass over a TOML text. It stops at the first thing it does not understand; `tomllib` then says what that is.

    Attributes:
        places: where the keys are.
        duplicate: the offsets (first, second) of a key that stands twice, or None.
    """

    def __init__(self, source: SourceText) -> None:
        self._text = source.text
        self.places = KeyPlaces(source)
        self.duplicate: tuple[int, int] | None = None
        self._stated: dict[KeyPath, int] = {}
        self._table_counts: dict[KeyPath, int] = {}

    def scan(self) -> None:
        """Read all; raises TooDeepError."""
        at = 0
        table: KeyPath = ()
        while (at := self._after_blank(at)) < len(self._text):
            if self._text[at] == "[":
                header = self._header(at)
                if header is None:
                    return
                table, at = header
            else:
                after = self._pair(table, at, 0)
                if after is None:
                    return
                at = after

    def _after_blank(self, at: int) -> int:
        blank = _BLANK.match(self._text, at)
        return blank.end() if blank else at

    def _key(self, at: int) -> tuple[list[tuple[str, int]], int] | None:
        """The parts of a dotted key with their offsets, and the offset behind it."""
        parts: list[tuple[str, int]] = []
        while found := _PART.match(self._text, at):
            parts.append((_unquoted(found.group(1)), found.start(1)))
            if len(parts) > MAX_PARTS:
                raise TooDeepError(parts[0][1])
            at = found.end()
            if self._text[at : at + 1] != ".":
                return parts, at
            at += 1
        return None

    def _header(self, at: int) -> tuple[KeyPath, int] | None:
        """`[table]` or `[[array of tables]]`: the path that its keys have, and the offset behind it."""
        is_array = self._text.startswith("[[", at)
        key = self._key(at + 1 + is_array)
        if key is None or not self._text.startswith("]]" if is_array else "]", key[1]):
            return None
        parts, after = key
        path = self._noted((), parts[:-1])
        name, offset = parts[-1]
        path = (*path, name)
        if is_array:
            self.places.note(path, offset)
            index = self._table_counts[path] = self._table_counts.get(path, -1) + 1
            path = (*path, str(index))
        else:
            self._state(path, offset)
        self.places.note(path, offset)
        return path, after + 1 + is_array

    def _noted(self, table: KeyPath, parts: list[tuple[str, int]]) -> KeyPath:
        """The path of `parts` under `table`, each step noted; a step into an array of tables goes to its last table."""
        for name, offset in parts:
            table = (*table, name)
            self.places.note(table, offset)
            if table in self._table_counts:
                table = (*table, str(self._table_counts[table]))
        return table

    def _state(self, path: KeyPath, offset: int) -> None:
        if path in self._stated and self.duplicate is None:
            self.duplicate = (self._stated[path], offset)
        self._stated.setdefault(path, offset)

    def _pair(self, table: KeyPath, at: int, depth: int) -> int | None:
        """`key = value`: the offset behind it."""
        key = self._key(at)
        if key is None or self._text[key[1] : key[1] + 1] != "=":
            return None
        parts, after = key
        path = (*self._noted(table, parts[:-1]), parts[-1][0])
        value = after + 1
        while self._text[value : value + 1] in (" ", "\t"):
            value += 1
        self.places.note(path, parts[-1][1], value)
        self._state(path, parts[-1][1])
        return self._value(path, value, depth)

    def _value(self, path: KeyPath, at: int, depth: int) -> int | None:
        """Skip a value, noting what is inside arrays and inline tables: the offset behind it."""
        opening = self._text[at : at + 1]
        if opening not in ("[", "{"):
            scalar = _SCALAR.match(self._text, at)
            return scalar.end() if scalar else None
        if depth >= MAX_NESTING:
            raise TooDeepError(at)
        closing, inside, index = "]" if opening == "[" else "}", at + 1, 0
        while True:
            here = self._after_blank(inside)
            if self._text[here : here + 1] == closing:
                return here + 1
            after = self._element((*path, str(index)), here, depth) if opening == "[" else self._pair(path, here, depth + 1)
            if after is None:
                return None
            inside = self._after_blank(after)
            if self._text[inside : inside + 1] == ",":
                inside += 1
            elif self._text[inside : inside + 1] != closing:
                return None
            index += 1

    def _element(self, path: KeyPath, at: int, depth: int) -> int | None:
        self.places.note(path, at, at)
        return self._value(path, at, depth + 1)


def _unquoted(part: str) -> str:
    if part[0] == "'":
        return part[1:-1]
    if part[0] != '"':
        return part
    return re.sub(r'\\(["\\])', r"\1", part[1:-1])  # rarer escapes: the key is then found by the table above it
