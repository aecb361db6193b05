"""How long a process of ours may be silent, in the time of who looks."""

from __future__ import annotations

import pytest

from pluto_bt.gateway.pulse import FIRST_S, OUR_ABSENCE_S, SILENCE_S, Pulse
from pluto_bt.runtime.clock import NS


def looks(*steps: tuple[float, bool]) -> list[bool]:
    """At these times (s), with or without a word before: is it lost?"""
    pulse, found = Pulse(0), []
    for at_s, speaks in steps:
        if speaks:
            pulse.hear()
        found.append(pulse.is_lost(round(at_s * NS)))
    return found


def every(step_s: float, from_s: float, to_s: float, speaks: bool) -> list[tuple[float, bool]]:
    return [(from_s + i * step_s, speaks) for i in range(1, round((to_s - from_s) / step_s) + 1)]


@pytest.mark.parametrize("step_s", [0.02, 0.5])
def test_who_spoke_and_is_silent_is_lost_after_two_seconds(step_s: float) -> None:
    found = looks((0.0, True), *every(step_s, 0.0, SILENCE_S, speaks=False))
    assert found == [False] * (len(found) - 1) + [True]


def test_who_speaks_is_never_lost() -> None:
    assert not any(looks(*every(0.5, 0.0, 600.0, speaks=True)))


def test_who_begins_may_take_his_time() -> None:
    assert not any(looks(*every(0.5, 0.0, FIRST_S - 1.0, speaks=False), (FIRST_S, True), (FIRST_S + 1.0, False)))
    assert looks(*every(0.5, 0.0, FIRST_S, speaks=False))[-1]


def test_the_absence_of_who_looks_is_not_the_silence_of_the_other() -> None:
    assert looks((0.0, True), (0.5, False), (3600.0, False), (3600.1, True), (3601.0, False)) == [False] * 5
    assert 0.5 + OUR_ABSENCE_S < SILENCE_S
