"""What a scene shows to the laser and the sonars, held against slow and plain twins, and told in small stories."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_worlds import plain, random_world
from slow_rays import inside, slow_range

from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import Actor, OccupancyGrid, Shape, World

SEEDS = st.integers(0, 2**32)
BEAMS = 61
MAX_RANGE_M = 12.0


def scan(scene, pose=(0.0, 0.0, 0.0), z_m=0.6, tilt_rad=0.0, angles=None, max_range_m=MAX_RANGE_M):
    angles = np.linspace(-math.pi / 2, math.pi / 2, BEAMS) if angles is None else np.asarray(angles, dtype=float)
    out = np.full(len(angles), np.nan)
    scene.scan(pose, z_m, tilt_rad, angles, max_range_m, out)
    return out


def one_beam(scene, **how):
    return scan(scene, angles=[0.0], **how)[0]


def must_equal_the_twin(world, pose, z_m, tilt_rad, angles):
    solids, holes = plain(world)
    got = scan(Scene(world), pose, z_m, tilt_rad, angles)
    expected = [slow_range(solids, holes, pose, z_m, tilt_rad, angle, MAX_RANGE_M) for angle in angles]
    assert got == pytest.approx(expected, rel=0, abs=1e-9)


def random_pose(rng):
    return (*rng.uniform(-9, 9, 2), float(rng.uniform(-7, 7)))


FANS = {
    "half a turn": np.linspace(-math.pi / 2, math.pi / 2, BEAMS),
    "a whole turn, both ends the same beam": np.linspace(-math.pi, math.pi, BEAMS),
    "more than a turn": np.linspace(0.3, 8.0, BEAMS),
    "narrow": np.linspace(-0.2, 0.1, BEAMS),
    "behind": np.linspace(2.5, 4.0, BEAMS),
    "falling": np.linspace(1.5, -1.5, BEAMS),
    "uneven": np.cumsum(np.linspace(0.01, 0.09, BEAMS)) - 1.5,
    "one beam": np.array([0.7]),
}


@pytest.mark.parametrize("fan", FANS.values(), ids=FANS.keys())
@settings(max_examples=12, deadline=None)
@given(seed=SEEDS, tilt_rad=st.sampled_from([0.0, 0.0, 0.25, 0.9, -0.3]))
def test_any_fan_in_any_world_of_shapes(fan, seed, tilt_rad):
    world, rng = random_world(seed)
    must_equal_the_twin(world, random_pose(rng), float(rng.uniform(0.1, 2.5)), tilt_rad, fan)


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS, tilt_rad=st.sampled_from([0.0, 0.3, -0.3]))
def test_a_turned_grid_among_shapes(seed, tilt_rad):
    world, rng = random_world(seed, grid=True)
    must_equal_the_twin(world, random_pose(rng), float(rng.choice([0.6, 2.4])), tilt_rad, FANS["half a turn"][::4])


@pytest.mark.parametrize("tilt_rad", [math.pi / 2, -math.pi / 2, 2.0])
def test_a_plane_tilted_beyond_use_is_still_exact(tilt_rad):
    world, _ = random_world(7)
    must_equal_the_twin(world, (0.1, 0.2, 0.3), 1.0, tilt_rad, np.linspace(-1.5, 1.5, 31) + 0.01)


def wall(id, *points, height_m=2.0, absent=False):
    return Shape(id, "wall", np.array(points, dtype=float), 0.0, height_m, absent)


def box(id, x, y, half, kind="polygon", height_m=2.0):
    points = np.array([(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)], dtype=float)
    return Shape(id, kind, points, 0.0, height_m)


def test_a_wall_stands_where_it_was_drawn():
    scene = Scene(World("w", shapes=(wall("fence", (3, -5), (3, 5)),)))
    ranges = scan(scene)
    assert ranges[BEAMS // 2] == 3.0
    assert ranges[BEAMS // 2 + 10] == pytest.approx(3.0 / math.cos(math.radians(30)))
    assert ranges[0] == MAX_RANGE_M


def test_no_beam_slips_through_the_corner_of_two_walls():
    corner = (2.0, 1.0)
    scene = Scene(World("w", shapes=(wall("a", (2.5, -3), corner), wall("b", corner, (1.0, 4)))))
    rng = np.random.default_rng(5)
    for _ in range(200):
        x, y = rng.uniform(-1, 1, 2)
        towards = math.atan2(corner[1] - y, corner[0] - x)
        assert one_beam(scene, pose=(x, y, towards)) == pytest.approx(math.dist((x, y), corner), abs=1e-9)


@pytest.mark.parametrize("place", [(2.0, 0.0), (2.0, 1.0)], ids=["on a wall", "on its end"])
def test_a_laser_on_a_wall_sees_it_at_zero_in_every_direction(place):
    scene = Scene(World("w", shapes=(wall("w", (2, -1), (2, 1)),)))
    assert scan(scene, pose=(*place, 0.3), angles=np.linspace(-3, 3, 30)) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("shape", [box("house", 0, 0, 1), Shape("tree", "circle", np.zeros((1, 2)), 1.0)], ids=["polygon", "circle"])
def test_from_inside_something_solid_all_ranges_are_zero(shape):
    assert (scan(Scene(World("w", shapes=(shape,))), pose=(0.5, 0.5, 0.0)) == 0.0).all()


def test_a_level_scan_passes_over_what_is_lower():
    scene = Scene(World("w", shapes=(box("curb", 2, 0, 0.5, height_m=0.59), box("table", 5, 0, 0.5, height_m=0.6))))
    assert one_beam(scene, z_m=0.6) == 4.5
    assert one_beam(scene, z_m=0.59) == 1.5


def test_a_scan_that_looks_down_sees_the_ground_and_the_top_of_a_curb():
    world = World("w", shapes=(box("curb", 2, 0, 0.5, height_m=0.2),))
    assert one_beam(Scene(World("empty")), tilt_rad=math.radians(30)) == pytest.approx(1.2)
    assert one_beam(Scene(world), tilt_rad=math.atan2(0.6 - 0.2, 2.0)) == pytest.approx(math.hypot(0.4, 2.0))
    assert one_beam(Scene(world), tilt_rad=math.atan2(0.5, 1.5)) == pytest.approx(math.hypot(0.5, 1.5))


def test_the_sideways_beams_of_a_tilted_scan_stay_level():
    scene = Scene(World("w", shapes=(wall("left", (-5, 2), (5, 2)),)))
    assert scan(scene, tilt_rad=0.5, angles=[math.pi / 2])[0] == pytest.approx(2.0)


def test_a_hole_is_seen_only_from_above_down_to_its_floor():
    scene = Scene(World("w", shapes=(box("pit", 3, 0, 1, kind="hole"),)))
    assert one_beam(scene, max_range_m=9.0) == 9.0
    down_on_the_floor = math.atan2(0.6 + 1.0, 3.0)
    flat = one_beam(scene, tilt_rad=math.atan2(0.6, 3.0), max_range_m=30.0)
    assert flat == pytest.approx(math.hypot(4.0, 0.8))  # the far side
    assert one_beam(scene, z_m=2.0, tilt_rad=math.atan2(3.0, 3.9)) == pytest.approx(math.hypot(3.0, 3.9))  # the floor
    assert one_beam(scene, tilt_rad=down_on_the_floor) == pytest.approx(0.6 / math.sin(down_on_the_floor))  # the ground before it
    scene.remove("pit")
    assert one_beam(scene, tilt_rad=math.atan2(0.6, 3.0)) == pytest.approx(math.hypot(0.6, 3.0))


def test_shapes_come_and_go():
    scene = Scene(World("w", shapes=(box("box", 3, 0, 0.5), wall("door", (6, -1), (6, 1), absent=True))))
    assert one_beam(scene) == 2.5
    scene.place("box", 5.0, None)
    assert one_beam(scene) == 4.5
    scene.remove("box")
    scene.remove("box")
    assert one_beam(scene) == MAX_RANGE_M
    scene.place("door", None, None)
    assert one_beam(scene) == 6.0
    scene.place("box", None, None)
    assert one_beam(scene) == 2.5


def test_actors_walk_come_and_go():
    ann = Actor("ann", 0.25, 1.0, True, np.array([[4.0, 0.0], [8.0, 0.0]]))
    bob = Actor("bob", 0.25, 1.0, True, np.array([[2.0, 0.0]]), absent=True)
    scene = Scene(World("w", actors=(ann, bob)))
    assert one_beam(scene) == 3.75
    scene.show_disc("bob", True)
    assert one_beam(scene) == 1.75
    scene.move_disc("bob", 0.0, 5.0)
    scene.move_disc("ann", 7.0, 0.0)
    assert one_beam(scene) == 6.75
    scene.remove("ann")
    assert one_beam(scene) == MAX_RANGE_M
    scene.place("ann", None, None)
    assert one_beam(scene) == 3.75
    assert one_beam(scene, z_m=1.9) == MAX_RANGE_M


@pytest.mark.parametrize(("call", "more"), [("remove", ()), ("place", (1.0, 1.0)), ("move_disc", (0.0, 0.0)), ("show_disc", (True,))])
def test_an_unknown_id_is_refused(call, more):
    scene = Scene(World("w", shapes=(wall("door", (0, 1), (1, 1)),)))
    with pytest.raises(KeyError, match="dor"):
        getattr(scene, call)("dor", *more)


def test_moving_an_actor_outlasts_a_change_of_shapes():
    scene = Scene(World("w", shapes=(box("box", 9, 9, 0.5),), actors=(Actor("ann", 0.25, 1.0, True, np.array([[4.0, 0.0]])),)))
    scene.move_disc("ann", 5.0, 0.0)
    scene.remove("box")
    assert one_beam(scene) == 4.75
    scene.move_disc("ann", 6.0, 0.0)
    assert one_beam(scene) == 5.75


def test_many_segments_in_many_blocks():
    rng = np.random.default_rng(3)
    walls = tuple(wall(f"w{i}", p, p + rng.normal(0, 0.4, 2)) for i, p in enumerate(rng.uniform(-40, 40, (400, 2))))
    must_equal_the_twin(World("w", shapes=walls), (1.0, 2.0, 0.5), 0.6, 0.0, FANS["half a turn"][::3])


def test_changed_angles_in_the_same_array_are_noticed():
    scene = Scene(World("w", shapes=(wall("w", (3, -9), (3, 9)),)))
    angles, out = np.array([0.0]), np.zeros(1)
    scene.scan((0, 0, 0), 0.6, 0.0, angles, 9.0, out)
    angles[0] = math.pi / 3
    scene.scan((0, 0, 0), 0.6, 0.0, angles, 9.0, out)
    assert out[0] == pytest.approx(6.0)


@pytest.mark.parametrize("bad", [{"pose": (math.nan, 0, 0)}, {"pose": (0, 0, math.inf)}, {"z_m": -0.1}, {"z_m": math.nan}, {"max_range_m": math.nan}])
def test_a_scan_from_nowhere_is_refused(bad):
    with pytest.raises(ValueError, match="no scan from"):
        scan(Scene(World("w")), **bad)


# sonar


def cone(scene, x_m=0.0, y_m=0.0, theta_rad=0.0, z_m=0.4, opening_rad=0.44, max_range_m=8.0):
    out = np.zeros(1)
    scene.cones(np.array([x_m]), np.array([y_m]), np.array([theta_rad]), z_m, opening_rad, max_range_m, out)
    return out[0]


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, opening_rad=st.sampled_from([0.05, 0.44, 1.0, math.pi / 2]), with_grid=st.booleans())
def test_a_cone_sees_what_a_dense_bundle_of_rays_sees(seed, opening_rad, with_grid):
    world, rng = random_world(seed, grid=with_grid)
    pose, z_m, n_rays = random_pose(rng), 0.4, 1201
    scene = Scene(world)
    rays = scan(scene, pose, z_m, 0.0, np.linspace(-opening_rad / 2, opening_rad / 2, n_rays), 8.0)
    got = cone(scene, *pose, z_m, opening_rad, 8.0)
    assert got <= rays.min() + 1e-9  # exact: never further than any ray
    # …and nearer only by what fits between two rays, at worst an end of a wall or a corner
    spot = nearest_seen(world, pose, z_m, opening_rad)
    assert got == pytest.approx(spot, rel=0, abs=1e-9)


def nearest_seen(world, pose, z_m, opening_rad):
    """Nearest point in the sector by plain geometry: foot points, ends, and where edges of the sector meet the outline."""
    solids, _ = plain(world)
    apex, best = np.array(pose[:2]), 8.0
    edges = [pose[2] - opening_rad / 2, pose[2] + opening_rad / 2]

    def in_sector(point):
        d = point - apex
        off = math.remainder(math.atan2(d[1], d[0]) - pose[2], math.tau)
        return abs(off) <= opening_rad / 2 + 1e-12

    for kind, points, radius_m, height_m in solids:
        if height_m < z_m:
            continue
        if kind == "circle":
            if math.dist(apex, points[0]) <= radius_m:
                return 0.0
            near = points[0] + (apex - points[0]) / math.dist(apex, points[0]) * radius_m
            best = min(best, math.dist(apex, near)) if in_sector(near) else best
        elif kind == "polygon" and inside(points, *apex):
            return 0.0
        else:
            for p, q in zip(points, np.roll(points, -1, axis=0) if kind == "polygon" else points[1:], strict=False):
                foot = p + (q - p) * np.clip((apex - p) @ (q - p) / ((q - p) @ (q - p)), 0, 1)
                best = min([best, *(math.dist(apex, spot) for spot in (foot, p, q) if in_sector(spot))])
        for edge in edges:
            best = min(best, slow_range([(kind, points, radius_m, height_m)], [], (*pose[:2], edge), z_m, 0.0, 0.0, 8.0))
    return best


def test_a_post_beside_all_rays_but_within_the_cone_is_seen():
    post = Shape("post", "circle", np.array([[3.0, 0.31]]), 0.001)
    assert cone(Scene(World("w", shapes=(post,)))) == pytest.approx(math.hypot(3.0, 0.31) - 0.001)


def test_twelve_cones_at_once_are_twelve_single_cones():
    world, rng = random_world(11, grid=True)
    scene = Scene(world)
    x, y, theta, out = *rng.uniform(-3, 3, (3, 12)), np.zeros(12)
    scene.cones(x, y, theta, 0.4, 0.44, 8.0, out)
    assert out.tolist() == [cone(scene, *each) for each in zip(x, y, theta, strict=True)]


@pytest.mark.parametrize("bad", [{"x_m": math.nan}, {"opening_rad": 0.0}, {"opening_rad": 2.0}, {"z_m": -1.0}])
def test_cones_that_make_no_sense_are_refused(bad):
    with pytest.raises(ValueError, match="no cones of"):
        cone(Scene(World("w")), **bad)


def test_a_grid_is_seen_up_to_its_height():
    occupied = np.zeros((40, 40), dtype=np.uint8)
    occupied[:, 30] = 1
    scene = Scene(World("w", grid=OccupancyGrid(occupied, np.zeros_like(occupied), 0.1, (0.0, -2.0, 0.0))))
    assert one_beam(scene) == pytest.approx(3.0)
    assert one_beam(scene, z_m=2.1) == MAX_RANGE_M
    assert cone(scene) == pytest.approx(3.0)
    assert cone(scene, z_m=2.1) == 8.0


def test_reading_the_module_does_not_import_numba():
    code = "import sys, pluto_bt.maps.scene; sys.exit(any(name in sys.modules for name in ('numba', 'scipy', 'shapely')))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
