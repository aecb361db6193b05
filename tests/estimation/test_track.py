"""The dead-reckoned track: memory, adjustment, covariances."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimation.covariance import ZERO, as_nine
from estimation.se2 import Pose2, arc, compose, inverse
from estimation.track import Track
from pluto_bt.maps.geometry import wrap_angle

DT_S = 0.02
POSES = st.tuples(st.floats(-50, 50), st.floats(-50, 50), st.floats(-3, 3))


def driven(steps: int, v_mps: float = 0.5, w_radps: float = 0.3, start: Pose2 = (1.0, 2.0, 0.3), moments: int = 256) -> Track:
    track = Track(start, 0.0, moments)
    for k in range(1, steps + 1):
        track.advance(k * DT_S, arc(v_mps * DT_S, w_radps * DT_S), 1e-6, 1e-7)
    return track


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(0, 1.9))
def test_a_past_pose_is_exact_under_a_constant_twist(v: float, w: float, stamp_s: float) -> None:
    track = driven(100, v, w)
    then = track.at(stamp_s)
    assert then is not None
    assert then.pose_odom == pytest.approx(compose((1.0, 2.0, 0.3), arc(v * stamp_s, w * stamp_s)), abs=1e-9)


@pytest.mark.parametrize("stamp_s", [-0.1, 2.001, 5.0])
def test_a_stamp_outside_the_memory_has_no_pose_and_adjusts_nothing(stamp_s: float) -> None:
    track = driven(100)
    before = track.now.pose_map
    assert track.at(stamp_s) is None
    assert not track.adjust(stamp_s, (9.0, 9.0, 0.0), ZERO)
    assert track.now.pose_map == before


def test_the_memory_is_bounded() -> None:
    track = driven(100, moments=10)
    assert track.at(1.0) is None
    assert track.at(1.9) is not None


@settings(max_examples=50)
@given(st.lists(st.tuples(st.floats(-1, 1), st.floats(-2, 2), st.one_of(st.none(), POSES)), min_size=1, max_size=30))
def test_dead_reckoning_never_moves_more_than_v_dt_whatever_is_posted(story: list[tuple[float, float, Pose2 | None]]) -> None:
    track = Track((0.0, 0.0, 0.0))
    for k, (v, w, post) in enumerate(story, 1):
        before = track.now.pose_odom
        track.advance(k * DT_S, arc(v * DT_S, w * DT_S), 1e-6, 1e-6)
        if post is not None:
            assert track.adjust((k - 0.5) * DT_S, post, ZERO)
        assert math.dist(before[:2], track.now.pose_odom[:2]) <= abs(v) * DT_S + 1e-12
        assert track.now.pose_odom[2] - before[2] == pytest.approx(w * DT_S)


def test_a_post_about_the_past_is_carried_to_now() -> None:
    track = driven(100)
    then = track.at(1.01)
    assert then is not None
    post = (5.0, -3.0, 1.0)
    assert track.adjust(1.01, post, ZERO)
    way = compose(inverse(then.pose_odom), track.now.pose_odom)
    assert track.now.pose_map == pytest.approx(compose(post, way))
    again = track.at(1.01)
    assert again is not None
    assert again.pose_map[:2] == pytest.approx(post[:2], abs=1e-6)
    assert abs(wrap_angle(again.pose_map[2] - post[2])) < 1e-9


def test_covariance_since_a_post_grows_from_that_of_the_post() -> None:
    track, P = driven(100), (0.04, 0.0, 0.0, 0.04, 0.0, 0.01)
    track.adjust(2.0, track.now.pose_map, P)
    assert track.now.covariance_map == pytest.approx(P)
    for k in range(101, 151):
        track.advance(k * DT_S, arc(0.01, 0.0), 1e-6, 1e-7)
    assert all(track.now.covariance_map[i] > P[i] for i in (0, 3, 5))
    assert track.now.covariance_odom[5] < P[5]  # interface 0 knows nothing of the post


def test_increments_between_scans_add_up_to_the_covariance_since_the_start() -> None:
    track = driven(100)
    stamps = [0.0, 0.31, 0.5, 1.234, 2.0]
    P = np.zeros((3, 3))
    for before, after in itertools.pairwise(stamps):
        a, b = track.at(before), track.at(after)
        assert a is not None and b is not None
        dx, dy = b.pose_odom[0] - a.pose_odom[0], b.pose_odom[1] - a.pose_odom[1]
        F = np.array([[1, 0, -dy], [0, 1, dx], [0, 0, 1]])
        P = F @ P @ F.T + np.array(as_nine(track.increment_covariance(before, after))).reshape(3, 3)
    np.testing.assert_allclose(P.ravel(), as_nine(track.now.covariance_odom), rtol=1e-3, atol=1e-9)


def test_time_must_move_on() -> None:
    track = driven(1)
    with pytest.raises(ValueError, match=r"step at 0\.02 s"):
        track.advance(0.02, (0.0, 0.0, 0.0), 0.0, 0.0)


def test_a_step_at_rest_is_cheap_in_uncertainty() -> None:
    track = Track((0.0, 0.0, 0.0))
    track.advance(0.02, (0.0, 0.0, 0.0), 0.0, 0.0)
    assert track.now.covariance_odom == ZERO
