"""ARNL / ARIA maps (`2D-Map`): millimetres and degrees in the file, metres and radians here.

LINES become walls. DATA, the points a laser left (up to some 10⁵), become occupied cells of 0.05 m, in a grid that goes as far as points,
lines and the corners that the map names (`MinPos` … `LineMaxPos`) go together. `Cairn:` objects become goals, home, lines and areas
(`arnl_cairns`). Source of the format: ARIA reference manual, page "Map File Format"; a name before `_LINES` or `_DATA` is a further sensor.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.arnl_cairns import MAX_MM, Cairns
from pluto_bt.maps.numbers import NUMBER
from pluto_bt.maps.world import OccupancyGrid, RobotStart, Shape, World
from pluto_bt.source import Faults, did_you_mean
from pluto_bt.source.text import SourceText, decode, read_bytes

FIRST_LINES = ("2D-Map", "2D-Map-Ex", "2D-Map-Ex2")
CELL_M = 0.05
MAX_CELLS = 64_000_000
MAX_LINES = 100_000
MAX_METADATA = 50_000
MAX_ERRORS = 100
_BLANK = re.compile(r"\s*+")
_NUMBER = NUMBER.pattern
_ROWS = {
    count: re.compile(rf"(?:[ \t]*+(?:{_NUMBER}[ \t]++){{{count - 1}}}{_NUMBER}[ \t]*+(?:\n++|\Z))++") for count in (2, 4)
}  # data rows, with the blank lines between them
_SECTION = re.compile(r"(?:(\S+)_)?(LINES|DATA)")
_HEADER = re.compile(r"([A-Za-z]\w*):(.*)")
_PAIRS = ("MinPos", "MaxPos", "LineMinPos", "LineMaxPos")
_COUNTS = {"NumLines": "LINES", "NumPoints": "DATA"}


def read_arnl_map(path: Path, shown_name: str, faults: Faults) -> World | None:
    """The map as a world, or None and faults."""
    data = read_bytes(path, shown_name, faults)
    if data is None:
        return None
    reading = Faults()
    text = decode(data, shown_name, reading)
    if text is None:  # labels in the code page of some old editor
        text = data.decode("latin-1")
    return _ArnlReading(SourceText(text.replace("\0", " "), shown_name), faults).world()


class _ArnlReading:
    """One reading, line by line; runs of data rows are taken at once."""

    def __init__(self, source: SourceText, faults: Faults) -> None:
        self._source, self._text, self._faults = source, source.text, faults
        self._cairns = Cairns(source, faults)
        self._rows: dict[str, list[NDArray[np.float64]]] = {"LINES": [], "DATA": []}
        self._row_offsets: list[int] = []  # where each row of LINES begins
        self._corners: list[list[float]] = []  # (x, y) mm that the map says it goes to
        self._claimed: dict[str, list[tuple[int, int]]] = {"LINES": [], "DATA": []}  # (count, offset) of Num…:
        self._section = ""
        self._sections_seen = 0
        self._errors = 0
        self._lines_left = MAX_METADATA

    def world(self) -> World | None:
        """The world, or None if there was an error."""
        first = self._first_line()
        if first is None:
            return None
        at = first
        while at < len(self._text) and self._errors < MAX_ERRORS:
            at = self._take(at)
        self._check_counts()
        if not self._sections_seen:
            self._error(len(self._text), "missing-section", "there is neither a LINES nor a DATA section", "LINES or DATA", "the end of the file")
        grid = self._grid()
        if self._errors or self._cairns.has_errors:
            return None
        home = self._cairns.home
        start = RobotStart(pose=(home.x_m, home.y_m, home.theta_rad or 0.0), place=home.place) if home else RobotStart()
        return World(
            name=Path(self._source.file).stem, file=self._source.file, grid=grid, shapes=self._walls(), areas=tuple(self._cairns.areas),
            lines=tuple(self._cairns.lines), goals=tuple(self._cairns.goals), home=home, robot=start,
        )  # fmt: skip

    def _first_line(self) -> int | None:
        """The offset after the line that says what this is."""
        head = re.compile(r"\s*+([^\n]*+)\n?").match(self._text)
        word = head.group(1).strip() if head else ""
        if head is None or word not in FIRST_LINES:
            expected = f"one of: {', '.join(FIRST_LINES)}"
            self._error(0, "no-arnl-map", "this is no ARNL map", expected, word[:60] or "nothing", did_you_mean(word, FIRST_LINES))
            return None
        return head.end()

    def _take(self, at: int) -> int:
        """Read what begins at `at`: data rows, or one line; the offset after it."""
        if self._section:
            rows = _ROWS[4 if self._section == "LINES" else 2].match(self._text, at)
            if rows is not None:
                self._add_rows(at, rows.end())
                return rows.end()
        blank = _BLANK.match(self._text, at)
        at = blank.end() if blank else at
        end = self._text.find("\n", at)
        end = len(self._text) if end < 0 else end
        if line := self._text[at:end].strip():
            self._line(line, at)
        return end + 1

    def _line(self, line: str, at: int) -> None:
        self._lines_left -= 1
        if self._lines_left < 0:
            self._error(at, "too-many-nodes", "the map has too many lines that are no data", f"at most {MAX_METADATA}", "more")
            self._errors += MAX_ERRORS
        section, header = _SECTION.fullmatch(line), _HEADER.match(line)
        if section is not None:
            self._section = section.group(2)
            self._sections_seen += 1
        elif header is not None:
            self._metadata(header.group(1), header.group(2), at, at + header.start(2))
        elif self._section:
            wanted = "x1 y1 x2 y2" if self._section == "LINES" else "x y"
            self._error(at, "bad-number", f"this is no row of {self._section}", f"{wanted} in mm", line)
        else:
            self._error(at, "bad-line", "this line is not understood", "Name: values, LINES or DATA", line)

    def _add_rows(self, start: int, end: int) -> None:
        values = np.array(self._text[start:end].split(), dtype=np.float64).reshape(-1, 4 if self._section == "LINES" else 2)
        if not np.all(np.abs(values) <= MAX_MM):
            self._error(start, "bad-number", "a coordinate is out of range", f"at most {MAX_MM:g} mm", f"{np.abs(values).max():g}")
            return
        self._rows[self._section].append(values)
        if self._section == "LINES":
            self._row_offsets += [start + row.start() for row in re.finditer(r"\S[^\n]*+", self._text[start:end])]
            if len(self._row_offsets) > MAX_LINES:
                self._error(start, "too-many-nodes", "the map has too many lines", f"at most {MAX_LINES}", str(len(self._row_offsets)))

    def _metadata(self, key: str, rest: str, at: int, rest_at: int) -> None:
        if key == "Cairn":
            self._cairns.add(rest, rest_at)
        elif key == "MapInfo":
            self._cairns.define(rest)
        elif count := next((name for name in _COUNTS if key.endswith(name)), None):
            self._claim(_COUNTS[count], key, rest.strip(), at)
        elif any(key.endswith(name) for name in _PAIRS):
            self._corner(key, rest.strip(), at)
        elif key.endswith("Resolution") and not (len(self._numbers(rest)) == 1 and self._numbers(rest)[0] > 0):
            self._error(at, "bad-number", f"{key} must be a number greater than 0", f"{key}: millimetres", rest.strip() or "nothing")

    def _corner(self, key: str, words: str, at: int) -> None:
        corner = self._numbers(words)
        if len(corner) != 2:
            self._error(at, "bad-number", f"{key} needs two numbers", f"{key}: x y", words or "nothing")
        elif not max(map(abs, corner)) <= MAX_MM:
            self._error(at, "bad-number", "a coordinate is out of range", f"at most {MAX_MM:g} mm", words)
        else:
            self._corners.append(corner)

    def _claim(self, section: str, key: str, count: str, at: int) -> None:
        if re.fullmatch(r"[0-9]{1,9}", count):
            self._claimed[section].append((int(count), at))
        else:
            self._error(at, "bad-number", f"{key} must be a whole number", f"{key}: how many rows {section} has", count or "nothing")

    def _numbers(self, words: str) -> list[float]:
        return [float(word) for word in words.split()] if all(NUMBER.fullmatch(word) for word in words.split()) else []

    def _check_counts(self) -> None:
        """A wrong count is only a warning: the format says not to rely on it."""
        for section, claims in self._claimed.items():
            found, claimed = sum(map(len, self._rows[section])), sum(count for count, _ in claims)
            if claims and found != claimed:
                what, place = f"{section} has not as many rows as the map says; is the file cut off?", self._source.place(claims[0][1])
                self._faults.warning(place, "wrong-count", what, expected=str(claimed), found=str(found), mend="mend the count")

    def _walls(self) -> tuple[Shape, ...]:
        if not self._rows["LINES"]:
            return ()
        ends = np.vstack(self._rows["LINES"]).reshape(-1, 2, 2) / 1000.0
        ends.setflags(write=False)
        places = map(self._source.place, self._row_offsets)
        return tuple(Shape(f"line{i + 1}", "wall", points, place=place) for i, (points, place) in enumerate(zip(ends, places, strict=True)))

    def _grid(self) -> OccupancyGrid | None:
        """The points as cells; nothing is unknown, since the map does not say where the laser looked."""
        if not self._rows["DATA"]:
            return None
        cell = _cells(np.vstack(self._rows["DATA"]))
        lines = [rows.reshape(-1, 2) for rows in self._rows["LINES"]]
        reach = np.vstack((cell, *map(_cells, (*lines, np.reshape(self._corners, (-1, 2))))))
        low = reach.min(axis=0)
        columns, rows = (int(n) for n in reach.max(axis=0) - low + 1)
        if columns * rows > MAX_CELLS:
            size = f"{columns * CELL_M:g} x {rows * CELL_M:g} m"
            self._error(0, "too-large", "what the map holds lies too far apart", f"an area of at most {MAX_CELLS * CELL_M * CELL_M:g} m²", size)
            return None
        occupied, unknown = np.zeros((rows, columns), np.uint8), np.zeros((rows, columns), np.uint8)
        occupied[cell[:, 1] - low[1], cell[:, 0] - low[0]] = 1
        occupied.setflags(write=False)
        unknown.setflags(write=False)
        return OccupancyGrid(occupied, unknown, CELL_M, (float(low[0]) * CELL_M, float(low[1]) * CELL_M, 0.0))

    def _error(self, at: int, code: str, message: str, expected: str, found: str, mend: str = "") -> None:
        self._errors += 1
        self._faults.error(self._source.place(at), code, message, expected=expected, found=found[:60], mend=mend)


def _cells(points_mm: NDArray[np.float64]) -> NDArray[np.int64]:
    """(column, row) of the cells, counted from the map's origin, in which points (n, 2) lie."""
    return np.floor(points_mm / (1000.0 * CELL_M)).astype(np.int64)
