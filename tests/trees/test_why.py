"""The chain of causes of situations that are made by hand."""

from __future__ import annotations

import pytest

from pluto_bt.record.entries import Link, Situation
from pluto_bt.record.trail import Trail
from pluto_bt.trees.why import View, explain, innermost

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


def test_who_ended_the_mission_is_an_operator_whatever_the_links_say() -> None:
    trail = Trail()
    stopped = Link((0, 0), "stopped", "stop was commanded")
    trail.take(Situation(mission=("aborted", "stopped"), links={"drive": stopped, "avoidance": stopped}), 4_000_000_000)
    first = explain(View(5.0, trail, mission="patrol")).first
    assert first is not None and (first.layer, first.code, first.since_s) == ("operator", "stopped", 4.0)
    assert "resume" not in first.unblock


@pytest.mark.parametrize(
    ("rows", "wanted"),
    [
        ("0R 1R 2R 2I 1I", [2]),  # the leaf, not those above it
        ("0R 1R 2I 3I 1I", [1]),  # a decorator that waits itself
        ("0R 1R 2R 1I 1R 2I", [2, 4]),  # two branches of a Parallel
        ("0S 1I", []),
        ("0R", [0]),
    ],
)
def test_at_work_is_who_runs_while_nothing_below_him_does(rows: str, wanted: list[int]) -> None:
    assert innermost([(int(row[0]), row[1] == "R") for row in rows.split()]) == wanted
