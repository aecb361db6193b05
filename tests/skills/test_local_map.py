"""The local map: what scans enter, what they take back, how it goes along; clearance against a slow twin."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.blackboard.messages import LaserScan, read_only
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import Shape, World
from pluto_bt.skills.local_grid import CELLS
from pluto_bt.skills.local_map import LocalMap
from pluto_bt.skills.map_kernels import Floats, clearances, sharpen
from pluto_bt.skills.motion_parameters import MotionParameters

ANGLES = -math.pi / 2.0 + math.radians(0.5) * np.arange(361)
HEIGHT_M = 0.6


def box(id: str, x0: float, y0: float, x1: float, y1: float, height_m: float = 2.0, kind: str = "polygon") -> Shape:
    return Shape(id, kind, np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), 0.0, height_m)


def scan(scene: Scene, pose: tuple[float, float, float], tilt_rad: float = 0.0, stamp_s: float = 0.0) -> LaserScan:
    ranges = np.zeros(361)
    scene.scan(pose, HEIGHT_M, tilt_rad, ANGLES, 80.0, ranges)
    return LaserScan(stamp_s, ANGLES[0], math.radians(0.5), read_only(ranges), 361)


def seen(scene: Scene, *poses: tuple[float, float, float], tilt_rad: float = 0.0, times: int = 3) -> LocalMap:
    map = LocalMap(MotionParameters())
    map.forget(poses[0])
    for k in range(times):
        for pose in poses:
            map.add(scan(scene, pose, tilt_rad, 0.5 * k), pose, HEIGHT_M, tilt_rad)
    map.refresh(0.5 * times)
    return map


def stands(map: LocalMap, x: float, y: float) -> bool:
    return bool(map.evidence[map.cell(x, y)] > 0)


def test_a_wall_stands_the_way_to_it_is_free_and_behind_it_nothing_is_known() -> None:
    map = seen(Scene(World("w", shapes=(box("house", 5.0, -3.0, 9.0, 3.0),))), (0.0, 0.0, 0.0))
    assert stands(map, 5.05, 0.0) and stands(map, 5.05, 2.0)
    assert map.evidence[map.cell(3.0, 0.0)] < 0
    assert map.evidence[map.cell(7.0, 0.0)] == 0
    assert map.clearance_m(3.0, 0.0) == pytest.approx(2.0, abs=0.4)


def test_what_has_walked_on_is_gone_after_a_few_scans() -> None:
    person = Scene(World("w", shapes=(box("person", 3.0, -0.2, 3.4, 0.2),)))
    map = seen(person, (0.0, 0.0, 0.0))
    assert stands(map, 3.05, 0.0)
    person.remove("person")
    for _ in range(4):
        map.add(scan(person, (0.0, 0.0, 0.0)), (0.0, 0.0, 0.0), HEIGHT_M, 0.0)
    assert not stands(map, 3.05, 0.0)


def test_one_lost_echo_makes_no_hole_in_a_wall_and_nothing_behind_it() -> None:
    scene = Scene(World("w", shapes=(box("house", 5.0, -3.0, 9.0, 3.0),)))
    map = seen(scene, (0.0, 0.0, 0.0))
    ranges = scan(scene, (0.0, 0.0, 0.0)).ranges_m.copy()
    ranges[180] = 80.0
    for _ in range(5):
        map.add(LaserScan(0.0, ANGLES[0], math.radians(0.5), read_only(ranges), 361), (0.0, 0.0, 0.0), HEIGHT_M, 0.0)
    assert stands(map, 5.05, 0.0)
    assert map.evidence[map.cell(8.0, 0.0)] == 0


def test_scans_full_of_nonsense_say_nothing() -> None:
    map = LocalMap(MotionParameters())
    for value in (math.nan, -1.0, 0.0):
        map.add(LaserScan(0.0, ANGLES[0], math.radians(0.5), read_only(np.full(361, value)), 361), (0.0, 0.0, 0.0), HEIGHT_M, 0.0)
    assert not map.evidence.any()


@pytest.mark.parametrize(
    ("shape", "x_m"), [(box("pit", 2.5, -1.0, 4.0, 1.0, kind="hole"), 3.4), (box("kerb", 2.5, -1.0, 4.0, 1.0, 0.2), 2.5)], ids=["a hole", "a kerb"]
)
def test_a_scan_that_looks_down_finds_what_a_level_one_passes_over(shape: Shape, x_m: float) -> None:
    scene = Scene(World("w", shapes=(shape,)))
    assert seen(scene, (0.0, 0.0, 0.0)).clearance_m(x_m, 0.0) > 1.0
    map = seen(scene, (0.0, 0.0, 0.0), tilt_rad=math.radians(10.0))
    assert map.clearance_m(x_m, 0.0) < 0.5


def test_level_ground_is_no_obstacle_to_a_scan_that_looks_down() -> None:
    map = seen(Scene(World("w")), (0.0, 0.0, 0.3), tilt_rad=math.radians(10.0))
    assert not (map.low_s > 0.0).any()


def test_the_map_goes_along_with_the_robot_and_keeps_what_is_still_inside() -> None:
    scene = Scene(World("w", shapes=(box("house", 45.0, 5.0, 46.0, 6.0),)))
    map = LocalMap(MotionParameters())
    map.add(scan(scene, (38.0, 5.5, 0.0)), (38.0, 5.5, 0.0), HEIGHT_M, 0.0)
    assert stands(map, 45.05, 5.5)
    before = (map.i0, map.j0)
    map.add(scan(scene, (60.0, 5.5, math.pi)), (60.0, 5.5, math.pi), HEIGHT_M, 0.0)
    assert (map.i0, map.j0) != before
    assert stands(map, 45.05, 5.5) and stands(map, 46.05, 5.5)
    assert map.has_inside(60.0 + 0.4 * CELLS * map.cell_m, 5.5)


@given(seed=st.integers(0, 1000))
@settings(max_examples=15, deadline=None)
def test_clearance_is_the_distance_to_the_nearest_thing_but_for_eight_percent(seed: int) -> None:
    rng = np.random.default_rng(seed)
    map = LocalMap(MotionParameters())
    i, j = map.cell(0.0, 0.0)
    here = np.array((i, j))
    things = here + rng.integers(-18, 18, (int(rng.integers(1, 8)), 2))
    map.evidence[things[:, 0], things[:, 1]] = 6
    map.changed_around(0.0, 0.0, 10.0)
    map.refresh(0.0)
    for a, b in here + rng.integers(-15, 15, (30, 2)):
        true = min(map.far_cells, float(np.hypot(things[:, 0] - a, things[:, 1] - b).min()))
        assert true - 1e-3 <= map.clearance[a, b] <= 1.09 * true + 1e-4


def whole_clearance(map: LocalMap, now_s: float) -> Floats:
    """Reckoned anew, for the whole grid."""
    whole = np.full_like(map.clearance, map.far_cells)
    oldest_s = max(0.0, now_s - map.parameters.ground_memory_s) - 1e-3
    clearances(map.evidence, map.low_s, oldest_s, 0, CELLS, 0, CELLS, whole, math.ceil(map.far_cells), map.far_cells)
    return whole


@given(seed=st.integers(0, 1000))
@settings(max_examples=10, deadline=None)
def test_clearance_kept_up_to_date_bit_by_bit_is_that_of_a_whole_reckoning(seed: int) -> None:
    """Things come and go, low ones are forgotten in time."""
    rng = np.random.default_rng(seed)
    map = LocalMap(MotionParameters())
    memory_s = map.parameters.ground_memory_s
    map.shut(0.0, 0.0, 0.3, 0.5)
    here = np.array(map.cell(0.0, 0.0))
    for now_s in (1.0, 2.0, 1.5 + memory_s, 2.5 + memory_s):
        come, go, low = here + rng.integers(-18, 18, (3, int(rng.integers(0, 6)), 2))
        map.evidence[come[:, 0], come[:, 1]] = 6
        map.evidence[go[:, 0], go[:, 1]] = -4
        map.low_s[low[:, 0], low[:, 1]] = now_s
        map.changed_around(0.0, 0.0, 10.0)
        map.refresh(now_s)
        assert np.array_equal(map.clearance, whole_clearance(map, now_s))


@given(seed=st.integers(0, 1000), looks_down=st.booleans())
@settings(max_examples=12, deadline=None)
def test_scan_by_scan_clearance_is_that_of_a_whole_reckoning(seed: int, looks_down: bool) -> None:
    """The robot drives on, so that the grid moves along too; what lies low is forgotten on the way."""
    rng = np.random.default_rng(seed)
    map = LocalMap(MotionParameters())
    way_m, heading_rad = 0.0, float(rng.uniform(-3.0, 3.0))
    for k in range(40):
        now_s, tilt_rad = 3.0 * k, 0.3 if looks_down and k % 5 == 2 else 0.0
        at = (way_m * math.cos(heading_rad), way_m * math.sin(heading_rad))
        ranges_m = np.clip(rng.uniform(2.0, 20.0) + np.cumsum(rng.normal(0.0, 0.3, 361)), 0.3, 30.0)
        ranges_m[rng.random(361) < 0.03] = np.nan
        seen = LaserScan(now_s, ANGLES[0], math.radians(0.5), read_only(ranges_m), 361)
        map.add(seen, (*at, heading_rad + float(rng.normal(0.0, 1.0))), HEIGHT_M, tilt_rad)
        if k % 3 == 2:
            map.refresh(now_s)
            i, j = map.cell(*at)
            near = np.s_[i - 100 : i + 100, j - 100 : j + 100]  # farther off, what falls off the grid still counts
            assert np.array_equal(map.clearance[near], whole_clearance(map, now_s)[near])
        way_m += float(rng.uniform(0.0, 6.0))


FAR = MotionParameters().wide_half_width_m


def test_a_place_that_was_shut_is_open_again_by_itself_when_it_is_forgotten_however_far_it_is() -> None:
    p = MotionParameters()
    map, nothing = LocalMap(p), Scene(World("w"))
    map.shut(35.0, 0.0, 0.5, 10.0)
    map.refresh(10.0)
    assert map.clearance_m(35.0, 0.0) == 0.0
    map.add(scan(nothing, (0.0, 0.0, 0.0)), (0.0, 0.0, 0.0), HEIGHT_M, 0.0)
    map.refresh(11.0 + p.ground_memory_s)
    assert map.clearance_m(35.0, 0.0) == pytest.approx(FAR)
    assert not map.reopen(11.0 + p.ground_memory_s), "there is nothing left to open"


def test_a_place_that_was_erased_or_left_behind_cannot_be_opened_again() -> None:
    map, nothing = LocalMap(MotionParameters()), Scene(World("w"))
    map.shut(3.0, 0.0, 0.5, 10.0)
    map.erase((3.0, 0.0), 4.0, inside=True)
    assert not map.reopen(11.0)
    map.shut(3.0, 0.0, 0.5, 12.0)
    map.add(scan(nothing, (200.0, 0.0, 0.0)), (200.0, 0.0, 0.0), HEIGHT_M, 0.0)
    assert not map.reopen(13.0)
    map.shut(203.0, 0.0, 0.5, 14.0)
    map.erase((0.0, 0.0), 4.0, inside=True)
    assert map.reopen(15.0), "another place was erased"


def test_forgotten_feet_leave_the_way_free_at_the_next_refresh() -> None:
    map, kerb = LocalMap(MotionParameters()), Scene(World("w", shapes=(box("kerb", 2.0, -3.0, 2.5, 3.0, 0.15),)))
    for k in range(3):
        map.add(scan(kerb, (0.0, 0.0, 0.0), 0.25, 0.5 * k), (0.0, 0.0, 0.0), HEIGHT_M, 0.25)
    map.refresh(1.5)
    i, j = np.nonzero(map.low_s > 0.0)
    assert len(i)
    map.forget_feet(np.column_stack(map.middle_m(i, j)))
    map.refresh(1.6)
    assert np.array_equal(map.clearance, whole_clearance(map, 1.6))
    assert float(map.clearance.min()) * map.cell_m == pytest.approx(FAR)


def test_a_look_at_even_ground_finds_nothing_low_and_costs_later_scans_nothing() -> None:
    map, nothing = LocalMap(MotionParameters()), Scene(World("w"))
    map.add(scan(nothing, (0.0, 0.0, 0.0), 0.25), (0.0, 0.0, 0.0), HEIGHT_M, 0.25)
    assert not map.has_low
    map.shut(3.0, 0.0, 0.5, 1.0)
    assert map.has_low
    map.add(scan(nothing, (0.0, 0.0, 0.0)), (0.0, 0.0, 0.0), HEIGHT_M, 0.0)
    map.refresh(MotionParameters().ground_memory_s + 2.0)
    assert not map.has_low
@pytest.mark.parametrize("phase_m", [0.0, 0.06, 0.13, 0.19])
def test_with_a_fine_grid_a_door_is_as_wide_as_it_is_wherever_it_falls_on_the_cells(phase_m: float) -> None:
    p = MotionParameters()
    fine = LocalMap(msgspec.structs.replace(p, path_half_width_m=0.6, wide_half_width_m=2.0, look_m=8.0, join_m=0.3))
    map = LocalMap(p, fine=fine)
    left, right = 0.7 + phase_m, 0.7 - phase_m
    scene = Scene(World("w", shapes=(box("a", 3.0, left, 3.3, 6.0), box("b", 3.0, -6.0, 3.3, -right))))
    for k in range(3):
        for grid in (fine, map):
            grid.add(scan(scene, (0.0, 0.0, 0.0), 0.0, 0.5 * k), (0.0, 0.0, 0.0), HEIGHT_M, 0.0)
    for grid in (fine, map):
        grid.refresh(1.5)
    in_the_door = max(map.clearance_m(3.1, y_m) for y_m in np.arange(-0.7, 0.8, 0.1).tolist())
    assert in_the_door == pytest.approx(0.7, abs=0.11)
    assert map.clearance_m(3.1, 2.0) == 0.0, "a wall stays a wall"


@given(seed=st.integers(0, 200), shift_i=st.integers(-7, 7))
@settings(max_examples=25, deadline=None)
def test_sharpened_clearances_are_those_of_a_slow_twin(seed: int, shift_i: int) -> None:
    rng = np.random.default_rng(seed)
    blunt, fine = rng.uniform(0.0, 9.0, (12, 12)).astype(np.float32), rng.uniform(0.0, 20.0, (30, 30)).astype(np.float32)
    evidence = rng.integers(-4, 6, (30, 30)).astype(np.int8)
    out, ratio, near = blunt.copy(), 2.5, 6.0
    sharpen(blunt, fine, evidence, ratio, float(shift_i), 1.0, near, 2, 11, 0, 12, out)
    for i in range(12):
        for j in range(12):
            inside = [
                float(fine[a, b]) for a in range(30) for b in range(30)
                if i <= (a + 0.5 - shift_i) / ratio < i + 1 and j <= (b + 0.5 - 1.0) / ratio < j + 1 and evidence[a, b] < 0
            ]  # fmt: skip
            is_sharpened = 2 <= i < 11 and 0.5 < blunt[i, j] < near and inside
            assert out[i, j] == pytest.approx(min(max(inside) / ratio, blunt[i, j] + 1.0) if is_sharpened else blunt[i, j], abs=1e-5)
