"""Ways over hand-made maps: shortest by a slow twin, in the middle, inside the rectangle, or none."""

from __future__ import annotations

import heapq
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.skills.local_map import LocalMap
from pluto_bt.skills.motion_parameters import MotionParameters
from pluto_bt.skills.outline import outline_of
from pluto_bt.skills.rays import Openings, free_m, is_open
from pluto_bt.skills.rectangle import Rectangle
from pluto_bt.skills.ways import Ways

OUTLINE = outline_of([(0.585, 0.425), (-0.585, 0.425), (-0.585, -0.425), (0.585, -0.425)])
HERE = (0.0, 0.0, 0.0)


def ground(*walls: tuple[float, float, float, float], size_m: float = 20.0) -> LocalMap:
    """A map on which a square is known to be free but for boxes (x0, y0, x1, y1)."""
    map = LocalMap(MotionParameters())
    i0, j0 = map.cell(-size_m, -size_m)
    i1, j1 = map.cell(size_m, size_m)
    map.evidence[i0:i1, j0:j1] = -4
    for x0, y0, x1, y1 in walls:
        a, b = map.cell(x0, y0), map.cell(x1, y1)
        map.evidence[a.i : b.i + 1, a.j : b.j + 1] = 6
    map.changed_around(0.0, 0.0, size_m + 6.0)
    map.refresh(0.0)
    return map


def test_over_open_ground_a_way_is_straight_and_ends_at_the_goal() -> None:
    way = Ways(ground(), OUTLINE).to_goal(HERE, (8.0, 0.0), None)
    assert way is not None and way.leads_there
    assert math.dist(way.points[-1], (8.0, 0.0)) < 0.5
    assert way.length_m < 8.6


def test_between_two_walls_the_way_runs_in_the_middle() -> None:
    map = ground((2.0, 2.0, 18.0, 2.5), (2.0, -4.5, 18.0, -4.0))
    way = Ways(map, OUTLINE).to_goal(HERE, (17.0, -1.0), None)
    assert way is not None
    inner = [y for x, y in way.points.tolist() if 6.0 < x < 14.0]
    assert max(abs(y + 1.0) for y in inner) < 0.5


def test_a_wide_gap_is_taken_rather_than_a_nearer_narrow_one_and_one_too_narrow_never() -> None:
    wide_and_narrow = ground((5.0, -20.0, 5.5, -9.0), (5.0, -5.0, 5.5, -0.8), (5.0, 0.8, 5.5, 20.0))
    way = Ways(wide_and_narrow, OUTLINE).to_goal(HERE, (10.0, -3.0), None)
    assert way is not None and min(y for x, y in way.points.tolist() if 4.5 < x < 6.0) < -5.0
    too_narrow = ground((5.0, -30.0, 5.5, -0.5), (5.0, 0.5, 5.5, 30.0), size_m=20.0)
    way = Ways(too_narrow, OUTLINE).to_goal(HERE, (10.0, 0.0), None)
    assert way is None or max(abs(y) for x, y in way.points.tolist() if 5.0 <= x <= 5.5) > 5.0


def test_there_is_no_way_out_of_a_closed_room() -> None:
    room = ground((-5.0, -5.0, 5.0, -4.5), (-5.0, 4.5, 5.0, 5.0), (-5.0, -5.0, -4.5, 5.0), (4.5, -5.0, 5.0, 5.0))
    assert Ways(room, OUTLINE).to_goal(HERE, (10.0, 0.0), None) is None


def test_what_is_not_known_may_be_free_and_a_goal_beyond_the_map_is_headed_for() -> None:
    way = Ways(ground(size_m=5.0), OUTLINE).to_goal(HERE, (500.0, 100.0), None)
    assert way is not None and not way.leads_there
    assert way.points[-1][0] > 60.0


def test_a_way_stays_inside_the_rectangle_and_is_none_where_only_outside_is_one() -> None:
    rectangle = Rectangle(3.0, 15.0, (-1.0, 0.0, 0.0))
    ways = Ways(ground((5.0, -2.0, 5.5, 20.0)), OUTLINE)
    way = ways.to_goal(HERE, (10.0, 0.0), rectangle)
    assert way is None, "the wall leaves 1 m to the rectangle's side, but edge and clearance take more"
    roomy = Rectangle(8.0, 15.0, (-1.0, 0.0, 0.0))
    way = ways.to_goal(HERE, (10.0, 0.0), roomy)
    assert way is not None and min(roomy.depth_m(x, y) for x, y in way.points.tolist()) >= 0.0


def test_new_ground_is_the_nearest_that_is_not_covered() -> None:
    map = ground()
    map.covered[:] = 1
    i, j = map.cell(6.0, 3.0)
    map.covered[i - 4 : i + 5, j - 4 : j + 5] = 0
    far_i, far_j = map.cell(-15.0, -15.0)
    map.covered[far_i - 4 : far_i + 5, far_j - 4 : far_j + 5] = 0
    way = Ways(map, OUTLINE).to_new_ground(HERE, Rectangle(18.0, 38.0, (-19.0, 0.0, 0.0)))
    assert way is not None and math.dist(way.points[-1], (6.0, 3.0)) < 2.0
    map.covered[:] = 1
    assert Ways(map, OUTLINE).to_new_ground(HERE, Rectangle(18.0, 38.0, (-19.0, 0.0, 0.0))) is None


@given(seed=st.integers(0, 500))
@settings(max_examples=10, deadline=None)
def test_a_way_is_at_most_half_dearer_than_the_cheapest_by_a_slow_twin_and_none_only_if_there_is_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    boxes = [(x, y, x + rng.uniform(0.3, 3.0), y + rng.uniform(0.3, 3.0)) for x, y in rng.uniform(-8.0, 8.0, (8, 2)) if math.hypot(x, y) > 4.5]
    map = ground(*boxes, size_m=12.0)
    ways = Ways(map, OUTLINE)
    goal = (float(rng.uniform(-9.0, 9.0)), float(rng.uniform(-9.0, 9.0)))
    way = ways.to_goal(HERE, goal, None)
    cheapest = slow_cheapest_m(map, goal, ways.least_m)
    assert (way is None) == (cheapest is None)
    if way is not None and cheapest is not None:
        assert way.length_m <= 2.5 * cheapest + 1.0
        assert cheapest <= way.length_m + 1.0
        inner = [p for p in way.points.tolist() if math.hypot(*p) > 1.3 and math.dist(p, goal) > 1.3]
        assert all(map.clearance_m(x, y) >= ways.least_m - 1e-6 for x, y in inner)


def slow_cheapest_m(map: LocalMap, goal: tuple[float, float], least_m: float) -> float | None:
    """Length of the shortest way by a plain Dijkstra over the same cells, no costs but length."""
    start, end = map.cell(0.0, 0.0), map.cell(*goal)
    reach = 0.3 / map.cell_m
    best = {start: 0.0}
    queue = [(0.0, start)]
    while queue:
        far, (i, j) = heapq.heappop(queue)
        if far > best[(i, j)]:
            continue
        if math.hypot(i - end.i, j - end.j) <= reach:
            return far * map.cell_m
        for a in (i - 1, i, i + 1):
            for b in (j - 1, j, j + 1):
                if (a, b) == (i, j) or not (0 <= a < len(map.evidence) and 0 <= b < len(map.evidence)) or map.evidence[a, b] > 0:
                    continue
                near = min(math.hypot(a - start.i, b - start.j), math.hypot(a - end.i, b - end.j)) <= 1.2 / map.cell_m
                free = float(map.clearance[a, b])
                if free < (1.0 if near else least_m / map.cell_m):
                    continue
                new = far + math.hypot(a - i, b - j)
                if new < best.get((a, b), math.inf):
                    best[(a, b)] = new
                    heapq.heappush(queue, (new, (a, b)))
    return None


def test_a_corridor_is_open_as_far_as_its_width_fits() -> None:
    map = ground((5.0, 1.0, 5.5, 4.0))
    assert free_m(map, 0.0, 0.0, 0.0, 0.9, 10.0) == pytest.approx(10.0)
    assert 3.0 < free_m(map, 0.0, 0.0, 0.0, 1.5, 10.0) < 5.5
    assert is_open(map, (0.0, 0.0), (10.0, 0.0), 0.9) and not is_open(map, (0.0, 0.0), (10.0, 0.0), 1.5)


def test_an_opening_at_the_side_of_a_street_is_told_once_where_it_begins() -> None:
    street = ground((-20.0, 3.0, 4.0, 3.5), (9.0, 3.0, 20.0, 3.5), (-20.0, -3.5, 20.0, -3.0))
    openings = Openings(street)
    told = [(x, side) for x in np.arange(-10.0, 18.0, 0.1) if (side := openings.look((float(x), 0.0, 0.0), 0.0))]
    assert [side for _, side in told] == ["left"]
    assert 4.0 < told[0][0] < 7.5


def posts(x_m: float, apart_m: float) -> list[tuple[float, float, float, float]]:
    """A fence of posts along x."""
    return [(x_m, y_m, x_m, y_m) for y_m in np.arange(-20.0, 20.0, apart_m).tolist()]


def test_no_way_leads_through_a_fence_of_posts_to_a_goal_just_behind_it() -> None:
    ways = Ways(ground(*posts(5.0, 1.0)), OUTLINE)
    assert ways.to_goal(HERE, (3.8, 0.4), None) is not None
    way = ways.to_goal(HERE, (6.2, 0.4), None)
    assert way is None or max(abs(y) for _, y in way.points.tolist()) > 15.0


def test_a_goal_beside_a_wall_is_reached_as_near_as_it_lies_and_so_is_the_way_from_there() -> None:
    ways = Ways(ground((5.0, -20.0, 5.5, 20.0)), OUTLINE)
    for a, b in ((HERE, (4.5, 3.0)), ((4.5, 3.0, 0.0), (0.0, 0.0))):
        way = ways.to_goal(a, b, None)
        assert way is not None and math.dist(way.points[-1], b) < 0.5


def test_what_was_shut_is_open_again_but_not_what_was_seen_there_since() -> None:
    map = ground()
    map.shut(3.0, 0.0, 0.5, 10.0)
    map.shut(3.0, 6.0, 0.5, 10.1)
    seen = map.cell(3.0, 6.0)
    map.low_s[seen] = 12.0
    map.refresh(12.0)
    assert map.clearance_m(3.0, 0.0) == 0.0 and map.clearance_m(3.0, 6.0) == 0.0
    assert map.reopen(12.0)
    map.refresh(12.0)
    assert map.clearance_m(3.0, 0.0) > 4.0 and map.clearance_m(3.0, 6.0) == 0.0
    assert map.clearance_m(3.4, 6.0) > 0.0
    assert not map.reopen(12.0), "once"


def test_a_door_beside_home_is_passed_although_the_edge_of_the_rectangle_runs_through_it() -> None:
    wall = ((-20.0, 1.5, -1.2, 1.75), (1.2, 1.5, 20.0, 1.75))
    rectangle = Rectangle(12.0, 8.0, (0.3, 1.2, math.radians(30.0)))
    ways = Ways(ground(*wall), OUTLINE)
    way = ways.to_goal((2.0, 5.0, 0.0), (4.5, 0.0), rectangle)
    assert rectangle.holds(4.5, 0.0)
    assert way is not None and min(rectangle.depth_m(x, y) for x, y in way.points.tolist()) > -0.3
    far = rectangle._replace(home=(3.3, 1.2 - 3.0 * math.sqrt(3.0), math.radians(30.0)), base_m=18.0)
    assert abs(far.depth_m(0.3, 1.2)) < 0.01, "the same base, home elsewhere on it"
    assert ways.to_goal((2.0, 5.0, 0.0), (4.5, 0.0), far) is None
