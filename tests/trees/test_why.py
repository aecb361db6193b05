"""The chain of causes of situations that are made by hand."""

from __future__ import annotations

from pluto_bt.record.entries import Situation
from pluto_bt.record.trail import Trail
from pluto_bt.trees.why import View, explain

PAUSED = ("paused", "estop")


def view(**now: object) -> View:
    trail = Trail()
    trail.take(Situation(mission=PAUSED, **now), 4_000_000_000)  # type: ignore[arg-type]
    return View(5.0, trail, mission="patrol", paused="estop")


def test_a_latched_emergency_stop_is_the_operators() -> None:
    first = explain(view(hold=("estop", "Anna pressed it"))).first
    assert first is not None and (first.layer, first.code, first.text) == ("operator", "estop", "Anna pressed it")
    assert "release" in first.unblock


def test_a_released_one_only_left_a_mission_paused() -> None:
    answer = explain(view())
    assert [(cause.layer, cause.code) for cause in answer.causes] == [("mission", "estop")]
    assert "released since" in answer.causes[0].text and "release" not in answer.causes[0].unblock and "resume" in answer.causes[0].unblock


def test_who_is_driven_by_hand_is_not_kept_by_a_paused_mission() -> None:
    answer = explain(view(moves=True))
    assert answer.is_moving and [cause.text for cause in answer.causes] == ["mission patrol paused"]
    assert "release" not in answer.causes[0].unblock
