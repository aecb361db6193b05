"""The body among what stands and walks: it stops at the first touch, is free to back off, and every contact is told once."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point, Polygon
from sim_worlds import at, box, cart, of_type, points, room, run

from drivers.records import BumperRecord, OdometryRecord
from pluto_bt.maps.platform import Bumpers
from pluto_bt.maps.script import Put, Remove
from pluto_bt.maps.world import Actor, OccupancyGrid, Shape, World
from sim import Simulator


def test_the_robot_stops_exactly_at_a_wall_and_the_collision_is_told_once_with_place_time_and_speed() -> None:
    sim = run(Simulator(room(), cart(), 0), 12.0, 0.6)
    assert sim.pose[0] == pytest.approx(4.5, abs=1e-5)
    assert sim.pose[0] < 4.5
    assert sim.velocity == (0.0, 0.0)
    (contact,) = sim.collisions
    assert contact.with_id == "walls"
    assert contact.x_m == pytest.approx(5.0) and abs(contact.y_m) <= 0.41
    assert contact.speed_mps == pytest.approx(0.6, rel=1e-3)
    assert contact.t_s == pytest.approx(0.15 + 4.5 / 0.6, abs=0.02)  # 0.15 s: what speeding up costs, v / 2a
    assert sim.hit_by == []
    assert sim.min_clearance_m == pytest.approx(0.0, abs=1e-5)


def test_wheels_go_on_turning_against_a_wall_and_the_robot_is_free_to_back_off() -> None:
    sim = run(Simulator(room(), cart(), 0), 12.0, 0.6)
    last = of_type(sim.devices["base"].read(), OdometryRecord)[-1]
    assert last.distance_m == pytest.approx(12.0 * 0.6 - 0.09, abs=0.01)
    assert sim.distance_m == pytest.approx(4.5, abs=1e-4)
    run(sim, 2.0, -0.5)
    assert sim.pose[0] == pytest.approx(4.5 - 2.0 * 0.5, abs=0.25)
    run(sim, 6.0, 0.5)
    assert [contact.with_id for contact in sim.collisions] == ["walls", "walls"]


def test_pushing_on_against_a_wall_stays_one_contact() -> None:
    sim = run(Simulator(room(), cart(), 0), 9.0, 0.6)
    for _ in range(5):
        run(sim, 0.5, 0.0)
        run(sim, 0.5, 0.6)
    assert len(sim.collisions) == 1


def test_turning_into_something_is_a_collision_of_the_corner() -> None:
    post = Shape("post", "circle", points((0.0, 0.55)), radius_m=0.1)
    sim = run(Simulator(room(post), cart(), 0), 2.0, 0.0, 0.8)
    (contact,) = sim.collisions
    assert contact.with_id == "post"
    assert 0.0 < contact.speed_mps <= 0.8 * math.hypot(0.5, 0.4)
    assert Polygon(sim.outline_m).distance(Point(0.0, 0.55)) == pytest.approx(0.1, abs=1e-5)


def test_touching_slower_than_0_05_mps_is_no_collision() -> None:
    sim = run(Simulator(room(), cart(), 0, start=(4.48, 0.0, 0.0)), 3.0, 0.03)
    assert sim.collisions == []
    assert [contact.with_id for contact in sim.hit_by] == ["walls"]


def test_an_actor_that_walks_into_the_standing_robot_has_hit_it_once_and_walks_on() -> None:
    walker = Actor("person", 0.25, 1.0, False, points((4.0, 0.1), (-4.0, 0.1)))
    sim = run(Simulator(room(actors=(walker,)), cart(), 0), 8.0)
    assert sim.collisions == []
    (contact,) = sim.hit_by
    assert contact.with_id == "person"
    assert contact.t_s == pytest.approx(4.0 - 0.5 - 0.25, abs=0.02)
    assert contact.x_m == pytest.approx(0.5, abs=0.03)
    assert sim.pose == (0.0, 0.0, 0.0)
    assert sim.actors["person"] == pytest.approx((-4.0, 0.1, 0.25))


def test_each_round_of_a_looping_actor_is_its_own_contact() -> None:
    walker = Actor("person", 0.25, 2.0, True, points((0.0, 3.0), (0.0, -3.0)))
    sim = run(Simulator(room(actors=(walker,)), cart(), 0), 6.0)
    assert [contact.with_id for contact in sim.hit_by] == ["person", "person"]


@pytest.mark.parametrize(("speed_mps", "collides"), [(0.4, True), (0.0, False), (-0.3, False)])
def test_an_actor_met_head_on_is_a_collision_only_if_the_robot_drives_towards_it(speed_mps: float, collides: bool) -> None:
    walker = Actor("person", 0.25, 1.0, False, points((4.0, 0.0), (-4.0, 0.0)))
    sim = run(Simulator(room(actors=(walker,)), cart(), 0), 5.2, speed_mps)
    assert [contact.with_id for contact in sim.collisions] == ["person"] * collides
    assert [contact.with_id for contact in sim.hit_by] == ["person"] * (not collides)


def test_a_robot_in_the_middle_of_an_actor_may_leave_it() -> None:
    walker = Actor("person", 0.25, 1.0, False, points((2.0, 0.0), (0.45, 0.0)))
    sim = run(Simulator(room(actors=(walker,)), cart(), 0), 3.0)
    run(sim, 2.0, 0.3)
    assert sim.pose[0] == pytest.approx(0.0, abs=1e-3)
    run(sim, 4.0, -0.3)
    assert sim.pose[0] < -1.0
    assert (len(sim.collisions), len(sim.hit_by)) == (0, 1)


def test_something_placed_on_the_robot_has_hit_it_and_something_removed_lets_it_pass() -> None:
    world = room(box("door", 2.0, -5.0, 0.1, 10.0), box("crate", 0.0, 0.0, 0.2, 0.2, absent=True), script=(at(1.0, Put("crate", 0.4, 0.3)),
                 at(2.0, Remove("crate")), at(7.0, Remove("door"))))  # fmt: skip
    sim = run(Simulator(world, cart(), 0), 2.5)
    assert [(contact.with_id, contact.t_s) for contact in sim.hit_by] == [("crate", pytest.approx(1.01))]
    run(sim, 4.4, 0.6)
    assert sim.pose[0] == pytest.approx(1.5, abs=1e-5)
    run(sim, 4.0, 0.6)
    assert sim.pose[0] > 2.5
    assert [contact.with_id for contact in sim.collisions] == ["door"]


PIT = Shape("pit", "hole", points((2.0, -1.0), (3.0, -1.0), (3.0, 1.0), (2.0, 1.0)))


@settings(max_examples=25, deadline=None)
@given(st.floats(-2.0, 1.0), st.floats(-0.9, 0.9), st.floats(-0.6, 0.6), st.floats(0.1, 1.0))
def test_own_speed_towards_a_hole_is_that_towards_a_wall_in_its_place(x_m: float, y_m: float, theta_rad: float, speed_mps: float) -> None:
    wall = Shape("pit", "polygon", PIT.points)
    falls, hits = (run(Simulator(room(shape), cart(), 0, start=(x_m, y_m, theta_rad)), 8.0, speed_mps) for shape in (PIT, wall))
    told = [[(c.t_s, c.with_id, pytest.approx(c.speed_mps, abs=1e-6)) for c in sim.collisions] for sim in (falls, hits)]
    assert told[0] == told[1] and falls.hit_by == hits.hit_by
    assert falls.min_clearance_m == pytest.approx(hits.min_clearance_m, abs=1e-9) and falls.pose == pytest.approx(hits.pose, abs=1e-9)


def test_how_near_the_robot_passed_a_hole_is_told() -> None:
    pit = Shape("pit", "hole", points((0.0, 0.7), (1.0, 0.7), (1.0, 1.5), (0.0, 1.5)))
    sim = run(Simulator(room(pit), cart(), 0), 6.0, 0.5)
    assert sim.min_clearance_m == pytest.approx(0.3, abs=1e-6) and not sim.collisions


def test_driving_over_the_edge_of_a_hole_is_a_collision() -> None:
    sim = run(Simulator(room(PIT), cart(), 0), 6.0, 0.5)
    (contact,) = sim.collisions
    assert contact.with_id == "pit"
    assert sim.pose[0] == pytest.approx(1.5, abs=1e-5)
    assert contact.speed_mps == pytest.approx(0.5)
    run(sim, 2.0, -0.5)
    assert sim.pose[0] < 1.0


def test_the_cells_of_a_map_stop_the_robot_too() -> None:
    occupied = np.zeros((100, 100), dtype=np.uint8)
    occupied[:, 80] = 1
    grid = OccupancyGrid(occupied, np.zeros_like(occupied), 0.1, (-5.0, -5.0, 0.0))
    sim = run(Simulator(World("map", grid=grid), cart(), 0), 9.0, 0.5)
    assert sim.pose[0] == pytest.approx(3.0 - 0.5, abs=1e-5)
    assert len(sim.collisions) == 1


def test_clearance_is_the_exact_distance_and_its_minimum_is_kept() -> None:
    post = Shape("post", "circle", points((2.0, 1.0)), radius_m=0.2)
    sim = run(Simulator(room(post), cart(), 0), 6.0, 0.7)
    assert sim.min_clearance_m == pytest.approx(1.0 - 0.2 - 0.4, abs=1e-6)
    assert sim.clearance_m == pytest.approx(5.0 - 0.5 - sim.pose[0], abs=1e-9)


@pytest.mark.parametrize(("heading", "speed", "pressed"), [(0.0, 0.5, (True, False)), (0.0, -0.5, (False, True)), (math.pi, 0.5, (True, False))])
def test_the_bumper_of_the_half_that_touches_is_pressed(heading: float, speed: float, pressed: tuple[bool, bool]) -> None:
    sim = run(Simulator(room(), cart(bumpers=Bumpers(depth_m=0.02)), 0, start=(0.0, 0.0, heading)), 10.0, speed)
    assert of_type(sim.devices["base"].read(), BumperRecord)[-1] == BumperRecord(10.0, 10.0, *pressed)


def test_a_bumper_speaks_at_once_when_it_changes_and_else_ten_times_a_second() -> None:
    sim = run(Simulator(room(), cart(bumpers=Bumpers(depth_m=0.02)), 0), 10.0, 0.5)
    records = of_type(sim.devices["base"].read(), BumperRecord)
    (change,) = [i for i, record in enumerate(records) if record.front and not records[i - 1].front]
    assert records[change].stamp_s == pytest.approx((4.5 - 0.02) / 0.5 + 0.125, abs=0.03)
    assert len(records) == pytest.approx(100, abs=3)


SHAPES = st.lists(
    st.one_of(
        st.builds(lambda i, x, y, r: Shape(f"c{i}", "circle", points((x, y)), radius_m=r), st.integers(0, 10**6), st.floats(-4, 4), st.floats(-4, 4),
                  st.floats(0.01, 0.6)),
        st.builds(lambda i, x, y, w, d: box(f"b{i}", x, y, w, d), st.integers(0, 10**6), st.floats(-4, 4), st.floats(-4, 4), st.floats(0.01, 2),
                  st.floats(0.01, 2)),
    ), min_size=1, max_size=5, unique_by=lambda shape: shape.id,
)  # fmt: skip
COMMANDS = st.lists(st.tuples(st.floats(-1, 1), st.floats(-1.5, 1.5)), min_size=1, max_size=10)


def solid(shape: Shape) -> Polygon | LineString:
    """The shape for an independent geometry library."""
    if shape.kind == "circle":
        return Point(shape.points[0]).buffer(shape.radius_m * (1.0 - 1e-4), quad_segs=32)
    return Polygon(shape.points) if shape.kind == "polygon" else LineString(shape.points)


@settings(max_examples=40, deadline=None)
@given(shapes=SHAPES, commands=COMMANDS, someone_walks=st.booleans())
def test_the_outline_never_enters_what_stands(shapes: list[Shape], commands: list[tuple[float, float]], someone_walks: bool) -> None:
    walker = Actor("person", 0.25, 1.3, True, points((4.0, 0.3), (-4.0, -0.3), (0.0, 3.0)))
    world = room(*shapes, actors=(walker,) * someone_walks)
    things = [solid(shape) for shape in world.shapes]
    sim = Simulator(world, cart(), 0)
    if any(Polygon(sim.outline_m).intersects(thing) for thing in things):
        return  # it cannot start there
    for i in range(20):
        run(sim, 0.5, *commands[i % len(commands)])
        outline = Polygon(sim.outline_m)
        assert all(outline.intersection(thing).length < 1e-6 for thing in things)
