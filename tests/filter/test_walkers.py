"""Who walks about: found by laser and sonar, remembered when out of view; and what stands is nobody, however the robot moves."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.blackboard.messages import LaserScan, read_only
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import Shape, World
from pluto_bt.skills.approach import PERHAPS, SURELY, WALKS, Approach
from pluto_bt.skills.outline import Planar, outline_of
from pluto_bt.skills.seen_kernels import CAME, SUDDEN, UNKNOWN, UNSEEN
from pluto_bt.skills.sonar import SonarRing
from pluto_bt.skills.stop_path import DRIFT_X, DRIFT_Y, GROWTH_MPS, IN_VIEW, SPREAD_M
from pluto_bt.skills.walkers import WalkerWatch
from tests.chain.robots import ATRV2, PIONEER

ANGLES = np.radians(np.arange(361) / 2.0 - 90.0)
HALL = Shape("hall", "wall", np.array([(-5.0, -4.0), (5.0, -4.0), (5.0, 4.0), (-5.0, 4.0), (-5.0, -4.0)]))
ROUND_S, SCAN_S = 0.1, 0.2


def post(x: float, y: float, radius_m: float = 0.25) -> Shape:
    return Shape("post", "circle", np.array([[x, y]]), radius_m)


def scan_of(shapes: tuple[Shape, ...], laser: Planar, stamp_s: float, noise: np.random.Generator) -> LaserScan:
    out = np.zeros(len(ANGLES))
    Scene(World("hall", shapes=shapes)).scan(laser, 0.6, 0.0, ANGLES, 80.0, out)
    return LaserScan(stamp_s, float(ANGLES[0]), math.radians(0.5), read_only(out + noise.normal(0.0, 0.01, len(out))), len(out))


def watched(walk: list[tuple[float, float]], way: list[Planar], *others: Shape) -> tuple[WalkerWatch, float]:
    """A watch after scans of somebody's walk from a robot's way, and the time then."""
    watch, noise, now_s = WalkerWatch(30.0), np.random.default_rng(1), 0.0
    for (x, y), laser in zip(walk, way, strict=True):
        now_s += SCAN_S
        watch.take_scan(scan_of((HALL, post(x, y), *others), laser, now_s, noise), laser, np.ones(len(ANGLES)))
    return watch, now_s


@pytest.mark.parametrize("velocity", [(-0.5, 0.0), (-1.2, 0.3), (0.0, 0.6), (0.0, -1.4), (0.7, 0.7)])
def test_a_walker_is_found_with_his_place_and_how_far_he_gets(velocity: tuple[float, float]) -> None:
    walk = [(2.5 + velocity[0] * SCAN_S * k, velocity[1] * SCAN_S * k) for k in range(7)]
    watch, now_s = watched(walk, [(0.0, 0.0, 0.0)] * 7)
    rows = watch.rows(now_s)
    assert len(rows) == 1
    assert rows[0, :2] == pytest.approx(walk[-1], abs=0.3)
    pace_mps, drift_mps = math.hypot(*velocity), math.hypot(rows[0, DRIFT_X], rows[0, DRIFT_Y])
    assert pace_mps <= drift_mps + rows[0, GROWTH_MPS] <= pace_mps + 0.6, "he may go on"
    assert rows[0, GROWTH_MPS] - drift_mps > 0.5 * pace_mps, "and turn on his heel"


@pytest.mark.parametrize(("bearing_deg", "speed_mps"), [(0.0, 0.5), (30.0, 0.8), (-50.0, 1.2)])
def test_who_walks_away_is_found_too_for_he_may_turn_on_his_heel(bearing_deg: float, speed_mps: float) -> None:
    c, s = math.cos(math.radians(bearing_deg)), math.sin(math.radians(bearing_deg))
    walk = [((1.0 + speed_mps * SCAN_S * k) * c, (1.0 + speed_mps * SCAN_S * k) * s) for k in range(8)]
    watch, now_s = watched(walk, [(0.0, 0.0, 0.0)] * 8, Shape("tree", "circle", np.array([[3.0, -2.8]]), 0.2))
    rows = watch.rows(now_s)
    assert len(rows) == 1 and rows[0, IN_VIEW] == 1.0 and watch.is_anybody_about(now_s)
    assert rows[0, :2] == pytest.approx(walk[-1], abs=0.3)
    assert rows[0, GROWTH_MPS] - math.hypot(rows[0, DRIFT_X], rows[0, DRIFT_Y]) > 0.9 * speed_mps, "he may come back as fast as he went"


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_who_comes_along_beside_the_end_of_a_wall_is_seen_though_he_hangs_together_with_it(side: float) -> None:
    wall = Shape("wall", "wall", np.array([(2.2, -1.0 * side), (2.2, -0.2 * side)]))
    walk = [(2.9 - 0.1 * k, 0.0) for k in range(9)]
    watch, now_s = watched(walk, [(0.0, 0.0, 0.0)] * 9, wall)
    rows = watch.rows(now_s)
    assert rows[0, IN_VIEW] == 1.0 and math.dist(rows[0, :2], walk[-1]) < 0.3 and rows[0, SPREAD_M] < 0.1


def test_where_one_left_the_view_somebody_may_be_anywhere_for_a_while() -> None:
    walk = [(1.2 - 0.2 * k, 1.5) for k in range(14)]
    watch, now_s = watched(walk, [(0.0, 0.0, 0.0)] * 14)
    near, far = watch.rows(now_s + 2.0), watch.rows(now_s + 7.0)
    assert watch.rows(now_s)[0, IN_VIEW] == 1.0, "he may come back at once"
    assert near[0, IN_VIEW] == far[0, IN_VIEW] == 0.0
    assert 4.0 < far[0, SPREAD_M] - near[0, SPREAD_M] < 9.0, "five seconds at about a metre a second"
    assert watch.is_anybody_about(now_s + 25.0)
    assert not watch.is_anybody_about(now_s + 31.0)


def test_where_nobody_walked_nobody_is_assumed() -> None:
    watch, now_s = watched([(2.0, 1.0)] * 10, [(0.0, 0.0, 0.0)] * 10)
    assert not watch.is_anybody_about(now_s)
    watch.doubt(now_s)
    assert watch.is_anybody_about(now_s + 0.5) and not watch.is_anybody_about(now_s + 0.7), "what stands is known to after a moment"


def test_who_stops_in_view_stays_there() -> None:
    walk = [(4.0 - 0.2 * k, 0.0) for k in range(7)] + [(2.8, 0.0)] * 15
    watch, now_s = watched(walk, [(0.0, 0.0, 0.0)] * 22)
    rows = watch.rows(now_s)
    assert len(rows) == 1 and rows[0, SPREAD_M] < 2.0, "three seconds later his disc has not grown"


def test_a_laser_that_looks_down_for_a_moment_does_not_lose_him() -> None:
    walk = [(4.0 - 0.2 * k, 0.0) for k in range(7)]
    watch, now_s = watched(walk, [(0.0, 0.0, 0.0)] * 7)
    assert watch.rows(now_s + 2.0)[0, IN_VIEW] == 1.0


@settings(max_examples=15, deadline=None)
@given(st.floats(-0.9, 0.9), st.floats(-0.8, 0.8), st.floats(-math.pi, math.pi), st.integers(0, 1000))
def test_what_stands_is_nobody_however_the_robot_moves(speed_mps: float, turn_radps: float, theta: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    things = [post(float(x), float(y), float(r)) for x, y, r in rng.uniform((-4.5, -3.5, 0.03), (4.5, 3.5, 0.4), (5, 3)) if math.hypot(x, y) > 2.0]
    pose, way = (0.0, 0.0, theta), []
    for _ in range(10):
        way.append(pose)
        heading = pose[2] + 0.5 * turn_radps * SCAN_S
        pose = (pose[0] + speed_mps * SCAN_S * math.cos(heading), pose[1] + speed_mps * SCAN_S * math.sin(heading), pose[2] + turn_radps * SCAN_S)
    watch, now_s = watched([(4.7, 3.7)] * 10, way, *things)
    assert not watch.is_anybody_about(now_s)


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.6, 0.6), st.floats(2.0, 4.0), st.floats(0.3, 0.9), st.floats(-0.3, 0.3), st.integers(0, 1000))
def test_the_end_of_a_wall_seen_at_a_flat_angle_is_nobody(bearing: float, away_m: float, speed_mps: float, turn_radps: float, seed: int) -> None:
    """The line of the wall passes the robot at some centimetres, so it changes from side to side and comes out from behind its own end."""
    rng = np.random.default_rng(seed)
    c, s, leans = math.cos(bearing), math.sin(bearing), bearing + float(rng.uniform(-0.15, 0.15))
    end = np.array([away_m * c, away_m * s])
    wall = Shape("flat", "wall", np.array([end, end + 2.5 * np.array([math.cos(leans), math.sin(leans)])]))
    way = [(0.0, 0.0, 0.0)]
    for _ in range(9):
        x, y, theta = way[-1]
        step_m = speed_mps * SCAN_S
        way.append((x + step_m * math.cos(theta), y + step_m * math.sin(theta), theta + turn_radps * SCAN_S))
    watch, now_s = watched([(4.7, 3.7)] * 10, way, wall)
    assert not watch.is_anybody_about(now_s)


@pytest.mark.parametrize("seed", range(6))
def test_the_face_of_a_wall_that_the_laser_saw_on_edge_before_is_nobody(seed: int) -> None:
    """The robot drives across the line of a wall, whose end shows nothing of it; then all of it comes into view."""
    wall, noise, watch = Shape("wall", "wall", np.array([(0.0, 1.0), (0.0, 2.2)])), np.random.default_rng(seed), WalkerWatch(30.0)
    for k in range(12):
        laser = (-0.5 + 0.1 * k + float(noise.normal(0.0, 0.003)), 0.0, 0.5 * math.pi)
        watch.take_scan(scan_of((HALL, wall), laser, SCAN_S * k, noise), laser, np.ones(len(ANGLES)))
        assert not len(watch.rows(SCAN_S * k))


@settings(max_examples=20, deadline=None)
@given(st.floats(0.3, 0.6), st.floats(0.25, 0.6), st.floats(0.3, 0.6), st.floats(-0.3, 0.3), st.sampled_from((1.0, -1.0)), st.integers(0, 1000))
def test_the_back_of_a_round_thing_that_comes_into_view_as_we_pass_is_nobody(
    radius_m: float, gap_m: float, speed_mps: float, turn_radps: float, side: float, seed: int
) -> None:
    """It lay in the shadow of its own front, by some millimetres that neither the laser nor dead reckoning knows."""
    table = Shape("table", "circle", np.array([[0.6, side * (gap_m + radius_m)]]), radius_m)
    way, noise, now_s, watch = [(0.0, 0.0, 0.0)], np.random.default_rng(seed), 0.0, WalkerWatch(30.0)
    for _ in range(9):
        x, y, theta = way[-1]
        way.append((x + speed_mps * SCAN_S * math.cos(theta), y + speed_mps * SCAN_S * math.sin(theta), theta + turn_radps * SCAN_S * side))
    for x, y, theta in way:
        now_s += SCAN_S
        dx, dy, turn = noise.normal(0.0, (0.003, 0.003, 0.003))
        watch.take_scan(scan_of((HALL, table), (x, y, theta), now_s, noise), (x + dx, y + dy, theta + turn), np.ones(len(ANGLES)))
        assert not len(watch.rows(now_s))


def ring_of(name: str) -> SonarRing:
    platform = {"atrv2": ATRV2, "pioneer": PIONEER}[name]
    assert platform.devices.sonar is not None
    return SonarRing(platform.devices.sonar, outline_of(platform.body.outline_m))


NOT_NEW = {name: np.zeros(ring_of(name).count, dtype=np.intp) for name in ("atrv2", "pioneer")}


def heard(
    name: str, way: list[Planar], shapes_at: list[tuple[Shape, ...]], is_alone: bool = True, news: np.ndarray | None = None
) -> list[np.ndarray]:
    """What `Approach` says in each round, by default that of a robot without a laser, which takes more for people; `news`: in each round."""
    ring, noise = ring_of(name), np.random.default_rng(2)
    approach, said = Approach(ring, is_alone), []
    for k, (robot, shapes) in enumerate(zip(way, shapes_at, strict=True)):
        c, s = math.cos(robot[2]), math.sin(robot[2])
        x, y, theta = ring.axes.T
        ranges = np.zeros(ring.count)
        at_x, at_y = robot[0] + c * x - s * y, robot[1] + s * x + c * y
        Scene(World("hall", shapes=shapes)).cones(at_x, at_y, theta + robot[2], 0.3, 2.0 * ring.half_cone_rad, 5.0, ranges)
        said.append(approach.look(ranges + noise.normal(0.0, 0.02, ring.count), robot, k * ROUND_S, NOT_NEW[name] if news is None else news))
    return said


@pytest.mark.parametrize("bearing", [0.0, math.pi / 2.0, math.pi, -math.pi / 2.0])
def test_the_ring_hears_somebody_come_from_all_sides_while_the_robot_stands(bearing: float) -> None:
    walk = [(2.5 - 0.1 * k) for k in range(10)]
    said = heard("pioneer", [(0.0, 0.0, 0.0)] * 10, [(HALL, post(r * math.cos(bearing), r * math.sin(bearing))) for r in walk])
    assert all(len(found) for found in said[5:])
    x, y, unsure_m, how = said[-1][0]
    assert math.dist((x, y), (walk[-1] * math.cos(bearing), walk[-1] * math.sin(bearing))) < 0.25 + unsure_m + 0.1
    assert how == SURELY, "nothing but somebody explains that to who stands"


@pytest.mark.parametrize(("is_alone", "news", "is_told"), [(True, 0, True), (False, UNKNOWN, True), (False, UNSEEN, True), (False, 0, False)])
def test_it_hears_somebody_come_from_ahead_while_the_robot_drives(is_alone: bool, news: int, is_told: bool) -> None:
    """Unless a laser explains the echo: it sees who comes, and how a face slants that a cone grazes."""
    way, shapes = [(0.05 * k, 0.0, 0.0) for k in range(10)], [(HALL, post(3.2 - 0.1 * k, 0.0)) for k in range(10)]
    assert any(len(found) for found in heard("atrv2", way, shapes, is_alone, NOT_NEW["atrv2"] + news)) == is_told


@pytest.mark.parametrize("name", ["atrv2", "pioneer"])
@settings(max_examples=15, deadline=None)
@given(st.floats(0.0, 0.9), st.floats(-0.8, 0.8), st.floats(-math.pi, math.pi), st.integers(0, 1000))
def test_walls_and_posts_do_not_come_however_the_robot_moves(name: str, speed_mps: float, turn_radps: float, theta: float, seed: int) -> None:
    """Once in a while a single transducer may be fooled by an edge; two sightings in a row make a walker, and these must be rare."""
    rng = np.random.default_rng(seed)
    things = tuple(post(float(x), float(y), 0.2) for x, y in rng.uniform((-4.0, -3.0), (4.0, 3.0), (4, 2)) if math.hypot(x, y) > 1.6)
    step_m, step_rad = speed_mps * ROUND_S, turn_radps * ROUND_S
    way = [(0.0, 0.0, theta)]
    for _ in range(9):
        x, y, t = way[-1]
        way.append((x + step_m * math.cos(t + step_rad / 2), y + step_m * math.sin(t + step_rad / 2), t + step_rad))
    said = heard(name, way, [(HALL, *things)] * 10)
    watch = WalkerWatch(30.0)
    for k, found in enumerate(said):
        watch.take_echoes(found, k * ROUND_S)
    assert not watch.is_anybody_about(2.0)


CHANGES = {"goes": [1.0 + 0.1 * k for k in range(10)], "leaves": [0.5] * 5 + [2.5] * 5, "appears": [4.0] * 5 + [0.8] * 5}


@pytest.mark.parametrize("walk", CHANGES.values(), ids=CHANGES)
def test_a_ring_that_stands_hears_everything_that_moves(walk: list[float]) -> None:
    said = heard("pioneer", [(0.0, 0.0, 0.0)] * 10, [(HALL, post(r, 0.0)) for r in walk])
    watch = WalkerWatch(30.0)
    for k, found in enumerate(said):
        watch.take_echoes(found, k * ROUND_S)
    assert watch.is_anybody_about(5.0)


@pytest.mark.parametrize(("walk", "is_told"), [([2.5 - 0.1 * k for k in range(10)], True), (CHANGES["goes"], False)], ids=["comes", "goes"])
def test_beside_a_laser_the_ring_tells_only_of_who_comes(walk: list[float], is_told: bool) -> None:
    said = heard("pioneer", [(0.0, 0.0, 0.0)] * 10, [(HALL, post(r, 0.0)) for r in walk], is_alone=False)
    assert any(len(found) for found in said) == is_told


DRIVES, TURNS = [(0.05 * k, 0.0, 0.0) for k in range(10)], [(0.0, 0.0, -0.07 * k) for k in range(10)]


@pytest.mark.parametrize("way", [DRIVES, TURNS], ids=["drives", "turns"])
@pytest.mark.parametrize("step_m", [0.0, 0.1], ids=["post", "person"])
def test_beside_a_robot_that_moves_what_no_laser_explains_is_perhaps_somebody_if_it_comes(way: list[Planar], step_m: float) -> None:
    """He walks up from the right, where the cones point across the way: what a wall may do there, something small does not."""
    near = [(post(way[k][0] + 0.05, -1.6 + step_m * k),) for k in range(10)]
    unknown, known = NOT_NEW["pioneer"] + UNKNOWN, NOT_NEW["pioneer"]
    said = heard("pioneer", way, near, False, unknown)
    assert {how for found in said for how in found[:, 3].tolist()} == ({PERHAPS} if step_m else set())
    assert not any(len(found) for found in heard("pioneer", way, near, False, known))


@pytest.mark.parametrize(("news", "is_alone", "hows"), [(CAME, False, {WALKS}), (SUDDEN, False, {PERHAPS}), (CAME, True, set()), (0, False, set())])
def test_who_comes_while_the_robot_turns_is_believed_where_a_laser_says_that_it_is_no_wall(news: int, is_alone: bool, hows: set[int]) -> None:
    """He stands 1.8 m off when he is heard first: with a ring alone the end of a cone that turns so fast may be anything."""
    said = heard("pioneer", TURNS, [(post(0.0, -1.8),)] * 10, is_alone, NOT_NEW["pioneer"] + news)
    assert {how for found in said for how in found[:, 3].tolist()} == hows


@pytest.mark.parametrize(("from_m", "hows"), [(1.9, {PERHAPS}), (0.8, set())], ids=["came", "was there"])
def test_what_was_as_near_before_is_not_near_all_of_a_sudden(from_m: float, hows: set[int]) -> None:
    """The laser saw the front of a post; when only its back is left in the cone, nothing explains its echo any more."""
    beside = [(post(way[0] + 0.05, -(from_m if k < 5 else 0.8) - 0.25),) for k, way in enumerate(DRIVES)]
    said = heard("pioneer", DRIVES, beside, False, NOT_NEW["pioneer"] + SUDDEN)
    assert {how for found in said[5:] for how in found[:, 3].tolist()} == hows


@pytest.mark.parametrize("turned_rad", [0.0, 0.1])
def test_what_leaps_into_a_cone_is_somebody_only_if_the_robot_stands(turned_rad: float) -> None:
    way = [(0.0, 0.0, 0.0)] * 6 + [(0.0, 0.0, turned_rad)] * 4
    said = heard("pioneer", way, [(HALL, *([post(-1.5, 0.0)] if k > 5 else [])) for k in range(10)], False)
    assert any(len(found) for found in said) == (turned_rad == 0.0)


@pytest.mark.parametrize(("how", "lasts_s"), [(PERHAPS, 0.9), (WALKS, 0.5)])
def test_who_was_noticed_once_counts_for_a_moment_and_nobody_else_because_of_him(how: int, lasts_s: float) -> None:
    watch = WalkerWatch(30.0)
    watch.take_echoes(np.array([[0.5, -0.8, 0.2, how]]), 0.0)
    assert len(watch.rows(lasts_s)) == 1 and not watch.is_anybody_about(lasts_s)
    assert len(watch.rows(lasts_s + 0.2)) == 0


def test_a_laser_that_saw_somebody_once_has_the_robot_reckon_with_him_at_once() -> None:
    watch, now_s = watched([(2.5, 0.0)] * 3 + [(2.1, 0.0)], [(0.0, 0.0, 0.0)] * 4)
    assert len(watch.rows(now_s)) == 1 and not watch.is_anybody_about(now_s) and len(watch.rows(now_s + 0.7)) == 0


def test_who_is_perhaps_there_is_forgotten_while_another_is_remembered() -> None:
    watch = WalkerWatch(30.0)
    watch.take_echoes(np.array([[0.5, -0.8, 0.2, PERHAPS]]), 0.0)
    watch.take_echoes(np.array([[4.0, 0.0, 0.2, SURELY]]), 0.1)
    assert len(watch.rows(0.1)) == 2 and len(watch.rows(1.1)) == 1


def test_who_is_heard_again_and_again_needs_nobody_else_to_be_believed() -> None:
    watch, perhaps = WalkerWatch(3.0), np.array([[0.5, -0.8, 0.2, PERHAPS]])
    for k in range(6):
        watch.take_echoes(perhaps, 0.1 * k)
        assert watch.is_anybody_about(0.1 * k) == (k >= 3)
    assert not watch.is_anybody_about(2.0)


def test_a_wall_that_the_robot_drives_at_is_not_somebody() -> None:
    said = heard("atrv2", [(3.0 + 0.05 * k, 0.0, 0.0) for k in range(20)], [(HALL,)] * 20)
    assert not any(len(found) for found in said)


@pytest.mark.parametrize("turn_dps", [4.0, -4.0, 8.0])
@pytest.mark.parametrize("leans_deg", [10.0, 14.0, 18.0, 22.0])
def test_a_wall_along_the_edge_of_a_cone_is_not_somebody(turn_dps: float, leans_deg: float) -> None:
    lean = math.radians(leans_deg)
    wall = Shape("flat", "wall", np.array([(-0.5, -0.6), (-0.5 - 5.0 * math.cos(lean), -0.6 + 5.0 * math.sin(lean))]))
    said = heard("atrv2", [(0.0, 0.0, math.radians(turn_dps * ROUND_S * k)) for k in range(60)], [(wall,)] * 60)
    watch = WalkerWatch(30.0)
    for k, found in enumerate(said):
        watch.take_echoes(found, k * ROUND_S)
    assert not watch.is_anybody_about(7.0)


def test_a_post_whose_echo_gets_lost_for_some_rounds_does_not_come() -> None:
    ring = ring_of("pioneer")
    approach, watch = Approach(ring, True), WalkerWatch(30.0)
    for k in range(40):
        echo_m = ring.max_range_m if k % 10 in (3, 4, 5, 6) else 1.0
        watch.take_echoes(approach.look(np.full(ring.count, echo_m), (0.0, 0.0, 0.0), k * ROUND_S, NOT_NEW["pioneer"]), k * ROUND_S)
    assert not watch.is_anybody_about(4.0)
