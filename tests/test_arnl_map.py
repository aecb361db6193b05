"""ARNL maps: lines, points, objects, counts; every fault with its place."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from shared_data import shared_file

from pluto_bt.maps.load import load_world
from pluto_bt.maps.world import World
from pluto_bt.source import Fault, Faults, InputError

MAP = """\
2D-Map
MinPos: -100 -60
MaxPos: 1000 900
NumPoints: 3
PointsAreSorted: true
Resolution: 20
LineMinPos: 0 0
LineMaxPos: 2000 1000
NumLines: 2
MapInfo: SectorType Name=SlowSector "Label=Slow here" Shape=Plain
Cairn: RobotHome 500 -250 90 "" ICON "Home"
Cairn: Goal 1000 2000 45 "" ICON "printer room"
Cairn: GoalWithHeading 1000 2000 45.5 "" ICON "window"
Cairn: DockLynx 0 0 -90 "" ICON "dock"
Cairn: ForbiddenLine 1 2 0.000000 "" ICON "cliff" 0 0 1000 500
Cairn: ForbiddenArea 0 0 90 "" ICON "stairs" 1000 0 2000 500
Cairn: OneWaySector 0 0 -90 "" ICON "lane" 0 0 1000 200
Cairn: RestrictiveSector 0 0 0 "" ICON "soft" 0 0 1000 200
Cairn: SlowSector 0 0 0 "" ICON "slow" 0 0 1000 200 4 0 0 1000 0 1000 200 10 250
LINES
0 0 2000 0
  2000 0 2000 1000.5
DATA
-100 -60
1000 900
1001 901
"""


def world_of(folder: Path, text: str, warnings: Faults | None = None) -> World:
    (folder / "m.map").write_text(text, encoding="utf-8")
    return load_world(folder / "m.map", "m.map", warnings)


def faults_of(folder: Path, text: str) -> tuple[Fault, ...]:
    with pytest.raises(InputError) as caught:
        world_of(folder, text)
    return caught.value.faults


def test_a_map_is_read_in_metres(tmp_path: Path) -> None:
    warnings = Faults()
    world = world_of(tmp_path, MAP, warnings)
    assert not warnings, [fault.as_text() for fault in warnings.in_order()]
    assert [(shape.id, shape.kind, shape.points.tolist(), shape.place.line) for shape in world.shapes] == [
        ("line1", "wall", [[0, 0], [2, 0]], 21), ("line2", "wall", [[2, 0], [2, 1.0005]], 22),
    ]  # fmt: skip
    assert world.robot.pose == (0.5, -0.25, math.pi / 2)
    assert world.home is not None and (world.home.id, world.home.theta_rad) == ("home", math.pi / 2)
    assert [(goal.id, goal.x_m, goal.theta_rad) for goal in world.goals] == [
        ("printer room", 1.0, None), ("window", 1.0, math.radians(45.5)), ("dock", 0.0, -math.pi / 2),
    ]  # fmt: skip
    assert [(line.id, line.kind, line.points.tolist()) for line in world.lines] == [("cliff", "forbidden", [[0, 0], [1, 0.5]])]


def test_areas_are_turned_about_the_origin(tmp_path: Path) -> None:
    areas = world_of(tmp_path, MAP).areas
    assert [(area.id, area.kind) for area in areas] == [("stairs", "forbidden"), ("lane", "one-way"), ("soft", "restrictive"), ("slow", "sector")]
    assert np.allclose(areas[0].points, [[0, 1], [0, 2], [-0.5, 2], [-0.5, 1]])
    assert areas[1].theta_rad == -math.pi / 2
    assert areas[3].points.tolist() == [[0, 0], [1, 0], [1, 0.2], [0.01, 0.25]]


def test_points_become_cells(tmp_path: Path) -> None:
    grid = world_of(tmp_path, MAP).grid
    assert grid is not None and grid.resolution_m == 0.05 and not grid.unknown.any()
    x, y, theta = grid.origin
    assert (round(x, 9), round(y, 9), theta) == (-0.1, -0.1, 0.0)
    assert np.argwhere(grid.occupied).tolist() == [[0, 0], [20, 22]]  # 1000 and 1001 mm share a cell


@pytest.mark.parametrize(
    ("corners", "origin", "size_m"),
    [
        ("", (0.0, 0.0), (10.05, 8.05)),
        ("MinPos: -1000 -500\nMaxPos: 11000 7000\n", (-1.0, -0.5), (12.05, 8.55)),
        ("LineMaxPos: 10000 9000\n", (0.0, 0.0), (10.05, 9.05)),
    ],
)
def test_points_in_a_room_of_lines_do_not_make_the_map_smaller(
    tmp_path: Path, corners: str, origin: tuple[float, float], size_m: tuple[float, float]
) -> None:
    room = "LINES\n0 0 10000 0\n10000 0 10000 8000\n10000 8000 0 8000\n0 8000 0 0\nDATA\n2000 2000\n2050 2000\n"
    grid = world_of(tmp_path, f"2D-Map\n{corners}{room}").grid
    assert grid is not None and np.allclose(grid.origin[:2], origin)
    assert np.allclose(np.array(grid.occupied.shape[::-1]) * grid.resolution_m, size_m)
    assert np.argwhere(grid.occupied).size == 4, "two points, and the lines are walls"


@pytest.mark.parametrize(
    ("name", "lines", "home", "bounds"),
    [
        ("office", 101, (1.0, 1.498, 0.0), (0, 0, 18.76, 14.0)),
        ("ActivMediaLab", 71, (7.76, 0.675, 0.0), (0, 0, 12.64, 5.759)),
        ("triangle", 9, (5.09, 3.58, math.radians(54)), (0, 0, 10.26, 10.08)),
    ],
)
def test_real_maps(name: str, lines: int, home: tuple[float, float, float], bounds: tuple[float, ...]) -> None:
    warnings = Faults()
    world = load_world(shared_file("data", "maps", f"aria_{name}.map"), warnings=warnings)
    assert not warnings and len(world.shapes) == lines and world.grid is None
    assert world.robot.pose == pytest.approx(home) and world.bounds_m() == pytest.approx(bounds)


@pytest.mark.parametrize(
    ("old", "new", "line", "column", "code", "message"),
    [
        ("2D-Map\n", "2D-Mapp\n", 1, 1, "no-arnl-map", "this is no ARNL map"),
        ("0 0 2000 0\n", "0 0 2000\n", 21, 1, "bad-number", "this is no row of LINES"),
        ("0 0 2000 0\n", "0 0 2000 0 7\n", 21, 1, "bad-number", "this is no row of LINES"),
        ("  2000 0 2000 1000.5", "  2000 0 nan 1000.5", 22, 3, "bad-number", "this is no row of LINES"),
        ("1000 900\n1001", "1000 9OO\n1001", 25, 1, "bad-number", "this is no row of DATA"),
        ("1001 901", "1001", 26, 1, "bad-number", "this is no row of DATA"),
        ("1001 901", "1e300 901", 24, 1, "bad-number", "a coordinate is out of range"),
        ("1001 901", "900000000 900000000", 1, 1, "too-large", "what the map holds lies too far apart"),
        ("NumLines: 2", "NumLines: two", 9, 1, "bad-number", "NumLines must be a whole number"),
        ("MinPos: -100 -60", "MinPos: -1e300 -60", 2, 1, "bad-number", "a coordinate is out of range"),
        ("MinPos: -100 -60", "MinPos: -100", 2, 1, "bad-number", "MinPos needs two numbers"),
        ("Resolution: 20", "Resolution: 0", 6, 1, "bad-number", "Resolution must be a number greater than 0"),
        ("PointsAreSorted: true", "Points are sorted", 5, 1, "bad-line", "this line is not understood"),
        ("Goal 1000 2000 45 ", "Goal 1000 nan 45 ", 12, 18, "bad-number", "this is no number"),
        ('"" ICON "cliff" 0 0 1000 500', '"" ICON', 15, 8, "bad-cairn", "this object has too few fields"),
        ('"cliff" 0 0 1000 500', '"cliff" 0 0 1000 5OO', 15, 8, "bad-cairn", "a ForbiddenLine needs two corners"),
        ('"stairs" 1000 0 2000 500', '"stairs"', 16, 8, "bad-cairn", "a ForbiddenArea needs two corners"),
    ],
)
def test_each_fault_is_told_with_its_place(tmp_path: Path, old: str, new: str, line: int, column: int, code: str, message: str) -> None:
    assert old in MAP
    faults = [fault for fault in faults_of(tmp_path, MAP.replace(old, new)) if fault.severity == "error"]
    assert [(fault.file, fault.line, fault.column, fault.code, fault.message) for fault in faults] == [("m.map", line, column, code, message)]
    assert faults[0].expected and faults[0].found


def test_a_map_without_data_is_a_fault(tmp_path: Path) -> None:
    (fault,) = faults_of(tmp_path, "2D-Map\nNumLines: 0\n")
    assert (fault.code, fault.message, fault.line) == ("missing-section", "there is neither a LINES nor a DATA section", 3)


def test_all_faults_are_told_at_once(tmp_path: Path) -> None:
    faults = faults_of(tmp_path, "2D-Map\nnonsense\nCairn: Goal\nLINES\n1 2 3\n4 5 6 x\n")
    assert [fault.line for fault in faults] == [2, 3, 5, 6]


@pytest.mark.parametrize(
    ("old", "new", "line", "code"),
    [
        ("NumLines: 2", "NumLines: 3", 9, "wrong-count"),
        ("NumPoints: 3", "NumPoints: 2", 4, "wrong-count"),
        ('"window"', '"printer room"', 13, "duplicate-id"),
        ("Cairn: DockLynx", "Cairn: Bell", 14, "unknown-cairn"),
        ('"soft" 0 0 1000 200', '"soft" 0 0 0 200', 18, "zero-area"),
    ],
)
def test_warnings(tmp_path: Path, old: str, new: str, line: int, code: str) -> None:
    warnings = Faults()
    assert world_of(tmp_path, MAP.replace(old, new), warnings)
    (warning,) = warnings.in_order()
    assert (warning.severity, warning.line, warning.code) == ("warning", line, code)


def test_other_dialects(tmp_path: Path) -> None:
    text = "2D-Map-Ex2\r\nSources: lms1 lms2\r\nlms2NumPoints: 1\r\n\r\nlms2_DATA\r\n5 5\r\n\r\nlms2_LINES\r\n0 0 1 1\r\nCustomInfo: a b\r\n"
    warnings = Faults()
    world = world_of(tmp_path, text, warnings)
    assert not warnings and len(world.shapes) == 1 and world.grid is not None and int(world.grid.occupied.sum()) == 1


def test_labels_of_old_editors_are_read(tmp_path: Path) -> None:
    (tmp_path / "m.map").write_bytes(MAP.replace("printer room", "Küche").encode("latin-1"))
    assert load_world(tmp_path / "m.map").goals[0].id == "Küche"


COORDINATES = st.integers(-9000, 9000)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=50)
@given(st.lists(st.tuples(*[COORDINATES] * 4), max_size=8), st.lists(st.tuples(*[COORDINATES] * 2), min_size=1, max_size=8))
def test_what_is_written_is_read_back(tmp_path: Path, lines: list[tuple[int, ...]], points: list[tuple[int, ...]]) -> None:
    rows, dots = ("\n".join(" ".join(map(str, row)) for row in table) for table in (lines, points))
    world = world_of(tmp_path, f"2D-Map\nNumLines: {len(lines)}\nLINES\n{rows}\nDATA\n{dots}\n")
    assert [tuple((shape.points * 1000).round().astype(int).ravel().tolist()) for shape in world.shapes] == lines
    grid = world.grid
    assert grid is not None
    centres = (np.argwhere(grid.occupied)[:, ::-1] + 0.5) * grid.resolution_m + grid.origin[:2]
    for point in points:
        assert np.abs(centres - np.array(point) / 1000).max(axis=1).min() <= 0.0251
    assert len(centres) <= len(points)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=100)
@given(st.data())
def test_a_damaged_map_is_read_or_refused(tmp_path: Path, data: st.DataObject) -> None:
    text = MAP
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(text)))
        text = text[:at] + data.draw(st.text('0 1-e."\nA:', max_size=3)) + text[at + data.draw(st.integers(0, 6)) :]
    try:
        world_of(tmp_path, text)
    except InputError as error:
        assert all(fault.line > 0 for fault in error.faults)
