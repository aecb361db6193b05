"""For how long the chain has held a robot back: words that flicker, words that take turns, words that come anew."""

from __future__ import annotations

import pytest

from pluto_bt.behaviours.patience import CLEAR_S, Patience

STEP_S = 0.1


def waited_s(words: list[str]) -> float:
    """After these words, one a step of 0.1 s."""
    patience, now_s = Patience(), 0.0
    for word in words:
        waited = patience.waited_s(word, now_s)
        now_s += STEP_S
    return waited


@pytest.mark.parametrize(
    ("words", "expected_s"),
    [
        (["lost"] * 31, 3.0),
        (["lost"] * 20 + [""] + ["lost"] * 11, 1.0),  # a position found is found
        (["laser-stale"] * 20 + [""] * 15 + ["laser-stale"] * 11, 4.5),  # a scan now and then makes no laser
        (["laser-stale"] * 20 + [""] * 21 + ["laser-stale"] * 11, 1.0),  # well for longer than CLEAR_S
        (["odometry-stale", "no-pose"] * 20 + ["odometry-stale"], 4.0),  # two links that tell of one thing in turns
        (["bumper"] * 10 + ["laser-stale"] * 5 + ["bumper"] * 11, 1.0),
        (["bumper"] * 10 + [""], 0.0),
        ([""], 0.0),
    ],
)
def test_how_long_it_has_been_waited_for_the_last_word(words: list[str], expected_s: float) -> None:
    assert waited_s(words) == pytest.approx(expected_s, abs=1e-9)


def test_while_a_word_flickers_the_robot_counts_as_held() -> None:
    patience = Patience()
    patience.waited_s("laser-stale", 1.0)
    patience.waited_s("", 1.0 + 0.9 * CLEAR_S)
    assert patience.word == "laser-stale"
    patience.waited_s("", 1.0 + 1.1 * CLEAR_S)
    assert patience.word == ""


def test_a_word_that_is_heard_again_after_a_pause_of_the_mission_begins_anew() -> None:
    patience = Patience()
    patience.waited_s("laser-stale", 1.0)
    assert patience.waited_s("laser-stale", 61.0) == 0.0
