"""The objects of an ARNL map: `Cairn: Type x y theta "description" ICON "label" [x1 y1 x2 y2]`, millimetres and degrees.

A rectangle is given unrotated and then turned by theta about the *origin of the map* (ArMapObject), whatever x and y say.
Types that a map defines itself by `MapInfo:` mean what their class means.
"""

from __future__ import annotations

import math
import re
from typing import Literal

import numpy as np

from pluto_bt.maps.numbers import NUMBER
from pluto_bt.maps.world import Area, Goal, Line, Points
from pluto_bt.source import Faults
from pluto_bt.source.text import SourceText

_FIELD = re.compile(r'"[^"]*+"|\S++')
_NAMED = re.compile(r'Name=([^\s"]++)')
MAX_MM = 1e9
AreaKind = Literal["forbidden", "restrictive", "one-way", "sector"]
AREA_KINDS: dict[str, AreaKind] = {"forbidden": "forbidden", "restrictive": "restrictive", "one-way": "one-way", "sector": "sector"}


class Cairns:
    """Collects the objects of one map. Attributes: `goals`, `home`, `lines`, `areas`, `has_errors`."""

    def __init__(self, source: SourceText, faults: Faults) -> None:
        self._source, self._faults = source, faults
        self.goals: list[Goal] = []
        self.home: Goal | None = None
        self.lines: list[Line] = []
        self.areas: list[Area] = []
        self.has_errors = False
        self._custom: dict[str, str] = {}  # type name → class of MapInfo
        self._ids: dict[str, int] = {}  # id → the highest number given to it
        self._strange: dict[str, None] = {}

    def define(self, rest: str) -> None:
        """`MapInfo: SectorType Name=… …`: a type that the map itself brings along."""
        words, name = rest.split(None, 1), _NAMED.search(rest)
        if name is not None and words:
            self._custom[name.group(1)] = words[0]

    def add(self, rest: str, at: int) -> None:
        """One object; `rest` is what follows `Cairn:`, at offset `at`."""
        fields = [(field.group(), at + field.start()) for field in _FIELD.finditer(rest)]
        if len(fields) < 7:
            expected = 'Cairn: Type x y theta "description" ICON "label"'
            self._error(fields[0][1] if fields else at, "bad-cairn", "this object has too few fields", expected, rest.strip() or "nothing")
            return
        pose, tail = self._numbers(fields[1:4]), self._numbers(fields[7:])
        if len(pose) < 3:
            text, bad_at = fields[1 + len(pose)]
            self._error(bad_at, "bad-number", "this is no number", f"a number of at most {MAX_MM:g}", text)
            return
        (kind, kind_at), (label, _) = fields[0], fields[6]
        self._place(kind, label.strip('"'), (pose[0], pose[1], pose[2]), tail, kind_at)

    def _numbers(self, fields: list[tuple[str, int]]) -> list[float]:
        """The numbers that the fields begin with; words after them belong to other programs."""
        numbers: list[float] = []
        for text, _ in fields:
            value = float(text) if NUMBER.fullmatch(text) else math.nan
            if not abs(value) <= MAX_MM:
                break
            numbers.append(value)
        return numbers

    def _place(self, kind: str, label: str, pose: tuple[float, float, float], tail: list[float], at: int) -> None:
        theta_rad = math.radians(pose[2])
        meaning = self._meaning(kind)
        if meaning in ("goal", "goal-with-heading", "home"):
            self._add_point(meaning, label or kind, pose[0] / 1000.0, pose[1] / 1000.0, theta_rad, at)
        elif meaning.endswith("line"):
            if self._has_box(kind, tail, at):
                ends = _metres([(tail[0], tail[1]), (tail[2], tail[3])])
                line: Literal["forbidden", "restrictive"] = "forbidden" if meaning == "forbidden-line" else "restrictive"
                self.lines.append(Line(self._id(label or kind, at), line, ends, self._source.place(at)))
        elif meaning in AREA_KINDS:
            if self._has_box(kind, tail, at):
                self._add_area(meaning, label or kind, theta_rad, tail, at)
        elif kind not in self._strange:
            self._strange[kind] = None
            what = f'objects of type "{kind}" are not used here'
            self._faults.warning(self._source.place(at), "unknown-cairn", what, expected="a goal, dock, home, line, area or sector", found=kind)

    def _meaning(self, kind: str) -> str:
        """What a type is to us: by its name, else by the class that the map's MapInfo gives it."""
        custom = self._custom.get(kind, "")
        if kind.endswith("RobotHome") or kind == "Home":
            return "home"
        if kind.endswith("WithHeading") or kind.startswith("Dock") or custom == "DockType":
            return "goal-with-heading"
        if kind.endswith("Goal") or custom == "GoalType":
            return "goal"
        restricts = "restrict" in kind.lower() or "resist" in kind.lower()
        if kind.endswith(("Line", "Boundary")) or custom == "BoundaryType":
            return "forbidden-line" if kind.startswith("Forbidden") else "restrictive-line" if restricts else ""
        if kind.endswith(("Area", "Sector")) or custom == "SectorType":
            if kind.startswith("Forbidden"):
                return "forbidden"
            return "restrictive" if restricts else "one-way" if kind.startswith("OneWay") else "sector"
        return ""

    def _has_box(self, kind: str, tail: list[float], at: int) -> bool:
        if len(tail) >= 4:
            return True
        self._error(at, "bad-cairn", f"a {kind} needs two corners", "x1 y1 x2 y2 after the label", f"{len(tail)} numbers")
        return False

    def _add_point(self, meaning: str, label: str, x_m: float, y_m: float, theta_rad: float, at: int) -> None:
        if meaning == "home":
            if self.home is None:
                self.home = Goal("home", x_m, y_m, theta_rad, self._source.place(at))
            return  # further homes are other places where a robot may be switched on
        heading = theta_rad if meaning == "goal-with-heading" else None
        self.goals.append(Goal(self._id(label, at), x_m, y_m, heading, self._source.place(at)))

    def _add_area(self, meaning: str, label: str, theta_rad: float, tail: list[float], at: int) -> None:
        (x1, y1, x2, y2), more = tail[:4], tail[4:]
        if x1 == x2 or y1 == y2:
            what, found = f'area "{label}" has no size', f"{x1:g} {y1:g} {x2:g} {y2:g}"
            self._faults.warning(self._source.place(at), "zero-area", what, expected="two opposite corners", found=found, mend="it is left out")
            return
        if more and more[0] >= 3 and len(more) == 1 + 2 * int(more[0]):  # newer maps: the corners of a polygon follow the rectangle
            points = _metres(list(zip(more[1::2], more[2::2], strict=True)))
        else:
            points = _turned(_metres([(x1, y1), (x2, y1), (x2, y2), (x1, y2)]), theta_rad)
        self.areas.append(Area(self._id(label, at), AREA_KINDS[meaning], points, theta_rad, self._source.place(at)))

    def _id(self, label: str, at: int) -> str:
        """Labels need not be unique in ARNL; here the first keeps it and the others are numbered."""
        name = label
        while name in self._ids:
            self._ids[label] = self._ids.get(label, 1) + 1
            name = f"{label}-{self._ids[label]}"
        if name != label and self._ids[label] == 2:
            what = f'two objects are called "{label}"; the second is "{name}" here'
            self._faults.warning(self._source.place(at), "duplicate-id", what, expected="a label for each object", found=label)
        self._ids[name] = 1
        return name

    def _error(self, at: int, code: str, message: str, expected: str, found: str) -> None:
        self.has_errors = True
        self._faults.error(self._source.place(at), code, message, expected=expected, found=found[:60])


def _metres(corners_mm: list[tuple[float, float]]) -> Points:
    points = np.array(corners_mm, dtype=np.float64) / 1000.0
    points.setflags(write=False)
    return points


def _turned(points: Points, theta_rad: float) -> Points:
    """Turned about the origin of the map."""
    cos, sin = math.cos(theta_rad), math.sin(theta_rad)
    turned: Points = points @ np.array([[cos, sin], [-sin, cos]])
    turned.setflags(write=False)
    return turned
