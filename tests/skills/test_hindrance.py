"""A car that is told to drive and stands: when it is told, and when it is not."""

from __future__ import annotations

import pytest

from pluto_bt.skills.hindrance import Hindrance
from pluto_bt.skills.verdict import ALL_WELL

PULSE_M = 0.0641  # of the car's odometer
STEP_S = 0.05


def drive(watch: Hindrance, told_mps: float, real_mps: float, seconds: float, begin: tuple[float, float] = (0.0, 0.0)) -> list[str]:
    """The words, step by step, of a car that drives `real_mps` from (time s, way m) on and counts in pulses."""
    since_s, way_m = begin
    words = []
    for k in range(1, round(seconds / STEP_S) + 1):
        counted_m = (way_m + real_mps * k * STEP_S) // PULSE_M * PULSE_M
        words.append(watch.step(told_mps, counted_m, since_s + k * STEP_S).reason)
    return words


@pytest.mark.parametrize("told_mps", [0.9, 0.5, 0.3, -0.3, 0.16])
def test_wheels_that_stand_are_told_after_a_second(told_mps: float) -> None:
    words = drive(Hindrance(), told_mps, 0.0, 3.0)
    assert words.index("hindered") == pytest.approx(1.0 / STEP_S, abs=1.0)
    assert set(words[21:]) == {"hindered"}


@pytest.mark.parametrize("told_mps", [0.9, 0.5, 0.3, -0.5, 0.1, 0.05])
def test_a_car_that_drives_is_never_told_however_coarse_its_pulses(told_mps: float) -> None:
    assert set(drive(Hindrance(), told_mps, told_mps, 30.0)) == {""}


def test_it_clears_when_the_wheels_turn_again_and_when_nothing_is_asked() -> None:
    watch = Hindrance()
    assert drive(watch, 0.5, 0.0, 2.0)[-1] == "hindered"
    assert drive(watch, 0.5, 0.5, 1.0, (2.0, 0.0))[-1] == ""
    assert drive(watch, 0.5, 0.0, 2.0, (3.0, 0.5))[-1] == "hindered"
    assert watch.step(0.0, 0.5, 5.05) is ALL_WELL


def test_the_sentence_has_the_figures() -> None:
    watch = Hindrance()
    drive(watch, 0.5, 0.0, 1.0)
    assert watch.step(0.5, 0.0, 1.05).text == "told to drive 0.50 m within 1.0 s, and the wheels have counted 0.00 m"
