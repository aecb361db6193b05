"""Who walks there: seen by former free space, followed from scan to scan."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.chain.rig import Disc, Rig
from tests.chain.robots import PIONEER


def points_after(rig: Rig, seconds: float) -> np.ndarray:
    """What avoidance has around the robot after some time, robot frame."""
    rig.run(seconds)
    sight = rig.links["avoid"]._skill.sight
    return np.asarray(sight.points(rig.pose, True, False, rig.now))


def test_a_walker_is_seen_with_his_velocity_and_where_he_is_now() -> None:
    rig = Rig(PIONEER, [Disc(1.8, -1.5, 0.25, (0.0, 0.8))], noise=np.random.default_rng(2))
    points = points_after(rig, 1.55)
    y = rig.discs[0].at(rig.now)[1]
    assert np.median(points[:, 4]) == pytest.approx(0.8, abs=0.15)
    assert np.median(points[:, 3]) == pytest.approx(0.0, abs=0.15)
    assert points[:, 1].mean() == pytest.approx(y, abs=0.12), "carried on from the scan's time to now"
    assert (points[:, 2] == 0.25).all(), "kept farther away"


def test_what_stands_is_not_taken_for_a_walker_while_the_robot_drives_by() -> None:
    rig = Rig(PIONEER, [Disc(2.0, 0.8, 0.2), Disc(2.6, -0.9, 0.1)], [((1.5, -1.4), (3.0, -1.6))], noise=np.random.default_rng(2))
    rig.run(0.6)
    rig.order(0, velocity=(0.5, 0.0))
    for _ in range(35):
        points = points_after(rig, 0.1)
        assert len(points) > 3 and not points[:, 3:].any()
    assert rig.pose[0] > 1.0, "it did drive by"


def test_a_post_passed_is_remembered_and_a_walker_soon_forgotten() -> None:
    rig = Rig(PIONEER, [Disc(0.6, 0.7, 0.1)])
    rig.run(0.6)
    rig.order(0, velocity=(0.5, 0.0))
    rig.run(3.9)
    rig.order(0)
    points = points_after(rig, 5.0)
    assert rig.pose[0] > 1.5
    assert len(points) > 3
    nearest = np.hypot(points[:, 0] + rig.pose[0] - 0.6, points[:, 1] - 0.7)
    assert nearest.max() < 0.15
    assert math.hypot(*points[0, 3:]) == 0.0
