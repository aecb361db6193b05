"""The benchmark of the rays runs with and without the yardsticks, and says which."""

from __future__ import annotations

import math

from pluto_bt.bench import rays


def test_without_the_yardsticks_it_says_so_and_measures_the_rest(tmp_path, monkeypatch):
    monkeypatch.setenv("PLUTO_SHARED", str(tmp_path))
    monkeypatch.setattr(rays, "best_us", lambda call: (call(), 1.0)[1])
    rows = rays.run()
    assert math.isnan(rows[0].value)
    assert "ray_baselines.py is not there" in rows[0].note
    assert [row.unit for row in rows[1:]] == ["us"] * 4


def test_a_ratio_is_ours_by_theirs_and_tells_how_far_ranges_differ(monkeypatch):
    monkeypatch.setattr(rays, "best_pair_us", lambda ours, theirs, repeats: (ours(), theirs(), (2.0, 8.0))[2])
    scene = rays.Scene(rays.World("empty"))

    def baseline(pose, out_m):
        out_m[:] = 29.5

    (row,) = rays.compare("scan", scene, [(0.0, 0.0, 0.0)], baseline, 30.0, "<= 0.25")
    assert (row.value, row.unit, row.target) == (0.25, "x", "<= 0.25")
    assert "differ by 5e-01 m" in row.note
