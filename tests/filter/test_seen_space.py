"""The filter's memory of space, and the stopping path through it: against plain geometry."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.blackboard.messages import LaserScan, read_only
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import Shape, World
from pluto_bt.skills.outline import outline_of
from pluto_bt.skills.seen_kernels import CAME, CELL_M, HIDDEN, LEVEL, LOW, NEVER, SUDDEN, UNKNOWN
from pluto_bt.skills.seen_space import SeenSpace
from pluto_bt.skills.sonar import SonarRing
from pluto_bt.skills.stop_path import CLEAR, MEETS, UNSEEN, WALKER, first_trouble, rim_of
from pluto_bt.skills.walker import Walker
from pluto_bt.skills.walkers import NOBODY
from tests.chain.robots import ATRV2, PIONEER

OUTLINE = outline_of(ATRV2.body.outline_m)
RIM = rim_of(OUTLINE, ATRV2.body.outline_m)
REACH_M = 2.0


def scan(ranges: np.ndarray, stamp_s: float = 1.0) -> LaserScan:
    return LaserScan(stamp_s, -math.pi / 2, math.pi / 360, read_only(ranges), len(ranges))


def space() -> SeenSpace:
    one = SeenSpace(OUTLINE, REACH_M, 1.5)
    one.roll((0.0, 0.0, 0.0))
    return one


def cell(one: SeenSpace, x: float, y: float) -> tuple[int, int]:
    return math.floor((y - one.corner_m[1]) / CELL_M), math.floor((x - one.corner_m[0]) / CELL_M)


def wall_ahead(distance_m: float) -> np.ndarray:
    """A wall across the way, seen from the origin."""
    angles = np.radians(np.arange(361) / 2.0 - 90.0)
    with np.errstate(divide="ignore"):
        return np.minimum(80.0, distance_m / np.maximum(np.cos(angles), 1e-9))


def test_beams_make_free_what_they_run_through_and_occupied_where_they_end() -> None:
    one = space()
    one.add_scan(scan(wall_ahead(1.52)), (0.0, 0.0, 0.0), 0.6, 0.0, NOBODY)
    assert one.seen[cell(one, 1.0, 0.3)] == 1.0
    assert one.seen[cell(one, 1.7, 0.0)] == NEVER, "behind the wall nothing is known"
    assert one.seen[cell(one, -0.5, 0.0)] == NEVER
    assert one.stamps[(LEVEL, *cell(one, 1.52, 0.02))] == 1.0


def test_what_goes_away_is_forgotten_when_a_beam_runs_through_its_place() -> None:
    one = space()
    one.add_scan(scan(wall_ahead(1.0)), (0.0, 0.0, 0.0), 0.6, 0.0, NOBODY)
    one.add_scan(scan(wall_ahead(1.8), 2.0), (0.0, 0.0, 0.0), 0.6, 0.0, NOBODY)
    one.stand((0.0, 0.0, 0.0), 0.0, 2.0, 0.0, REACH_M)
    assert one.points[: one.count, 0].min() > 1.7


def test_one_lost_beam_opens_no_hole_and_one_short_beam_is_believed_the_second_time() -> None:
    one, ranges = space(), wall_ahead(1.52)
    ranges[180] = 80.0
    ranges[100] = 0.7
    one.add_scan(scan(wall_ahead(1.52)), (0.0, 0.0, 0.0), 0.6, 0.0, NOBODY)
    one.add_scan(scan(ranges, 2.0), (0.0, 0.0, 0.0), 0.6, 0.0, NOBODY)
    at = (0.7 * math.cos(math.radians(40.0)), -0.7 * math.sin(math.radians(40.0)))
    assert one.stamps[(LEVEL, *cell(one, 1.52, 0.02))] > NEVER
    assert one.stamps[(LEVEL, *cell(one, *at))] == NEVER
    one.add_scan(scan(ranges, 3.0), (0.0, 0.0, 0.0), 0.6, 0.0, NOBODY)
    assert one.stamps[(LEVEL, *cell(one, *at))] == 3.0


@pytest.mark.parametrize(("beams", "is_there"), [((180,), False), ((179, 180), True)])
def test_a_scan_that_looks_down_finds_low_things_but_believes_no_lone_short_beam(beams: tuple[int, ...], is_there: bool) -> None:
    """Nothing could take a dazzled one back: a level scan does not look there."""
    one, tilt_rad = space(), math.radians(10.0)
    angles = np.radians(np.arange(361) / 2.0 - 90.0)
    ground = np.minimum(80.0, 0.6 / np.maximum(np.cos(angles) * math.sin(tilt_rad), 1e-9))
    ground[list(beams)] = 1.0
    one.add_scan(scan(ground), (0.0, 0.0, 0.0), 0.6, tilt_rad, NOBODY)
    assert bool((one.stamps[LOW] > NEVER).any()) == is_there


@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
@settings(max_examples=30, deadline=None)
def test_rolling_along_keeps_what_is_still_near(x: float, y: float) -> None:
    one = space()
    one.add_scan(scan(wall_ahead(1.52)), (0.0, 0.0, 0.0), 0.6, 0.0, NOBODY)
    one.roll((x, y, 0.0))
    row, column = cell(one, 1.0, 0.3)
    if 0 <= row < len(one.seen) and 0 <= column < len(one.seen):
        assert one.seen[row, column] == 1.0
    else:
        assert max(abs(x - 1.0), abs(y - 0.3)) > REACH_M


def hear(one: SeenSpace, ranges: np.ndarray, rounds: int = 3, since_s: float = 5.0, step_s: float = 1.0, theta_rad: float = 0.0) -> list[Any]:
    """What is new about the echoes of each round."""
    sonar = PIONEER.devices.sonar
    assert sonar is not None
    ring = SonarRing(sonar, outline_of(PIONEER.body.outline_m))
    stamps_s = [since_s + k * step_s for k in range(rounds)]
    return [one.add_echoes(ring.axes, np.zeros(ring.count), ranges, sonar, (0.0, 0.0, theta_rad), stamp_s).tolist() for stamp_s in stamps_s]


def test_an_echo_that_the_laser_does_not_explain_is_an_obstacle_and_is_forgotten_when_the_cone_is_free() -> None:
    one, ranges = space(), np.full(16, 5.0)
    ranges[3] = ranges[4] = 1.0
    hear(one, ranges)
    one.stand((0.0, 0.0, 0.0), 0.0, 8.0, 0.0, REACH_M)
    low = one.points[: one.count][one.points[: one.count, 2] == LOW]
    assert len(low) and np.hypot(low[:, 0] - 0.166, low[:, 1]) == pytest.approx(1.0, abs=0.1)
    hear(one, np.full(16, 5.0))
    one.stand((0.0, 0.0, 0.0), 0.0, 9.0, 0.0, REACH_M)
    assert one.count == 0


def test_an_echo_where_all_was_free_came_and_one_near_the_robot_is_sudden_till_it_is_known() -> None:
    one, near, far = space(), np.full(16, 5.0), np.full(16, 5.0)
    near[3] = near[4] = 0.6
    far[10:13] = 1.2
    assert hear(one, near)[0][3] == HIDDEN, "nobody ever looked there"
    hear(one, np.full(16, 5.0), since_s=6.0)
    assert hear(one, near)[0][3] == SUDDEN and hear(one, near, since_s=8.0)[2][3] == UNKNOWN
    for k, theta_rad in enumerate((-0.2, 0.2, 0.0)):
        hear(one, np.full(16, 5.0), 3, 8.7 + 0.3 * k, 0.1, theta_rad)
    assert CAME in hear(one, far, 1, 9.6, 0.1)[0][10:13]
    assert CAME not in hear(one, far, 1, 20.0, 0.1)[0][10:13], "what was free long ago may have been filled by anything"


@pytest.mark.parametrize("seed", range(4))
def test_the_end_of_a_wall_is_not_forgotten_as_the_laser_passes_through_its_line(seed: int) -> None:
    """A robot in a doorway: beams run along the face of the wall, and end on it no more."""
    one, noise = space(), np.random.default_rng(seed)
    scene = Scene(World("door", shapes=(Shape("wall", "wall", np.array([(0.0, 0.7), (0.0, 3.0)])),)))
    angles, ranges = np.radians(np.arange(361) / 2.0 - 90.0), np.zeros(361)
    for k in range(20):
        laser = (-1.5 + 0.08 * k + float(noise.uniform(0.0, 0.04)), 0.0, 0.0)
        scene.scan(laser, 0.6, 0.0, angles, 80.0, ranges)
        one.add_scan(scan(ranges + noise.normal(0.0, 0.01, 361), 1.0 + 0.2 * k), laser, 0.6, 0.0, NOBODY)
    one.stand((0.0, 0.0, 0.0), 0.0, 5.0, 0.0, REACH_M)
    left = one.points[: one.count][np.hypot(one.points[: one.count, 0], one.points[: one.count, 1] - 0.85) < 0.2]
    assert len(left) >= 4


def test_an_echo_of_what_the_laser_sees_adds_nothing() -> None:
    one, ranges = space(), np.full(16, 5.0)
    ranges[3] = ranges[4] = 1.0
    one.add_scan(scan(wall_ahead(1.166)), (0.0, 0.0, 0.0), 0.4, 0.0, NOBODY)
    hear(one, ranges)
    one.stand((0.0, 0.0, 0.0), 0.0, 8.0, 0.0, REACH_M)
    assert not (one.points[: one.count, 2] == LOW).any()


def test_a_lost_echo_proves_nothing_before_three_rounds_agree() -> None:
    one = space()
    hear(one, np.full(16, 5.0), rounds=2)
    assert one.seen[cell(one, 1.0, 0.0)] == NEVER
    hear(one, np.full(16, 5.0), rounds=1)
    assert one.seen[cell(one, 1.0, 0.0)] > NEVER


LIMITS = (0.4, 0.8, 0.8)  # acceleration, deceleration, turn acceleration


def trouble(
    point: tuple[float, float] | None, now: tuple[float, float], told: tuple[float, float], is_seen: bool = True, walker: Walker | None = None,
    fresh_since_s: float = 0.0,
) -> tuple[int, int, float]:  # fmt: skip
    """At 0 s; all cells were seen at 0 s, or never."""
    one = space()
    points = np.array([[*(point or (9.0, 9.0)), 0.0, 0.0]])
    seen = np.full_like(one.seen, 0.0 if is_seen else NEVER)
    figures = np.array([*now, *LIMITS, 0.2, OUTLINE.reach_m, 0.01, 0.02, 0.0, 0.045])
    walkers = NOBODY if walker is None else np.array([walker.row(0.0)])
    known = (-1.0, walkers, fresh_since_s, fresh_since_s)
    return first_trouble(points, 1, OUTLINE.planes, RIM, seen, one.stamps, *one.corner_m, 0.0, 0.0, 0.0, figures, *told, *known)


def plain_motor(now: float, wanted: float, faster: float, slower: float) -> float:
    """One step; a change of direction pauses at rest."""
    wanted = 0.0 if now * wanted < 0.0 else wanted
    step = slower if abs(wanted) < abs(now) else faster
    return now + max(-step, min(step, wanted - now))


def plain_meets(point: tuple[float, float], now: tuple[float, float], told: tuple[float, float], margin_m: float) -> bool:
    """The same drive in steps of 2 ms, with every corner of the outline."""
    (v, w), x, y, turned, t, dt = now, 0.0, 0.0, 0.0, 0.0, 0.002
    while t < 0.2 or abs(v) + abs(w) > 1e-9:
        wanted = told if t < 0.2 else (0.0, 0.0)
        v, w = plain_motor(v, wanted[0], LIMITS[0] * dt, LIMITS[1] * dt), plain_motor(w, wanted[1], LIMITS[2] * dt, LIMITS[2] * dt)
        x, y, turned, t = x + v * dt * math.cos(turned), y + v * dt * math.sin(turned), turned + w * dt, t + dt
        dx, dy = point[0] - x, point[1] - y
        c, s = math.cos(turned), math.sin(turned)
        if OUTLINE.distance_m(c * dx + s * dy, c * dy - s * dx) <= margin_m:
            return True
    return False


@settings(max_examples=60, deadline=None)
@given(*[st.floats(-1.6, 1.6)] * 2, *[st.floats(-0.9, 0.9)] * 2, *[st.floats(-0.8, 0.8)] * 2)
def test_the_stopping_path_meets_what_small_steps_meet(x: float, y: float, v: float, v_told: float, w: float, w_told: float) -> None:
    if OUTLINE.distance_m(x, y) < 0.06:
        return
    found = trouble((x, y), (v, w), (v_told, w_told))[0]
    if plain_meets((x, y), (v, w), (v_told, w_told), 0.0):
        assert found == MEETS
    if found == MEETS:
        assert plain_meets((x, y), (v, w), (v_told, w_told), 0.045)


@pytest.mark.parametrize(
    ("name", "now", "told", "code"),
    [
        ("a creep is allowed", (0.04, 0.0), (0.04, 0.0), CLEAR),
        ("faster is not", (0.04, 0.0), (0.2, 0.0), UNSEEN),
        ("braking is the best that can be done in one go", (0.1, 0.0), (0.0, 0.0), CLEAR),
        ("nor is turning fast", (0.0, 0.0), (0.0, 0.4), UNSEEN),
    ],
)
def test_into_what_was_never_seen_only_creeping(name: str, now: tuple[float, float], told: tuple[float, float], code: int) -> None:
    assert trouble(None, now, told, is_seen=False)[0] == code


@pytest.mark.parametrize(
    ("name", "told", "walker", "fresh_since_s", "code"),
    [
        ("in view, he comes towards the front", (0.5, 0.0), Walker(1.3, 0.0, -1.0, 0.0, 0.0, -0.3, -0.3), 0.0, WALKER),
        ("in view, he goes away, and may turn on his heel", (0.5, 0.0), Walker(1.1, 0.0, 1.0, 0.0, 0.0, -0.3, -0.3), 0.0, WALKER),
        ("in view, he is so far that he may do so", (0.5, 0.0), Walker(2.2, 0.0, 1.0, 0.0, 0.0, -0.3, -0.3), 0.0, CLEAR),
        ("in view, he is too far to get here", (0.5, 0.0), Walker(4.0, 0.0, -1.0, 0.0, 0.0, -0.3, -0.3), 0.0, CLEAR),
        ("creeping is no collision", (0.04, 0.0), Walker(1.0, 0.0, -1.0, 0.0, 0.0, -0.3, -0.3), 0.0, CLEAR),
        ("out of view, and the ground was just seen to be free", (0.0, 0.5), Walker(-1.0, -1.5, 0.0, 1.0, 0.0, -3.0, -3.0, 2, 1.0), 0.0, CLEAR),
        ("out of view, where nobody looks: the tail would swing out", (0.0, 0.5), Walker(-1.0, -1.5, 0.0, 1.0, 0.0, -3.0, -3.0, 2, 1.0), 1.0, WALKER),
        ("out of view, but too far to have come", (0.0, 0.5), Walker(-1.0, -6.5, 0.0, 1.0, 0.0, -3.0, -3.0, 2, 1.0), 1.0, CLEAR),
    ],
)  # fmt: skip
def test_where_somebody_walks_only_creeping(name: str, told: tuple[float, float], walker: Walker, fresh_since_s: float, code: int) -> None:
    assert trouble(None, (0.0, 0.0), told, walker=walker, fresh_since_s=fresh_since_s)[0] == code


def test_the_rim_leaves_no_gap_that_a_cell_fits_through() -> None:
    steps = np.hypot(*np.diff(RIM[:, :2], axis=0).T)
    assert steps.max() <= 0.7 * CELL_M + 1e-9
    assert {tuple(corner) for corner in np.round(RIM[:, :2], 6).tolist()} >= {tuple(corner) for corner in ATRV2.body.outline_m}
