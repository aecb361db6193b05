"""The small parts of the simulator: chance, regions, outlines, actors, ground, wrist, queues."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Point, Polygon

from drivers.records import SpeedRecord
from pluto_bt.maps.platform import Wrist
from pluto_bt.maps.world import Actor, Terrain, World
from sim.actors import Walker
from sim.device import UNREAD_LIMIT, Device
from sim.ground import Ground
from sim.noise import BLOCK, Noise
from sim.outline import Outline
from sim.regions import Regions
from sim.simtime import TICK_NS, SimTime, period_ns, ticks_up
from sim.wrist import WristDevice

L_SHAPE = np.array([(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)])
BOX = np.array([(0.5, 0.5), (2.0, 0.5), (2.0, 2.5), (0.5, 2.5)])


def test_streams_of_chance_depend_on_seed_and_name_alone() -> None:
    draws = [[Noise(seed, name).normal() for _ in range(3)] for seed, name in ((1, "laser"), (1, "laser"), (2, "laser"), (1, "sonar"))]
    assert draws[0] == draws[1]
    assert draws[0] != draws[2] != draws[3] != draws[0]


def test_single_numbers_and_arrays_do_not_disturb_each_other() -> None:
    plain, mixed = Noise(5, "x"), Noise(5, "x")
    singles = [plain.normal() for _ in range(2 * BLOCK + 3)]
    drawn = []
    for _ in range(2 * BLOCK + 3):
        drawn.append(mixed.normal())
        mixed.uniform()
        mixed.normals(2)
    assert drawn == singles


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.floats(-1.0, 5.0), st.floats(-1.0, 4.0)), min_size=1, max_size=30))
def test_regions_agree_with_an_independent_library_along_any_path(path: list[tuple[float, float]]) -> None:
    regions, polygons = Regions([L_SHAPE, BOX]), [Polygon(L_SHAPE), Polygon(BOX)]
    for x, y in path:
        if min(polygon.exterior.distance(Point(x, y)) for polygon in polygons) < 1e-9:
            continue  # on the edge itself either answer is right
        assert regions.at(x, y) == tuple(i for i, polygon in enumerate(polygons) if polygon.contains(Point(x, y)))


def test_no_regions_hold_no_point() -> None:
    assert Regions([]).at(1.0, 2.0) == ()


def test_a_grown_outline_moves_every_edge_outwards() -> None:
    grown = Outline(np.array([(0.5, 0.4), (-0.5, 0.4), (-0.5, -0.4), (0.5, -0.4)])).grown(0.02)
    assert grown.corners_m == pytest.approx(np.array([(0.52, 0.42), (-0.52, 0.42), (-0.52, -0.42), (0.52, -0.42)]))


def test_the_halves_of_an_outline_share_the_middle() -> None:
    outline = Outline(np.array([(1.0, 0.0), (0.0, 1.0), (-2.0, 0.0), (0.0, -1.0)]))
    front, back = outline.half(front=True), outline.half(front=False)
    assert front is not None and back is not None
    assert front.corners_m[:, 0].min() == 0.0 and back.corners_m[:, 0].max() == 0.0
    assert Polygon(front.corners_m).area + Polygon(back.corners_m).area == pytest.approx(Polygon(outline.corners_m).area)
    assert Outline(np.array([(1.0, 0.0), (2.0, 0.0), (1.0, 1.0)])).half(front=False) is None


def walker(loop: bool, absent: bool = False) -> Walker:
    """Round a square of 2 m, at 1 m/s."""
    return Walker(Actor("a", 0.2, 1.0, loop, np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]), absent=absent))


@pytest.mark.parametrize(
    ("loop", "t_s", "where"),
    [(True, 0.0, (0, 0)), (True, 1.5, (1.5, 0)), (True, 3.0, (2, 1)), (True, 7.0, (0, 1)), (True, 8.0, (0, 0)), (True, 801.5, (1.5, 0)),
     (False, 5.0, (1, 2)), (False, 6.0, (0, 2)), (False, 60.0, (0, 2))],
)  # fmt: skip
def test_an_actor_walks_its_waypoints_at_constant_speed(loop: bool, t_s: float, where: tuple[float, float]) -> None:
    assert walker(loop).position_at(t_s) == pytest.approx(where, abs=1e-9)


def test_an_actor_that_is_put_elsewhere_walks_on_to_its_next_waypoint() -> None:
    actor = walker(loop=True)
    actor.put(2.0, -3.0, 1.0)  # it was on its way to (2, 0)
    assert actor.position_at(1.0) == (2.0, -3.0)
    assert actor.position_at(4.0) == pytest.approx((2.0, 0.0))
    assert actor.position_at(5.5) == pytest.approx((2.0, 1.5))
    actor.put(2.0, 4.0, 5.5)  # again, on its way to (2, 2)
    assert actor.position_at(8.5) == pytest.approx((1.0, 2.0))


def test_an_absent_actor_begins_its_walk_when_it_is_placed() -> None:
    actor = walker(loop=False, absent=True)
    assert not actor.present
    actor.put(None, None, 10.0)
    assert actor.present
    assert actor.position_at(11.0) == pytest.approx((1.0, 0.0))


def slope(**terrain: float) -> Ground:
    """Ground that is a slope in the unit square around the origin."""
    square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    return Ground(World("w", terrains=(Terrain("low", square * 2, slip=0.1), Terrain("high", square, **terrain))))


def test_a_slope_tilts_the_robot_by_its_heading() -> None:
    ground = slope(pitch_rad=0.1, roll_rad=0.0)
    assert ground.tilt_rad(0.0, 0.0, 0.0) == pytest.approx((0.1, 0.0))
    assert ground.tilt_rad(0.0, 0.0, math.pi) == pytest.approx((-0.1, 0.0))
    assert ground.tilt_rad(0.0, 0.0, math.pi / 2) == pytest.approx((0.0, 0.1))  # down to the east: right side down for who looks north
    assert ground.tilt_rad(3.0, 0.0, 0.0) == (0.0, 0.0)


@given(roll=st.floats(-0.6, 0.6), pitch=st.floats(-0.6, 0.6), theta=st.floats(-3.2, 3.2))
def test_the_slope_itself_does_not_depend_on_the_heading(roll: float, pitch: float, theta: float) -> None:
    phi, psi = slope(roll_rad=roll, pitch_rad=pitch).tilt_rad(0.0, 0.0, theta)
    assert math.cos(phi) * math.cos(psi) == pytest.approx(math.cos(roll) * math.cos(pitch))


def test_the_last_terrain_of_the_file_is_on_top() -> None:
    ground = slope(slip=0.4)
    assert [ground.slip(x, 0.0) for x in (0.0, 1.5, 5.0)] == [0.4, 0.1, 0.0]


def test_a_trunk_lets_go_of_who_backs() -> None:
    ground = slope(slip=1.0, slip_back=0.6)
    assert [ground.slip(0.0, 0.0, backwards) for backwards in (False, True)] == [1.0, 0.6]
    assert ground.slip(1.5, 0.0, True) == 0.1, "elsewhere the direction does not matter"


@settings(max_examples=40, deadline=None)
@given(target=st.floats(-2.0, 2.0), rate=st.floats(0.05, 2.0), acceleration=st.floats(0.1, 5.0), turn_back=st.floats(-1.0, 1.0))
def test_the_wrist_reaches_its_target_within_its_limits(target: float, rate: float, acceleration: float, turn_back: float) -> None:
    time = SimTime()
    wrist = WristDevice("wrist", time, Wrist(pan_limit_deg=57.3, max_rate_dps=60.0, max_acceleration_dps2=120.0))
    limit, a_max = math.radians(57.3), min(acceleration, math.radians(120.0))
    wrist.move(turn_back, 0.0, 1.0, 2.0)
    wrist.bring_to(30 * TICK_NS)
    time.jump_to(30 * TICK_NS)
    wrist.move(target, 0.0, rate, acceleration)
    before = wrist.pan.rate_radps
    for i in range(31, 31 + 6000):
        wrist.bring_to(i * TICK_NS)
        assert abs(wrist.pan.angle_rad) <= limit
        assert abs(wrist.pan.rate_radps - before) <= a_max * 0.01 * 1.51
        before = wrist.pan.rate_radps
        if not wrist.pan.moving:
            break
    assert wrist.pan.angle_rad == min(max(target, -limit), limit)


@pytest.mark.parametrize(("rate", "acceleration"), [(0.0, 1.0), (1.0, 0.0), (-1.0, 1.0), (math.nan, 1.0)])
def test_the_wrist_stays_without_velocity_and_acceleration(rate: float, acceleration: float) -> None:
    wrist = WristDevice("wrist", SimTime(), Wrist())
    wrist.move(0.5, 0.5, rate, acceleration)
    wrist.bring_to(100 * TICK_NS)
    assert (wrist.pan.angle_rad, wrist.tilt.angle_rad) == (0.0, 0.0)


def test_records_arrive_in_time_and_a_forgotten_device_stays_small() -> None:
    time = SimTime()
    device = Device("speed", time)
    device.send(SpeedRecord(0.0, 0.2, 1.0))
    device.send(SpeedRecord(0.1, 0.1, 2.0))
    assert device.read() == []
    time.jump_to(ticks_up(150_000_000))
    assert [record.stamp_s for record in device.read()] == [0.1]
    time.jump_to(ticks_up(195_000_000))
    assert [record.stamp_s for record in device.read()] == [0.0]
    for i in range(2 * UNREAD_LIMIT):
        device.send(SpeedRecord(0.0, 0.0, float(i)))
    assert [record.speed_mps for record in device.read()] == [float(i) for i in range(UNREAD_LIMIT, 2 * UNREAD_LIMIT)]  # type: ignore[attr-defined]


@pytest.mark.parametrize(("rate_hz", "expected_ns"), [(50.0, 20_000_000), (5.0, 200_000_000), (3.0, 333_333_333), (500.0, TICK_NS)])
def test_periods_are_whole_nanoseconds_and_no_shorter_than_a_tick(rate_hz: float, expected_ns: int) -> None:
    assert period_ns(rate_hz) == expected_ns
