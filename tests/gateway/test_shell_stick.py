"""Arrow keys as a joystick: from the velocities in force, held as long as the terminal repeats, and what Tab offers."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.gateway.shell.stick import FASTER_MPS, FIRST_HOLD_S, MAX_TURN_RADPS, REPEAT_HOLD_S, TURN_RADPS, Real, Stick

pytest.importorskip("prompt_toolkit")

from prompt_toolkit.completion import CompleteEvent
from prompt_toolkit.document import Document

from pluto_bt.gateway.shell.completer import TableCompleter


def test_a_key_starts_from_the_velocities_in_force() -> None:
    """The manual's own example: the drive has stopped meanwhile, so the next hit is a little more than nothing, not a little more than before."""
    stick = Stick(0.5)
    stick.hit("up", 0.0, Real(0.3, 0.0, 0.0))
    assert stick.velocity(0.1) == (0.3 + FASTER_MPS, 0.0)
    stick.hit("up", 0.2, Real(0.0, 0.0, 0.2))  # an obstacle stopped it
    assert stick.velocity(0.3) == (FASTER_MPS, 0.0)


@pytest.mark.parametrize(
    ("key", "real", "expected"),
    [
        ("up", (0.45, 0.0), (0.5, 0.0)),
        ("down", (-0.45, 0.0), (-0.5, 0.0)),
        ("down", (0.4, 0.3), (0.4 - FASTER_MPS, 0.0)),
        ("left", (0.2, 0.0), (0.2, TURN_RADPS)),
        ("right", (0.2, 0.0), (0.2, -TURN_RADPS)),
        ("left", (0.0, 1.0), (0.0, MAX_TURN_RADPS)),
        ("space", (0.3, 0.3), (0.0, 0.0)),
        ("x", (0.3, 0.3), (0.0, 0.0)),
    ],
)
def test_what_each_key_asks_for(key: str, real: tuple[float, float], expected: tuple[float, float]) -> None:
    stick = Stick(0.5)
    assert stick.hit(key, 0.0, Real(*real, 0.0)) == ""
    assert stick.velocity(0.01) == pytest.approx(expected)


def test_a_key_let_go_is_zero_velocity() -> None:
    stick = Stick(0.5)
    stick.hit("up", 0.0, Real(0.0, 0.0, 0.0))
    assert stick.velocity(FIRST_HOLD_S - 0.01) != (0.0, 0.0), "terminals wait before they repeat a key"
    for i in range(10):
        stick.hit("up", 0.7 + 0.03 * i, Real(0.2, 0.0, 0.7 + 0.03 * i))
    last_s = 0.7 + 0.27
    assert stick.velocity(last_s + REPEAT_HOLD_S - 0.01) != (0.0, 0.0)
    assert stick.velocity(last_s + REPEAT_HOLD_S + 0.01) == (0.0, 0.0)


@pytest.mark.parametrize(("real", "word"), [(None, "no word of the drive"), (Real(0.2, 0.0, 0.0), "1.0 s old")])
def test_without_news_of_the_drive_nothing_moves(real: Real | None, word: str) -> None:
    stick = Stick(0.5)
    assert word in stick.hit("up", 1.0, real)
    assert stick.velocity(1.0) == (0.0, 0.0)


@given(st.lists(st.tuples(st.sampled_from(["up", "down", "left", "right", "q"]), st.floats(0.0, 2.0), st.floats(-2, 2), st.floats(-3, 3))))
def test_limits_and_release_hold_for_any_keys(hits: list[tuple[str, float, float, float]]) -> None:
    stick, now_s = Stick(0.4), 0.0
    for key, pause_s, speed, turn in hits:
        now_s += pause_s
        stick.hit(key, now_s, Real(speed, turn, now_s))
        v, w = stick.velocity(now_s)
        assert abs(v) <= 0.4 and abs(w) <= MAX_TURN_RADPS and not math.isnan(v + w)
    assert stick.velocity(now_s + FIRST_HOLD_S + 0.01) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("got", ["goto"]),
        ("wallfollow r", ["right"]),
        ("get Local", ["Localization/Pose"]),
        ("start s", ["sick"]),
        ("run pat", ["patrol.xml"]),
        ("wrist p", ["point", "pause", "pose", "params"]),
        ("record 1 - Loc", ["Localization/Pose"]),
        ("record 1 - x Loc", ["Localization/Pose"]),
        ("help wr", ["wrist"]),
        ("navigate d", ["dock"]),
        ("do G", ["GoTo"]),
        ("do GoTo goal=1,2 t", ["tolerance_m="]),
        ("goto 3 ", []),
        ("pose ", []),
    ],
)
def test_tab_offers_what_fits(typed: str, offered: list[str]) -> None:
    names = {"topic": ("Localization/Pose", "drive/status"), "module": ("sick", "wrist"), "mission": ("patrol.xml",),
             "goal": ("dock", "home"), "node": ("GoTo",), "port GoTo": ("goal=", "tolerance_m=")}
    completer = TableCompleter(lambda: {kind: dict.fromkeys(of_kind, "") for kind, of_kind in names.items()})
    found = [completion.text for completion in completer.get_completions(Document(typed), CompleteEvent())]
    assert sorted(found) == sorted(offered)


def test_tab_offers_the_rows_of_the_sub_shell_that_is_open() -> None:
    completer = TableCompleter(dict)
    completer.shell = "wrist"
    offered = [completion.text for completion in completer.get_completions(Document(""), CompleteEvent())]
    assert offered[:4] == ["state", "start", "point", "home"], "its own commands come first"
    assert len(offered) == len(set(offered))
