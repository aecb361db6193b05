"""What is kept of requests that act once: enough to answer a repeated one, and no more than is allowed."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.gateway.outcomes import OUTCOME_BYTES, Outcomes
from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.replies import Ok, Progress
from pluto_bt.gateway.requests import Run

ANNA = ("", "anna")


def run(id: str = "1", **ports: str) -> Run:
    return Run(id=id, node="GoTo", ports=ports)


def test_the_same_request_finds_its_outcome_and_another_is_told_so() -> None:
    outcomes = Outcomes()
    outcomes.begin(ANNA, run(a="1", b="2")).add(Ok(id="1"))
    found = outcomes.find(ANNA, run(b="2", a="1"))
    assert found is not None and found.direct == Ok(id="1"), "the order of ports means nothing"
    assert outcomes.find(("", "bert"), run()) is None
    with pytest.raises(RefusedError, match="for another request"):
        outcomes.find(ANNA, run(a="1", b="3"))


def test_a_connection_without_a_session_leaves_nothing() -> None:
    outcomes = Outcomes()
    outcomes.begin(7, run())
    outcomes.begin(ANNA, run(id=""))
    assert outcomes.size_bytes == 0


def test_a_great_request_is_not_kept() -> None:
    outcomes = Outcomes()
    outcomes.begin(ANNA, run(text="x" * 60_000))
    assert outcomes.size_bytes == OUTCOME_BYTES


@settings(max_examples=50)
@given(st.lists(st.tuples(st.sampled_from("abc"), st.sampled_from("1234"), st.integers(0, 3000), st.booleans()), max_size=40))
def test_all_together_stay_within_their_bytes(steps: list[tuple[str, str, int, bool]]) -> None:
    """The newest is always found; what is counted is what is kept; an outcome that was forgotten may still grow, and nobody counts it."""
    most_bytes = 8 * OUTCOME_BYTES
    outcomes, begun = Outcomes(sessions=2, outcomes=3, most_bytes=most_bytes), list[tuple[tuple[str, str], Run]]()
    old = []
    for session, id, length, is_forgotten in steps:
        key, request = ("", session), run(id, n=str(len(begun)))
        outcome = outcomes.begin(key, request)
        assert outcomes.find(key, request) is outcome
        assert outcomes.size_bytes <= max(most_bytes, outcome.size_bytes)
        begun.append((key, request))
        old.append(outcome)
        for one in old:
            one.add(Progress(run="r", state="running", text="x" * length))
        if is_forgotten:
            outcomes.forget(key, request)
    for key, request in begun:
        outcomes.forget(key, request)
    assert outcomes.size_bytes == 0
