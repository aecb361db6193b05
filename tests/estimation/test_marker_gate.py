"""The marker gate, row by row (seed 002; DESIGN.md, section 9)."""

from __future__ import annotations

import math

import pytest

from estimation.marker_gate import MarkerGate

NAN = math.nan


@pytest.mark.parametrize(
    ("x", "y", "theta_deg", "quality", "heading_deg", "verdict"),
    [
        (1.0, 1.0, 0.0, 0.25, 0.0, ""),
        (1.0, 1.0, 0.0, 1.479, 0.0, ""),  # values above 1 exist
        (1.0, 1.0, 0.0, 0.2499, 0.0, "low-quality"),
        (1.0, 1.0, 0.0, NAN, 0.0, "low-quality"),
        (1.0, 1.0, 0.0, math.inf, 0.0, "low-quality"),
        (1.0, 1.0, 44.9, 0.5, 0.0, ""),
        (1.0, 1.0, 45.1, 0.5, 0.0, "bad-heading"),
        (1.0, 1.0, -170.0, 0.5, 170.0, ""),  # 20 degrees, across the seam
        (1.0, 1.0, 180.0, 0.5, 0.0, "bad-heading"),
        (1.0, 1.0, NAN, 0.5, 0.0, "bad-heading"),
        (900.0, 1.0, 0.0, 0.5, 0.0, ""),  # the first one has no speed test
        (NAN, 1.0, 0.0, 0.5, 0.0, "too-fast"),
    ],
)
def test_the_first_marker(x: float, y: float, theta_deg: float, quality: float, heading_deg: float, verdict: str) -> None:
    assert MarkerGate().judge(1.0, (x, y, math.radians(theta_deg)), quality, math.radians(heading_deg)) == verdict


@pytest.mark.parametrize(
    ("dt_s", "way_m", "verdict"), [(1.0, 0.99, ""), (1.0, 1.0, "too-fast"), (3.0, 2.5, ""), (0.0, 0.0, "not-newer"), (-1.0, 0.0, "not-newer")]
)
def test_the_next_marker_must_be_reachable_from_the_last_accepted_one(dt_s: float, way_m: float, verdict: str) -> None:
    gate = MarkerGate()
    assert gate.judge(1.0, (0.0, 0.0, 0.0), 0.5, 0.0) == ""
    assert gate.judge(1.1, (5.0, 0.0, 0.0), 0.5, 0.0) == "too-fast"  # refused: the last accepted one stays where it was
    assert gate.judge(1.0 + dt_s, (way_m, 0.0, 0.0), 0.5, 0.0) == verdict
    assert gate.accepted_count == (1 if verdict else 2)
