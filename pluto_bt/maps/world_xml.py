"""Our own world files (DESIGN.md, section 5): every element and attribute, everything checked, all faults told at once."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import numpy as np

from pluto_bt.maps import polygons
from pluto_bt.maps.fields import Fields
from pluto_bt.maps.world import Actor, Area, Goal, Line, Marker, Points, RobotStart, Shadow, Shape, Terrain, World
from pluto_bt.maps.world_ids import Group, Ids
from pluto_bt.maps.world_parts import WorldParts
from pluto_bt.maps.world_script import read_script
from pluto_bt.source import Faults, XmlElement

AREA_KINDS: tuple[Literal["named", "map", "forbidden", "restrictive", "one-way", "sector"], ...] = (
    "named", "map", "forbidden", "restrictive", "one-way", "sector",
)  # fmt: skip
LINE_KINDS: tuple[Literal["forbidden", "restrictive"], ...] = ("forbidden", "restrictive")
SHADOWED: tuple[Literal["gps", "marker", "compass"], ...] = ("gps", "marker", "compass")
MAX_SEED = 2**63 - 1
MAX_POINTS = 200_000  # in one file
ENOUGH_FAULTS = 200  # a file with more is not a world that someone mistyped
MAX_SPEED_MPS = 100.0

ReadMap = Callable[[Path, str, Faults], World | None]


def read_world_xml(root: XmlElement, path: Path, shown_name: str, faults: Faults, read_map: ReadMap) -> World | None:
    """The world that `root` describes, or None and faults.

    Args:
        path: of the world file; maps are looked for beside it.
        read_map: reads an included ROS or ARNL map.
    """
    reading = Faults()
    world = _WorldReading(path, shown_name, reading, read_map).read(root)
    faults.extend(reading.in_order())
    return None if reading.has_errors else world


class _WorldReading:
    """One reading of a world file: a method for each element."""

    def __init__(self, path: Path, shown_name: str, faults: Faults, read_map: ReadMap) -> None:
        self._path, self._shown, self._faults, self._read_map = path, shown_name, faults, read_map
        self._ids, self._found = Ids(faults), WorldParts()
        self._once: dict[str, XmlElement] = {}
        self._readers: dict[str, Callable[[Fields], None]] = {
            "map": self._map, "wall": self._wall, "polygon": self._polygon, "hole": self._polygon, "circle": self._circle, "area": self._area,
            "line": self._line, "goal": self._goal, "home": self._home, "marker": self._marker, "shadow": self._shadow, "actor": self._actor,
            "terrain": self._terrain, "robot": self._robot,
        }  # fmt: skip

    def read(self, root: XmlElement) -> World | None:
        fields = Fields(root, self._faults)
        if root.tag != "world":
            what, mend = f"<{root.tag}> is not a world", _what_it_is(root.tag)
            fields.fault(root.place, "no-world", what, expected="<world name=…>", found=f"<{root.tag}>", mend=mend)
            return None
        if sum(child.text.count(",") for child in root.children) > MAX_POINTS:
            fields.fault(root.place, "too-many-nodes", "the world has too many points", expected=f"at most {MAX_POINTS}", found="more")
            return None
        name, seed = fields.text("name", Path(self._shown).stem), fields.whole("seed", 0, MAX_SEED)
        fields.done((*self._readers, "script"))
        for child in sorted(root.children, key=lambda child: child.tag != "map"):  # what a map brings along has its names first
            if child.tag in self._readers and len(self._faults) < ENOUGH_FAULTS:
                self._readers[child.tag](Fields(child, self._faults))
        for child in root.children:  # a script may stand before what it names
            if child.tag == "script":
                self._found.script += read_script(child, self._ids, self._faults, ENOUGH_FAULTS)
        return self._found.world(name, self._shown, seed, str(self._path))

    # ------------------------------------------------------------------ one of a kind

    def _is_second(self, fields: Fields) -> bool:
        tag = fields.element.tag
        first = self._once.setdefault(tag, fields.element)
        if first is fields.element:
            return False
        what, found = f"a second <{tag}>", f"the first is in line {first.place.line}, column {first.place.column}"
        fields.fault(fields.place, "duplicate-element", what, expected=f"at most one <{tag}>", found=found, mend="delete one")
        return True

    def _map(self, fields: Fields) -> None:
        second, source = self._is_second(fields), fields.text("src")
        fields.done()
        if not source or second:
            return
        shown = os.path.join(os.path.dirname(self._shown), source)
        if Path(source).suffix.lower() == ".xml":
            place = fields.element.attributes["src"].value_place
            fields.fault(place, "bad-value", "a world cannot include a world", expected="a ROS map (.yaml) or an ARNL map (.map)", found=source)
            return
        inner = Faults()
        self._found.map = base = self._read_map(self._path.parent / source, shown, inner)
        for fault in inner.in_order():
            if fault.line == 0 and fault.severity == "error":  # of the file as a whole: told where it is named
                place = fields.element.attributes["src"].value_place
                fields.fault(place, fault.code, fault.message, expected=fault.expected, found=fault.found, mend=fault.mend)
            else:
                self._faults.extend([fault])
        if base is not None:
            self._ids.take_all("obstacle", ((shape.id, shape.place) for shape in base.shapes))
            self._ids.take_all("region", ((area.id, area.place) for area in base.areas))
            self._ids.take_all("line", ((line.id, line.place) for line in base.lines))
            self._ids.take_all("goal", ((goal.id, goal.place) for goal in base.goals))

    def _home(self, fields: Fields) -> None:
        second, home = self._is_second(fields), self._goal_at("home", fields)
        if not second:
            self._found.home = home
        fields.done()

    def _robot(self, fields: Fields) -> None:
        second = self._is_second(fields)
        name, platform, ideal = fields.text("name", "robot"), fields.text("platform", ""), fields.flag("ideal")
        pose = None
        if fields.has("x") or fields.has("y") or fields.has("theta_deg"):
            pose = (fields.number("x"), fields.number("y"), fields.angle_rad("theta_deg"))
        if not second:
            self._ids.robot = name
            self._found.robot = RobotStart(name, platform, pose, ideal, fields.place)
        fields.done()

    # ------------------------------------------------------------------ shapes

    def _wall(self, fields: Fields) -> None:
        name, height_m, absent = self._shape(fields)
        points = fields.points(2)
        fields.done(has_text=True)
        if points is None:
            return
        if np.all(points == points[0]):
            fields.fault(fields.element.text_place, "zero-length", "this wall has no length", expected="two different points", found="one point")
        self._found.shapes.append(Shape(name, "wall", points, 0.0, height_m, absent, fields.place))

    def _polygon(self, fields: Fields) -> None:
        name, height_m, absent = self._shape(fields)
        points = self._corners(fields)
        if points is not None:
            self._found.shapes.append(Shape(name, "hole" if fields.element.tag == "hole" else "polygon", points, 0.0, height_m, absent, fields.place))

    def _circle(self, fields: Fields) -> None:
        name, height_m, absent = self._shape(fields)
        centre = np.array([[fields.number("x"), fields.number("y")]])
        centre.setflags(write=False)
        radius_m = fields.number("r", None, 0.0, above=True)
        fields.done()
        self._found.shapes.append(Shape(name, "circle", centre, radius_m, height_m, absent, fields.place))

    def _shape(self, fields: Fields) -> tuple[str, float, bool]:
        """(id, height_m, absent)."""
        return self._id(fields, "obstacle"), fields.number("height", 2.0, 0.0, above=True), fields.flag("absent")

    def _id(self, fields: Fields, group: Group) -> str:
        if not fields.has("id"):
            return self._ids.invent(group, fields.element.tag, fields.place)
        name = fields.text("id")
        self._ids.take(group, name, fields.element.attributes["id"].value_place)
        return name

    def _corners(self, fields: Fields) -> Points | None:
        """The corners of a polygon that is one; the last thing asked of an element."""
        points = fields.points(3)
        fields.done(has_text=True)
        if points is None:
            return None
        place, tag = fields.element.text_place, fields.element.tag
        corners = polygons.without_repeats(points)
        if len(corners) > polygons.MAX_CORNERS:
            found, most = str(len(corners)), f"at most {polygons.MAX_CORNERS}"
            fields.fault(place, "too-many-nodes", f"this <{tag}> has too many corners", expected=most, found=found)
        elif len(corners) < 3 or polygons.is_flat(corners):
            expected, found = "three corners that are not in one line", f"{len(corners)} different corners"
            fields.fault(place, "zero-area", f"this <{tag}> has no area", expected=expected, found=found)
        elif (pair := polygons.crossing(corners)) is not None:
            x, y = polygons.meeting_point(corners, pair)
            what = f"the border of this <{tag}> crosses itself at {x:.6g},{y:.6g}"
            found = f"edges {pair[0] + 1} and {pair[1] + 1} meet"
            fields.fault(place, "self-crossing", what, expected="corners in the order of the border", found=found)
        return corners

    # ------------------------------------------------------------------ places with a meaning

    def _area(self, fields: Fields) -> None:
        name, kind, theta_rad = self._id(fields, "region"), fields.choice("kind", AREA_KINDS), fields.angle_rad("theta_deg")
        points = self._corners(fields)
        if points is not None:
            self._found.areas.append(Area(name, kind, points, theta_rad, fields.place))

    def _line(self, fields: Fields) -> None:
        name, kind, points = self._id(fields, "line"), fields.choice("kind", LINE_KINDS), fields.points(2)
        fields.done(has_text=True)
        if points is not None:
            self._found.lines.append(Line(name, kind, points, fields.place))

    def _goal(self, fields: Fields) -> None:
        name = fields.text("id")
        if name:
            self._ids.take("goal", name, fields.element.attributes["id"].value_place)
        self._found.goals.append(self._goal_at(name, fields))
        fields.done()

    def _goal_at(self, name: str, fields: Fields) -> Goal:
        x_m, y_m = fields.number("x"), fields.number("y")
        return Goal(name, x_m, y_m, fields.angle_rad("theta_deg") if fields.has("theta_deg") else None, fields.place)

    def _marker(self, fields: Fields) -> None:
        number = fields.whole("id", None, 10**6)
        if fields.has("id"):
            self._ids.take("marker", str(number), fields.element.attributes["id"].value_place)
        self._found.markers.append(Marker(number, fields.number("x"), fields.number("y"), fields.angle_rad("theta_deg"), fields.place))
        fields.done()

    def _shadow(self, fields: Fields) -> None:
        sensor, points = fields.choice("sensor", SHADOWED), self._corners(fields)
        if points is not None:
            self._found.shadows.append(Shadow(sensor, points, fields.place))

    def _terrain(self, fields: Fields) -> None:
        name, slip = self._id(fields, "region"), fields.number("slip", 0.0, 0.0, 1.0)
        slip_back = fields.number("slip_back", 0.0, 0.0, 1.0) if fields.has("slip_back") else None
        roll_rad, pitch_rad = fields.angle_rad("roll_deg", limit_deg=89.0), fields.angle_rad("pitch_deg", limit_deg=89.0)
        magnetic_rad = fields.angle_rad("magnetic_deg", limit_deg=360.0)
        points = self._corners(fields)
        if points is not None:
            self._found.terrains.append(Terrain(name, points, slip, roll_rad, pitch_rad, magnetic_rad, fields.place, slip_back))

    def _actor(self, fields: Fields) -> None:
        name, radius_m = self._id(fields, "obstacle"), fields.number("r", None, 0.0, above=True)
        speed_mps, loop = fields.number("speed", None, 0.0, MAX_SPEED_MPS), fields.flag("loop")
        height_m, absent, points = fields.number("height", 1.8, 0.0, above=True), fields.flag("absent"), fields.points(1)
        fields.done(has_text=True)
        if points is not None:
            self._found.actors.append(Actor(name, radius_m, speed_mps, loop, points, height_m, absent, fields.place))


def _what_it_is(tag: str) -> str:
    return "this is a mission: give it as MISSION.xml, not as a world" if tag == "root" else ""
