"""The jBot figure on two seeds (`pluto bench jbot` has twenty): 1000 feet out and back between trees."""

from __future__ import annotations

from pluto_bt.bench import jbot


def test_with_the_sensor_s_heading_the_error_stays_below_half_a_percent_where_the_wheels_alone_are_lost() -> None:
    journeys = [jbot.journey(seed) for seed in (0, 1)]
    fused, wheels, back = jbot.rows_of(journeys)
    assert back.value == 100.0, [one.runner.result.text for one in journeys]
    assert all(one.runner.result.distance_m >= 2.0 * jbot.OUT_M - 1.0 for one in journeys)
    assert fused.value <= jbot.TARGET_PERCENT
    assert wheels.value > 5.0 * fused.value
