"""Whose request is answered next: each client's in order, all clients in turn."""

from __future__ import annotations

from pluto_bt.gateway.requests import Get, Lease, Request
from pluto_bt.gateway.turns import Turns
from pluto_bt.gateway.wire import Ask, Gone, Up, Watch


def order(*frames: Up) -> list[str]:
    turns = Turns()
    for number, frame in enumerate(frames):
        turns.add((frame, number))
    assert len(turns) <= len(frames)
    return [shown(turns.next()[0]) for _ in range(len(turns))]


def shown(frame: Up) -> str:
    if isinstance(frame, Ask):
        return f"{frame.client}{frame.request.id}"
    return f"gone {frame.client}" if isinstance(frame, Gone) else "watch"


def ask(client: int, id: str, session: str = "", kind: type[Request] = Get) -> Ask:
    return Ask(client, session, "", kind(topic="tree", id=id) if kind is Get else Lease(op="renew", id=id))  # type: ignore[arg-type,call-arg]


def test_who_asks_for_much_waits_behind_himself() -> None:
    assert order(ask(1, "a"), ask(1, "b"), ask(1, "c"), ask(2, "x"), Watch(("tree",)), ask(2, "y")) == ["1a", "2x", "watch", "1b", "2y", "1c"]


def test_the_connections_of_one_session_keep_their_order() -> None:
    assert order(ask(1, "a", "s"), ask(1, "b", "s"), ask(2, "c", "s"), ask(3, "x")) == ["1a", "3x", "1b", "2c"]


def test_nobody_answers_the_questions_of_who_is_gone() -> None:
    frames = ask(1, "a", "s"), ask(1, "b", "s", Lease), ask(2, "c", "s"), Gone(1), Gone(7)
    assert order(*frames) == ["1b", "gone 7", "2c", "gone 1"]
    assert order(ask(1, "a"), Gone(1), ask(2, "x")) == ["gone 1", "2x"]


def test_a_line_that_is_held_waits_until_it_is_free() -> None:
    turns = Turns()
    for frame in (ask(1, "a"), ask(1, "b"), ask(2, "x")):
        turns.add((frame, 0))
    assert shown(turns.next()[0]) == "1a"
    hold = turns.hold(ask(1, "a"))
    turns.add((ask(1, "c"), 0))
    turns.add((Gone(1), 0))
    assert [shown(turns.next()[0]), turns.is_ready, len(turns)] == ["2x", False, 1], "his questions are forgotten with him"
    turns.free(hold)
    turns.free(hold)
    assert [shown(turns.next()[0]), turns.is_ready] == ["gone 1", False]


def test_they_can_all_be_sent_home() -> None:
    turns = Turns()
    turns.add((ask(1, "a"), 0))
    turns.clear()
    assert len(turns) == 0


def test_who_names_a_session_in_the_middle_does_not_overtake_himself() -> None:
    frames = ask(1, "a", kind=Lease), ask(1, "b", kind=Lease), ask(1, "c", "s", Lease), ask(2, "x", "s"), Gone(1), ask(2, "y", "s")
    found = order(*frames)
    assert [one for one in found if "1" in one] == ["1a", "1b", "1c", "gone 1"] and [one for one in found if "2" in one] == ["2x", "2y"]


def test_a_hold_is_ended_by_its_own_work_alone() -> None:
    turns = Turns()
    turns.add((ask(1, "a", "s"), 0))
    turns.next()
    old = turns.hold(ask(1, "a", "s"))
    turns.clear()
    assert not turns.is_wanted(old, ask(1, "a", "s"))
    turns.add((ask(9, "b", "s"), 0))
    turns.next()
    new = turns.hold(ask(9, "b", "s"))
    turns.add((ask(9, "c", "s"), 0))
    turns.free(old)
    assert not turns.is_ready and turns.is_wanted(new, ask(9, "b", "s"))
    turns.free(new)
    assert shown(turns.next()[0]) == "9c"
