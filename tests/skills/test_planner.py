"""Planning on the map: against a flood of the grid, in worlds drawn at random, and what a person would expect of a way."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pluto_bt.maps.raster import OCCUPIED, UNKNOWN, Frame, drawn, frame_of
from pluto_bt.maps.world import Area, Line, OccupancyGrid, Shape, World
from pluto_bt.skills.outline import outline_of
from pluto_bt.skills.plan_map import PlanMap
from pluto_bt.skills.plan_parameters import PlanParameters
from pluto_bt.skills.planner import Planner

BOX = ((0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.3, -0.2))
CELL_M = 0.1


def planner_on(world: World, **parameters: float) -> Planner:
    return Planner(PlanMap(world), outline_of(BOX), PlanParameters(**parameters))


def walled(size: int, blocks: list[tuple[int, int, int, int]]) -> World:
    """A scanned map with a wall round it; blocks are (row, column, height, width) in cells."""
    occupied = np.zeros((size, size), dtype=np.uint8)
    occupied[[0, -1], :] = occupied[:, [0, -1]] = 1
    for row, column, height, width in blocks:
        occupied[row : row + height, column : column + width] = 1
    return World("walled", grid=OccupancyGrid(occupied, np.zeros_like(occupied), CELL_M, (-3.0, 2.0, 0.4)))


def reachable(free: NDArray[np.bool_], start: tuple[int, int]) -> NDArray[np.bool_]:
    """All cells that a king on the chessboard comes to: the slow twin of the search."""
    found = np.zeros_like(free)
    waiting = [start]
    found[start] = True
    while waiting:
        i, j = waiting.pop()
        for a in range(i - 1, i + 2):
            for b in range(j - 1, j + 2):
                if 0 <= a < free.shape[0] and 0 <= b < free.shape[1] and free[a, b] and not found[a, b]:
                    found[a, b] = True
                    waiting.append((a, b))
    return found


@pytest.mark.parametrize("seed", range(12))
def test_a_way_is_found_exactly_where_there_is_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    blocks = [tuple(int(n) for n in (*rng.integers(2, 110, 2), *rng.integers(2, 40, 2))) for _ in range(16)]
    planner = planner_on(walled(120, blocks))  # type: ignore[arg-type]
    room = planner.map.clearance * CELL_M > planner.least_m + 0.05
    cells = np.argwhere(room)
    start, *goals = (tuple(int(n) for n in cells[rng.integers(len(cells))]) for _ in range(6))
    open_to = reachable(planner.map.clearance * CELL_M >= planner.least_m, start)  # type: ignore[arg-type]
    for goal in goals:
        a, b = (tuple(planner.map.frame.to_map(np.array([cell]) + 0.5)[0]) for cell in (start, goal))
        way = planner.plan(a, b, 0.3)
        if not open_to[goal]:
            assert way is None or planner.map.clearances_m(way).min() < planner.least_m  # through a gap near one of the ends, at most
            continue
        assert way is not None
        assert way[0] == pytest.approx(a) and way[-1] == pytest.approx(b)
        assert planner.map.clearances_m(way).min() > planner.least_m - 1.5 * CELL_M
        assert np.hypot(*np.diff(way, axis=0).T).max() < 0.2


def test_an_open_field_is_crossed_straight() -> None:
    planner = planner_on(World("field"), gap_m=0.2)
    planner = Planner(PlanMap(World("field"), [(0.0, 0.0), (12.0, 5.0)]), outline_of(BOX), PlanParameters())
    way = planner.plan((0.0, 0.0), (12.0, 5.0), 0.3)
    assert way is not None and planner.length_m(way) == pytest.approx(13.0, rel=1e-3)


def test_a_corner_is_rounded_and_the_middle_of_a_corridor_kept() -> None:
    planner = planner_on(walled(200, [(20, 20, 160, 160)]))  # a corridor of 1.9 m round a block
    frame = planner.map.frame
    a, b = (tuple(frame.to_map(np.array([cell]))[0]) for cell in ((10.0, 100.0), (100.0, 190.0)))
    way = planner.plan(a, b, 0.3)
    assert way is not None
    assert np.median(planner.map.clearances_m(way)) > 0.75
    headings = np.unwrap(np.arctan2(*np.diff(way, axis=0).T[::-1]))
    assert np.abs(np.diff(headings)).max() < math.radians(15), "no kinks"
    assert abs(headings[-1] - headings[0]) == pytest.approx(math.pi / 2, abs=0.4) and np.ptp(headings) < math.radians(110), "one turn, no wiggling"


def test_the_wider_door_is_worth_a_small_detour() -> None:
    wall = [(0, 60, 30, 2), (36, 60, 24, 2), (75, 60, 45, 2)]  # doors of 0.6 and 1.5 m in one wall
    planner = planner_on(walled(120, wall), gap_m=0.05)
    frame = planner.map.frame
    a, b = (tuple(frame.to_map(np.array([cell]))[0]) for cell in ((40.0, 30.0), (40.0, 90.0)))
    way = planner.plan(a, b, 0.3)
    assert way is not None
    assert planner.map.clearances_m(way).min() > 0.5


FORBIDDEN = Area("pool", "forbidden", np.array([(2.0, -3.0), (4.0, -3.0), (4.0, 3.0), (2.0, 3.0)]))


@pytest.mark.parametrize(
    "more",
    [
        {"areas": (FORBIDDEN,)},
        {"lines": (Line("line", "forbidden", np.array([(3.0, -3.0), (3.0, 3.0)])),)},
        {"shapes": (Shape("pit", "hole", FORBIDDEN.points),)},
        {"shapes": (Shape("house", "polygon", FORBIDDEN.points),)},
    ],
)
def test_ways_keep_out_of_what_is_forbidden(more: dict[str, Any]) -> None:
    world = World("w", **more)
    planner = Planner(PlanMap(world, [(0.0, 0.0), (6.0, 0.0)]), outline_of(BOX), PlanParameters())
    way = planner.plan((0.0, 0.0), (6.0, 0.0), 0.3)
    assert way is not None
    beside = np.abs(way[np.abs(way[:, 0] - 3.0) < 0.1, 1])
    assert len(beside) and beside.min() > 3.0 + 0.2


def test_ways_stay_inside_the_mapped_area() -> None:
    corners = np.array([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (6.0, 10.0), (6.0, 3.0), (4.0, 3.0), (4.0, 10.0), (0.0, 10.0)])  # a U
    planner = planner_on(World("u", areas=(Area("m", "map", corners),)))
    way = planner.plan((2.0, 9.0), (8.0, 9.0), 0.3)
    assert way is not None
    assert way[np.abs(way[:, 0] - 5.0) < 0.5, 1].max() < 3.0


def test_what_is_seen_is_laid_over_the_map_and_taken_back() -> None:
    planner = planner_on(walled(100, [(0, 48, 40, 4), (60, 48, 40, 4)]))  # two rooms with a door of 2 m
    frame = planner.map.frame
    a, b = (tuple(frame.to_map(np.array([cell]))[0]) for cell in ((50.0, 20.0), (50.0, 80.0)))
    assert planner.plan(a, b, 0.3) is not None
    before = planner.map.clearance.copy()
    door = frame.to_map(np.column_stack((np.arange(40.0, 60.0, 0.5), np.full(40, 50.0))))
    planner.map.lay_over(door)
    assert planner.plan(a, b, 0.3) is None and len(planner.map.unexplained())
    planner.map.lay_over(frame.to_map(np.array([(50.0, 49.0)])))
    assert planner.plan(a, b, 0.3) is not None  # beside a post in the door
    planner.map.lay_over(np.zeros((0, 2)))
    assert np.array_equal(planner.map.clearance, before)


def test_what_the_map_shows_itself_is_not_seen_as_something_new() -> None:
    planner = planner_on(walled(100, [(40, 40, 20, 20)]))
    edge = planner.map.frame.to_map(np.column_stack((np.full(20, 40.0 - 1.5), np.arange(40.0, 60.0))))
    planner.map.lay_over(edge)
    assert not len(planner.map.unexplained())


def test_large_maps_are_taken_in_larger_cells_and_nothing_is_lost() -> None:
    occupied = np.zeros((5000, 30), dtype=np.uint8)
    occupied[1234, 17] = 1
    unknown = np.zeros_like(occupied)
    unknown[4999, 29] = 1
    world = World("long", grid=OccupancyGrid(occupied, unknown, 0.02, (0.0, 0.0, 0.0)))
    frame = frame_of(world, ())
    cells = drawn(world, frame)
    assert (frame.rows, frame.columns, frame.cell_m) == (1667, 10, pytest.approx(0.06))
    assert cells[1234 // 3, 17 // 3] == OCCUPIED and (cells == OCCUPIED).sum() == 1
    assert cells[-1, -1] == UNKNOWN


def test_a_frame_leads_there_and_back() -> None:
    frame = Frame((3.0, -2.0, 0.7), 0.05, 200, 100)
    points = np.random.default_rng(0).uniform(-5.0, 5.0, (20, 2))
    assert frame.to_map(frame.to_cells(points)) == pytest.approx(points)
    assert frame.has(3.0, -1.9) is bool(frame.to_cells(np.array([(3.0, -1.9)])).min() >= 0.0)


def test_a_bend_that_a_long_robot_cannot_take_is_told() -> None:
    planner = planner_on(walled(200, [(0, 0, 90, 200), (104, 0, 96, 90), (104, 104, 96, 96)]))  # two corridors of 1.4 m that meet
    frame = planner.map.frame
    a, b = (tuple(frame.to_map(np.array([cell]))[0]) for cell in ((97.0, 20.0), (180.0, 97.0)))
    way = planner.plan(a, b, 0.3)
    assert way is not None and planner.tight_place(way) is None
    long = ((1.3, 0.3), (-1.3, 0.3), (-1.3, -0.3), (1.3, -0.3))
    planner = Planner(planner.map, outline_of(long), PlanParameters())
    way = planner.plan(a, b, 0.3)
    assert way is not None
    place = planner.tight_place(way)
    assert place is not None
    corner = frame.to_map(np.array([(97.0, 97.0)]))[0]
    assert math.dist(place, corner) < 2.5
