"""What avoidance makes of scans: which ones it trusts."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pluto_bt.blackboard.messages import LaserScan, read_only
from pluto_bt.skills import reasons
from pluto_bt.skills.avoid_parameters import AvoidParameters
from pluto_bt.skills.outline import outline_of
from pluto_bt.skills.sight import ScanView, Sight
from pluto_bt.skills.verdict import ALL_WELL
from tests.chain.robots import ATRV2

RANGES_M = read_only(3.0 + np.sin(np.arange(181) / 30.0))


@pytest.mark.parametrize(
    ("turned_rad", "is_trusted"),
    [(0.0, True), (0.015, True), (-0.015, True), (0.05, False), (-0.05, False)],
)
@pytest.mark.parametrize("heading_rad", [0.0, math.pi - 0.01, 0.01 - math.pi])
def test_the_same_scan_again_is_frozen_only_if_the_robot_turned(heading_rad: float, turned_rad: float, is_trusted: bool) -> None:
    """A heading that steps over +-180 degrees is no turn."""
    sight = Sight(ATRV2, AvoidParameters(), outline_of(ATRV2.body.outline_m))
    for stamp_s, theta_rad in ((0.0, heading_rad), (0.2, math.remainder(heading_rad + turned_rad, math.tau))):
        at = (0.0, 0.0, theta_rad)
        sight.look(ScanView(LaserScan(stamp_s, -math.pi / 2, math.pi / 180, RANGES_M, 181), at), None, at, True, stamp_s + 0.1)
    verdict = sight.laser_fault(0.3)
    assert (verdict == ALL_WELL) == is_trusted and (is_trusted or verdict.reason == reasons.LASER_STALE)


def see(sight: Sight, stamp_s: float, ranges_m: np.ndarray, x_m: float) -> None:
    at = (x_m, 0.0, 0.0)
    sight.look(ScanView(LaserScan(stamp_s, -math.pi / 2, math.pi / 180, read_only(ranges_m), len(ranges_m)), at), None, at, True, stamp_s + 0.1)


@pytest.mark.parametrize("half", [slice(None, 90), slice(90, None)], ids=["right", "left"])
def test_a_half_that_stays_the_same_although_the_robot_drives_is_not_trusted(half: slice) -> None:
    sight = Sight(ATRV2, AvoidParameters(), outline_of(ATRV2.body.outline_m))
    rng = np.random.default_rng(1)
    for k in range(4):
        ranges = 3.0 + rng.normal(0.0, 0.01, 181)
        ranges[half] = RANGES_M[half]
        see(sight, 0.2 * k, ranges, 0.1 * k)
    assert sight.laser_fault(0.7).reason == reasons.LASER_STALE


def test_avoidance_that_looks_once_a_second_may_drive_the_stop_filter_is_stricter() -> None:
    sight, rng = Sight(ATRV2, AvoidParameters(), outline_of(ATRV2.body.outline_m)), np.random.default_rng(1)
    for k in range(4):
        see(sight, 1.0 * k, 3.0 + rng.normal(0.0, 0.01, 181), 0.1 * k)
        assert sight.laser_fault(k + 0.3) == ALL_WELL
        assert sight.laser_fault(k + 0.9).reason == reasons.LASER_STALE


@pytest.mark.parametrize(("y_m", "is_there"), [(0.0, True), (-0.4, False)])
def test_what_left_the_field_of_view_is_not_where_the_robot_stands_now(y_m: float, is_there: bool) -> None:
    """Somebody who walked past its flank left his outline there; or what was pushed away."""
    sight = Sight(ATRV2, AvoidParameters(), outline_of(ATRV2.body.outline_m))
    ranges_m = 5.0 + 0.1 * np.sin(np.arange(181) / 7.0)
    ranges_m[:4] = 0.6
    see(sight, 0.0, ranges_m, 0.0)
    see(sight, 0.2, ranges_m + np.where(np.arange(181) < 4, 4.4, 0.1), 0.3)
    points = sight.points((0.3, y_m, 0.0), True, False, 0.3)
    assert bool((np.hypot(points[:, 0] + 0.3, points[:, 1] + 0.6 + y_m) < 0.1).any()) == is_there
