"""Where somebody walked lately: seen by the laser as far as it looks, taken off the map when a way through there is asked for."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.blackboard.messages import LaserScan, read_only
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import Shape, World
from pluto_bt.skills.local_map import LocalMap
from pluto_bt.skills.motion_parameters import MotionParameters
from pluto_bt.skills.outline import Planar, outline_of
from pluto_bt.skills.walked_ground import HIDDEN_M, LONGEST_S, MEMORY_S, WalkedGround, grown_old
from pluto_bt.skills.ways import Ways
from tests.chain.robots import ATRV2

HERE, BACK = (0.0, 0.0, 0.0), (0.0, 0.0, math.pi)
ANGLES = np.radians(np.arange(361) / 2.0 - 90.0)
OUTLINE = outline_of(ATRV2.body.outline_m)
SCAN_S, DOOR_M, LOOKED_S = 0.2, 7.0, 12.0
GOAL = (11.0, 0.0)


def wall(name: str, *points: tuple[float, float]) -> Shape:
    return Shape(name, "wall", np.array(points))


HALL = (
    wall("hall", (-3.0, -4.0), (14.0, -4.0), (14.0, 4.0), (-3.0, 4.0), (-3.0, -4.0)), wall("right", (DOOR_M, -4.0), (DOOR_M, -0.9)),
    wall("left", (DOOR_M, 0.9), (DOOR_M, 4.0)),
)  # fmt: skip


def scan_of(shapes: tuple[Shape, ...], laser: Planar, stamp_s: float, noise: np.random.Generator) -> LaserScan:
    out = np.zeros(len(ANGLES))
    Scene(World("hall", shapes=shapes)).scan(laser, 0.6, 0.0, ANGLES, 80.0, out)
    return LaserScan(stamp_s, float(ANGLES[0]), math.radians(0.5), read_only(out + noise.normal(0.0, 0.01, len(out))), len(out))


def watched(pace_m: float) -> tuple[LocalMap, WalkedGround]:
    """After twelve seconds of looking at a doorway in which somebody stands, or paces so far to each side at half a metre a second."""
    map, walked, noise = LocalMap(MotionParameters()), WalkedGround(20.0), np.random.default_rng(5)
    map.add(scan_of(HALL, BACK, 0.0, noise), BACK, 0.6, 0.0)
    for k in range(round(LOOKED_S / SCAN_S)):
        y = pace_m * (2.0 / math.pi) * math.asin(math.sin(0.5 * math.pi * 0.5 * k * SCAN_S / max(pace_m, 0.1)))
        scan = scan_of((*HALL, Shape("body", "circle", np.array([[DOOR_M, y]]), 0.25)), HERE, k * SCAN_S, noise)
        map.add(scan, HERE, 0.6, 0.0)
        walked.take(scan, HERE)
    map.refresh(LOOKED_S)
    return map, walked


def test_through_a_doorway_in_which_somebody_paces_there_is_a_way_but_for_him() -> None:
    map, walked = watched(0.5)
    ways, places = Ways(map, OUTLINE), walked.places(LOOKED_S)
    assert ways.to_goal(HERE, GOAL, None) is None
    way = ways.to_goal(HERE, GOAL, None, map.without_walkers(places, LOOKED_S))
    assert way is not None and way.leads_there
    assert np.abs(places - (DOOR_M, 0.0)).max() < 0.9, "the walls are nobody"
    assert ways.to_goal(HERE, GOAL, None) is None, "the map itself still shows him"


def test_a_post_in_the_doorway_is_nobody() -> None:
    _, walked = watched(0.0)
    assert not len(walked.places(LOOKED_S))


def test_who_is_gone_is_forgotten_after_the_laser_looked_in_vain_for_a_while() -> None:
    _, walked = watched(0.5)
    noise, now_s = np.random.default_rng(6), LOOKED_S
    for _ in range(round((MEMORY_S - 5.0) / SCAN_S)):
        walked.take(scan_of(HALL, HERE, now_s, noise), HERE)
        now_s += SCAN_S
    assert len(walked.places(now_s))
    for _ in range(round(6.0 / SCAN_S)):
        walked.take(scan_of(HALL, HERE, now_s, noise), HERE)
        now_s += SCAN_S
    assert not len(walked.places(now_s))


@pytest.mark.parametrize(("laser", "others"), [(BACK, ()), (HERE, (wall("screen", (2.0, -3.0), (2.0, 3.0)),))], ids=["away", "hidden"])
def test_while_nobody_sees_the_place_he_may_walk_there_still(laser: Planar, others: tuple[Shape, ...]) -> None:
    _, walked = watched(0.5)
    noise, now_s = np.random.default_rng(7), LOOKED_S
    for _ in range(round(2.0 * MEMORY_S / SCAN_S)):
        walked.take(scan_of((*HALL, *others), laser, now_s, noise), laser)
        now_s += SCAN_S
    assert len(walked.places(now_s)) and not len(walked.places(now_s, MEMORY_S)), "but not that he did so lately"
    assert not len(walked.places(LOOKED_S + LONGEST_S))


def test_what_a_scan_that_looks_down_finds_where_somebody_walks_are_his_feet() -> None:
    map, walked = watched(0.5)
    x, y = walked.places(LOOKED_S)[-1].tolist()
    map.shut(x, y, 0.2, LOOKED_S)
    map.shut(2.0, 1.0, 0.2, LOOKED_S)
    map.forget_feet(walked.places(LOOKED_S))
    assert map.low_s[map.cell(x, y)] < 0.0 < map.low_s[map.cell(2.0, 1.0)]


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_steps_grow_old_one_by_one_as_they_do_all_at_once(seed: int) -> None:
    rng = np.random.default_rng(seed)
    laser, stamp_s, watched_s, count = (0.4, -0.3, float(rng.uniform(-7.0, 7.0))), 130.0, 0.2, int(rng.integers(1, 30))
    steps = np.column_stack((rng.uniform(-9.0, 9.0, (count, 2)), rng.uniform(0.0, stamp_s, count), rng.uniform(0.0, 1.2 * MEMORY_S, count)))
    ranges_m = rng.uniform(0.5, 12.0, len(ANGLES))
    ranges_m[rng.random(len(ANGLES)) < 0.05] = np.nan

    dx, dy = steps[:, 0] - laser[0], steps[:, 1] - laser[1]
    bearings = np.remainder(np.arctan2(dy, dx) - laser[2] + np.pi, 2.0 * np.pi) - np.pi
    beams = np.rint((bearings - ANGLES[0]) / math.radians(0.5)).astype(np.intp)
    is_in_field = (beams >= 0) & (beams < len(ANGLES))
    is_seen = is_in_field & (ranges_m[np.clip(beams, 0, len(ANGLES) - 1)] > np.hypot(dx, dy) - HIDDEN_M)
    seconds = steps[:, 3] + watched_s * is_seen
    kept = (seconds < MEMORY_S) & (stamp_s - steps[:, 2] < LONGEST_S)

    assert grown_old(steps, read_only(ranges_m), float(ANGLES[0]), math.radians(0.5), laser, stamp_s, watched_s).tolist() == kept.tolist()
    assert steps[:, 3].tolist() == seconds.tolist()
