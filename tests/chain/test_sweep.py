"""The predictive check: the leaping kernel against a plain small-step twin, and the stopping law on paper."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.skills.drive import DriveParameters, drive_limits
from pluto_bt.skills.outline import outline_of
from pluto_bt.skills.sweep import BRAKING_SHARE, EXACT_M, allowed_share, braking_time_s, first_contact
from tests.chain.robots import ATRV2, PIONEER

LIMITS = drive_limits(ATRV2, DriveParameters())
OUTLINE = outline_of(ATRV2.body.outline_m)


def point(x: float, y: float, margin: float = 0.1, vx: float = 0.0, vy: float = 0.0) -> np.ndarray:
    return np.array([[x, y, margin, vx, vy]])


def plain_contact(p: np.ndarray, v: float, w: float, horizon: float) -> float:
    """Small steps: the first time at which the point is within its margin."""
    x, y, margin, vx, vy = p[0]
    for t in np.arange(0.0, horizon, 0.002):
        th = w * t
        rx, ry = (v * t, 0.0) if abs(w) < 1e-9 else (v / w * math.sin(th), v / w * (1.0 - math.cos(th)))
        dx, dy = x + vx * t - rx, y + vy * t - ry
        if OUTLINE.distance_m(math.cos(th) * dx + math.sin(th) * dy, math.cos(th) * dy - math.sin(th) * dx) <= margin:
            return float(t)
    return horizon


@settings(max_examples=60, deadline=None)
@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_the_leaping_check_finds_what_small_steps_find(x: float, y: float, v: float, w: float, vx: float, vy: float) -> None:
    p = point(x, y, 0.1, vx, vy)
    if OUTLINE.distance_m(x, y) < 0.1 + 2 * EXACT_M:
        return
    found, which = first_contact(p, OUTLINE.planes, v, w, 2.0)
    plain = plain_contact(p, v, w, 2.0)
    grazing = plain_contact(point(x, y, 0.1 - 2 * EXACT_M, vx, vy), v, w, 2.0)
    assert found <= plain + 1e-9  # never later than the truth
    assert which == -1 or found >= plain_contact(point(x, y, 0.1 + 2 * EXACT_M, vx, vy), v, w, 2.0) - 0.004
    assert grazing >= plain


def test_straight_ahead_it_is_distance_over_speed() -> None:
    t, which = first_contact(point(1.585, 0.2), OUTLINE.planes, 0.5, 0.0, 10.0)
    assert (t, which) == (pytest.approx(0.9 / 0.5, abs=0.01), 0)


@pytest.mark.parametrize(
    ("name", "x", "y", "v", "w", "meets"),
    [
        ("behind does not matter going ahead", -0.8, 0.0, 0.5, 0.0, False),
        ("behind matters going back", -0.8, 0.0, -0.5, 0.0, True),
        ("beside does not matter going straight", 0.0, 0.6, 0.5, 0.0, False),
        ("beside matters turning on the spot: the corners swing out", 0.0, 0.6, 0.0, 0.5, True),
        ("outside the corners' circle turning is free", 0.0, 0.9, 0.0, 0.5, False),
        ("in a bend the inner side matters", 0.8, 0.8, 0.5, 0.5, True),
        ("a point deep inside is the robot itself", 0.1, 0.1, 0.5, 0.5, False),
    ],
)
def test_what_matters(name: str, x: float, y: float, v: float, w: float, meets: bool) -> None:
    assert (first_contact(point(x, y), OUTLINE.planes, v, w, 3.0)[1] == 0) == meets


def test_a_walker_is_met_although_the_robot_passes_where_he_is_now() -> None:
    assert first_contact(point(1.5, -1.5), OUTLINE.planes, 0.5, 0.0, 3.0)[1] == -1
    assert first_contact(point(1.5, -1.5, 0.1, 0.0, 0.6), OUTLINE.planes, 0.5, 0.0, 3.0)[1] == 0


def test_within_the_margin_only_creeping_nearer_and_at_the_floor_only_leaving() -> None:
    ahead = lambda gap: point(0.585 + gap, 0.0)  # noqa: E731
    assert first_contact(ahead(0.09), OUTLINE.planes, 0.5, 0.0, 1.0)[0] == pytest.approx(0.02 / 0.5, abs=0.01)
    assert first_contact(ahead(0.02), OUTLINE.planes, 0.5, 0.0, 1.0)[0] == pytest.approx(0.0, abs=0.01)
    assert first_contact(ahead(0.02), OUTLINE.planes, -0.5, 0.0, 1.0) == (1.0, -1)


@given(st.floats(0.0, 3.0), st.floats(-0.9, 0.9), st.floats(-0.8, 0.8), st.floats(0.0, 0.6))
def test_the_allowed_share_stops_in_time(free_s: float, v: float, w: float, latency_s: float) -> None:
    share = allowed_share(free_s, (v, w), LIMITS, latency_s)
    assert 0.0 <= share <= 1.0
    assert share * latency_s + share * share * braking_time_s((v, w), LIMITS) <= free_s + 1e-9 or share == 0.0


def test_the_stopping_law_is_that_of_the_book() -> None:
    """v * latency + v² / 2a = distance."""
    latency_s, distance_m = 0.25, 0.3
    v = 0.9 * allowed_share(distance_m / 0.9, (0.9, 0.0), LIMITS, latency_s)
    assert v * latency_s + v * v / (2.0 * BRAKING_SHARE * LIMITS.deceleration_mps2) == pytest.approx(distance_m)


def test_an_outline_is_measured_from_its_edges() -> None:
    assert OUTLINE.distance_m(1.585, 0.0) == pytest.approx(1.0)
    assert OUTLINE.distance_m(0.0, -0.925) == pytest.approx(0.5)
    assert OUTLINE.distance_m(0.0, 0.0) == pytest.approx(-0.425)
    assert OUTLINE.way_out_m(0.0, 0.0, 1.0, 0.0) == pytest.approx(0.585)
    octagon = outline_of(PIONEER.body.outline_m)
    assert len(octagon.planes) == 8
    assert octagon.side_m == pytest.approx(0.2)


def test_a_hollow_outline_counts_as_filled() -> None:
    hollow = outline_of([(1.0, 1.0), (0.0, 0.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
    assert hollow.distance_m(0.0, 0.9) < 0.0
