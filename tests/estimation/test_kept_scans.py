"""Which scan another one is held against: the key scan while the laser looks the same way, else a kept one that did, and none after too long."""

from __future__ import annotations

import math

import numpy as np
import pytest

from estimation.kept_scans import FAR_KEYS, KEPT, KEY_WAY_M, LONGEST_GAP_S, KeptScans, held_against, is_far, pan_between
from estimation.key_scan import Beams, KeyScan, is_good
from estimation.reckoning import Sums
from estimation.se2 import Pose2, compose
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import Shape, World

ANGLES = np.linspace(-math.pi / 2, math.pi / 2, 361)
BEAMS = Beams(float(ANGLES[0]), float(ANGLES[1] - ANGLES[0]), 80.0)
ROOM = Scene(World("room", shapes=(
    Shape("walls", "wall", np.array([(-9.0, -5.0), (12.0, -5.0), (12.0, 8.0), (-9.0, 8.0), (-9.0, -5.0)])),
    Shape("crate", "polygon", np.array([(3.0, 2.0), (4.0, 2.2), (3.8, 3.0), (3.0, 3.0)])),
    Shape("post", "circle", np.array([[-3.0, 4.0]]), 0.2),
)))  # fmt: skip


def scan(stamp_s: float, x_m: float = 0.0, pan_rad: float = 0.0, n_beams: int = len(ANGLES)) -> KeyScan:
    """A scan in the room, of a robot at (x, 0) that knows where it is, with its laser panned."""
    arm: Pose2 = (0.4, 0.0, pan_rad)
    ranges_m = np.zeros(len(ANGLES))
    ROOM.scan(compose((x_m, 0.0, 0.0), arm), 0.5, 0.0, ANGLES, 80.0, ranges_m)
    return KeyScan(Sums(stamp_s, (x_m, 0.0, 0.0)), ranges_m[:n_beams], arm)


def kept(*scans: KeyScan) -> KeptScans:
    those = KeptScans()
    for one in scans:
        those.keep(one)
    return those


def test_a_scan_is_held_against_the_key_scan_while_the_laser_looks_the_same_way() -> None:
    key, now = scan(0.0), scan(1.0, 0.3)
    held = kept().compared(now, key, BEAMS)
    assert held is not None and held[0] is key and is_good(held[2])
    assert held[1].pose == pytest.approx((0.3, 0.0, 0.0)) and held[1].time_s == 1.0
    assert compose(held[2].step, (0.0, 0.0, 0.0)) == pytest.approx((0.3, 0.0, 0.0), abs=0.01)


def test_a_laser_that_looks_left_and_right_by_turns_is_held_against_what_it_saw_on_the_same_side() -> None:
    left, right = scan(0.0, pan_rad=1.4), scan(0.2, pan_rad=-1.4)
    now = scan(0.4, 0.1, pan_rad=1.4)
    held = kept(left, right).compared(now, right, BEAMS)
    assert held is not None and held[0] is left and is_good(held[2])
    assert kept(right).compared(now, right, BEAMS) is None, "nothing that it sees was seen before"


def test_of_two_on_the_same_side_the_newer_one_counts() -> None:
    older, newer = scan(0.0, pan_rad=1.4), scan(0.2, pan_rad=1.4)
    held = kept(older, newer).compared(scan(0.6, pan_rad=1.4), scan(0.4, pan_rad=-1.4), BEAMS)
    assert held is not None and held[0] is newer


def test_what_is_forgotten_or_long_ago_is_not_asked() -> None:
    first = scan(0.0, pan_rad=1.4)
    those = kept(first, *(scan(0.1 + 0.1 * k, pan_rad=-1.4) for k in range(KEPT)))
    now, away = scan(9.0, pan_rad=1.4), scan(8.0, pan_rad=-1.4)
    assert those.compared(now, away, BEAMS) is None, "so many more came since"
    those.keep(first)
    assert those.compared(now, away, BEAMS) is not None
    those.forget()
    assert those.compared(now, away, BEAMS) is None


@pytest.mark.parametrize(
    ("gap_s", "way_m", "is_comparable"),
    [(LONGEST_GAP_S, 0.0, True), (LONGEST_GAP_S + 0.1, 0.0, False), (0.0, 0.0, False), (1.0, FAR_KEYS * KEY_WAY_M + 0.1, False)],
    ids=["a minute", "longer", "itself", "too far away"],
)
def test_two_scans_are_compared_within_a_time_and_a_way(gap_s: float, way_m: float, is_comparable: bool) -> None:
    assert (held_against(scan(1.0), scan(1.0 + gap_s, way_m), BEAMS) is not None) is is_comparable


def test_scans_of_another_laser_are_not_compared() -> None:
    assert kept().compared(scan(1.0, n_beams=181), scan(0.0), BEAMS) is None


def test_how_far_and_how_much_panned_is_said_the_shorter_way_round() -> None:
    assert pan_between(scan(0.0, pan_rad=3.0), scan(1.0, pan_rad=-3.0)) == pytest.approx(math.tau - 6.0)
    assert is_far((0.0, 1.1, 0.0), 1.0) and is_far((0.0, 0.0, -0.6), 1.0) and not is_far((0.7, 0.7, 0.4), 1.0)
