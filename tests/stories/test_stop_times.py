"""Stop times: a seeded tenth of `pluto bench stop-times`, each cause by itself."""

from __future__ import annotations

import math

import pytest

from pluto_bt.bench.killed import killed_times_s
from pluto_bt.bench.stop_times import CAUSES, TRIALS, Cause, bumper_times_s, row_of, stop_times_s

TENTH = TRIALS // 10


@pytest.mark.parametrize("cause", CAUSES, ids=[cause.name for cause in CAUSES])
def test_zero_is_commanded_in_time(cause: Cause) -> None:
    times_s = stop_times_s(cause, TENTH, seed=2)
    assert len(times_s) == TENTH
    assert 0.0 < row_of(cause.name, times_s, cause.limit_s).value <= cause.limit_s


def test_a_pressed_bumper_stops_the_robot_in_time() -> None:
    times_s = bumper_times_s(TENTH // 4, seed=2)
    assert max(times_s) <= 0.1
    assert not math.isinf(max(times_s))


def test_software_that_is_killed_leaves_a_base_that_stops_by_itself() -> None:
    """A real process, SIGKILL: the base's own dead-man, 0.3 s after the last command that it heard."""
    times_s = killed_times_s(8, seed=2)
    assert len(times_s) == 8 and max(times_s) <= 0.3
