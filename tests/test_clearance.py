"""How near things are to the robot's outline: against shapely, and told in small stories."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from random_worlds import cells, random_world, star

from pluto_bt.maps.clearance import between, path_is_clear
from pluto_bt.maps.geometry import transform_points
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import OccupancyGrid, Shape, World

SEEDS = st.integers(0, 2**32)
ROBOT = np.array([(0.5, 0.35), (-0.5, 0.35), (-0.5, -0.35), (0.5, -0.35), (0.6, 0.0)])


def at(points, x_m, y_m):
    return points + np.array((x_m, y_m))


def things(world):
    """(owner, shapely geometry, radius) of everything solid."""
    for shape in world.shapes:
        if shape.kind == "circle":
            yield shape.id, shapely.Point(shape.points[0]), shape.radius_m
        elif shape.kind == "wall":
            yield shape.id, shapely.LineString(shape.points), 0.0
        elif shape.kind == "polygon":
            yield shape.id, shapely.Polygon(shape.points), 0.0
    for actor in world.actors:
        yield actor.id, shapely.Point(actor.waypoints[0]), actor.radius_m
    if world.grid is not None:
        yield "map", shapely.MultiPolygon([shapely.Polygon(square) for square in cells(world.grid)]), 0.0


def gaps(world, outline):
    polygon = shapely.Polygon(outline)
    return {owner: max(0.0, polygon.distance(thing) - radius_m) for owner, thing, radius_m in things(world) if not thing.is_empty}


@settings(max_examples=80, deadline=None)
@given(seed=SEEDS, with_grid=st.booleans(), star_shaped=st.booleans())
def test_clearance_and_contacts_in_any_world(seed, with_grid, star_shaped):
    world, rng = random_world(seed, grid=with_grid)
    outline = star(rng, 0.0, 0.0, rng.uniform(0.3, 3.0)) if star_shaped else ROBOT
    outline = transform_points((*rng.uniform(-9, 9, 2), float(rng.uniform(-3, 3))), outline)
    expected = gaps(world, outline)
    scene = Scene(world)
    nearest = scene.clearance(outline)
    assert nearest.distance_m == pytest.approx(min(expected.values(), default=math.inf), rel=0, abs=1e-9)
    if expected:
        assert expected[nearest.owner] == pytest.approx(nearest.distance_m, rel=0, abs=1e-9)
        spot = shapely.Point(nearest.x_m, nearest.y_m)
        assert shapely.Polygon(outline).distance(spot) == pytest.approx(nearest.distance_m, rel=0, abs=1e-9)
        geometry, radius_m = {owner: (thing, radius_m) for owner, thing, radius_m in things(world)}[nearest.owner]
        assert geometry.distance(spot) <= radius_m + 1e-9
    assert sorted(contact.owner for contact in scene.contacts(outline)) == sorted(owner for owner, gap in expected.items() if gap == 0.0)
    for contact in scene.contacts(outline):
        assert contact.distance_m == 0.0
        assert shapely.Polygon(outline).distance(shapely.Point(contact.x_m, contact.y_m)) < 1e-9


def polygon(id, points, kind="polygon"):
    return Shape(id, kind, np.array(points, dtype=float))


SQUARE = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


def test_nothing_in_the_world_is_infinitely_far():
    nearest = Scene(World("w")).clearance(ROBOT)
    assert (nearest.distance_m, nearest.owner) == (math.inf, "")
    assert Scene(World("w")).contacts(ROBOT) == []


@pytest.mark.parametrize(
    ("points", "distance_m"),
    [(SQUARE * 9, 0.0), (SQUARE * 0.1, 0.0), (at(SQUARE, 2.6, 0), 1.0), (at(SQUARE, 1.6, 0), 0.0), (at(SQUARE * 0.5, 0.0, -2.35), 1.5)],
    ids=["robot inside", "inside the robot", "ahead", "just touching", "beside"],
)
def test_a_square(points, distance_m):
    assert Scene(World("w", shapes=(polygon("p", points),))).clearance(ROBOT).distance_m == pytest.approx(distance_m, abs=1e-12)


def test_a_wall_wholly_under_the_robot_is_a_contact():
    scene = Scene(World("w", shapes=(Shape("wire", "wall", np.array([[0.0, 0.1], [0.2, 0.1]])),)))
    assert [contact.owner for contact in scene.contacts(ROBOT)] == ["wire"]


def test_a_hole_is_not_solid_but_told():
    scene = Scene(World("w", shapes=(polygon("pit", at(SQUARE, 1.5, 0), "hole"), polygon("far", at(SQUARE, 50, 0), "hole"))))
    assert scene.clearance(ROBOT).distance_m == math.inf
    assert scene.hole(ROBOT)[::3] == (0.0, "pit")
    assert scene.hole(at(ROBOT * 0.1, 50, 0))[::3] == (0.0, "far"), "wholly over it"
    assert scene.hole(ROBOT * 100)[::3] == (0.0, "pit"), "all around it"
    assert scene.hole(at(ROBOT, -1.0, 0)).distance_m == pytest.approx(0.9, abs=1e-12)
    assert scene.hole(at(ROBOT, 47.0, 0))[::3] == (pytest.approx(1.4, abs=1e-12), "far"), "the nearest of both"
    scene.remove("pit")
    scene.remove("far")
    assert scene.hole(ROBOT).owner == ""


def test_deep_inside_the_solid_part_of_a_map_is_contact():
    occupied = np.ones((90, 90), dtype=np.uint8)
    scene = Scene(World("w", grid=OccupancyGrid(occupied, occupied * 0, 0.1, (-4.5, -4.5, 0.0))))
    assert scene.clearance(ROBOT).distance_m == 0.0
    assert [contact.owner for contact in scene.contacts(ROBOT)] == ["map"]
    assert scene.clearance(at(ROBOT, 5.6, 0.0)).distance_m == pytest.approx(0.6)


def test_a_cell_wholly_under_a_large_robot_is_contact_whatever_else_is_near():
    occupied = np.zeros((40, 40), dtype=np.uint8)
    occupied[20, 20] = occupied[5, 20] = 1
    grid = OccupancyGrid(occupied, occupied * 0, 0.1, (0.0, 0.0, 0.0))
    scene = Scene(World("w", grid=grid, shapes=(polygon("p", at(SQUARE, 2.05, 4.10)),)))
    outline = at(SQUARE, 2.05, 2.05)
    assert scene.clearance(outline).distance_m == 0.0
    assert [contact.owner for contact in scene.contacts(outline)] == ["map"]


def test_a_map_far_away_has_the_exact_distance():
    occupied = np.zeros((3, 700), dtype=np.uint8)
    occupied[1, 699] = 1
    scene = Scene(World("w", grid=OccupancyGrid(occupied, occupied * 0, 0.1, (0.0, -0.15, 0.0))))
    assert scene.clearance(at(ROBOT, 2.0, 0.0)).distance_m == pytest.approx(69.9 - 2.6)
    assert scene.clearance(at(ROBOT, -30.0, 0.0)).distance_m == pytest.approx(69.9 + 29.4)


@pytest.mark.parametrize("bad", [[(0, 0), (1, 0)], [(0, 0), (1, 0), (math.nan, 1)], [0, 1, 2], [(0, 0), (1, math.inf), (0, 1)]])
def test_an_outline_that_is_none_is_refused(bad):
    for question in (Scene(World("w")).clearance, Scene(World("w")).contacts):
        with pytest.raises(ValueError, match="outline"):
            question(bad)


# moving


def gap_of(width_m):
    return World("w", shapes=(polygon("left", at(SQUARE, 5.0, 1.0 + width_m / 2)), polygon("right", at(SQUARE, 5.0, -1.0 - width_m / 2))))


@pytest.mark.parametrize(("width_m", "margin_m", "free"), [(0.72, 0.0, True), (0.68, 0.0, False), (0.72, 0.02, False), (0.75, 0.02, True)])
def test_a_way_through_a_gap(width_m, margin_m, free):
    blocked = path_is_clear(Scene(gap_of(width_m)), ROBOT, [(0.0, 0.0, 0.0), (10.0, 0.0, 0.0)], margin_m)
    assert (blocked is None) == free


def test_a_blocked_way_tells_where_and_by_what():
    scene = Scene(World("w", shapes=(Shape("fence", "wall", np.array([[5.0, -3.0], [5.0, 3.0]])),)))
    blocked = path_is_clear(scene, ROBOT, [(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (9.0, 0.0, 0.0)])
    assert blocked is not None
    assert (blocked.leg, blocked.nearest.owner) == (1, "fence")
    assert blocked.pose_map_robot[0] == pytest.approx(4.4, abs=0.011)


def test_turning_on_the_spot_sweeps_the_corners():
    scene = Scene(World("w", shapes=(Shape("post", "circle", np.array([[0.0, 0.58]]), 0.02),)))
    assert scene.clearance(ROBOT).distance_m > 0.1
    assert path_is_clear(scene, ROBOT, [(0.0, 0.0, 0.0), (0.0, 0.0, math.pi / 2)]) is not None


@pytest.mark.parametrize(("poses", "blocked"), [([], False), ([(0.0, 0.0, 0.0)], True)])
def test_ways_of_no_length(poses, blocked):
    scene = Scene(World("w", shapes=(polygon("p", SQUARE),)))
    assert (path_is_clear(scene, ROBOT, poses) is not None) == blocked


def test_turning_goes_the_short_way():
    assert between((0.0, 0.0, 3.0), (2.0, 0.0, -3.0), 0.5) == pytest.approx((1.0, 0.0, math.pi))
