"""Where the wrist holds the laser, by what it said and by what it may have done since."""

from __future__ import annotations

import pytest

from pluto_bt.blackboard import TOPICS, Blackboard
from pluto_bt.blackboard.messages import ActuatorState, Pair
from pluto_bt.modules.wrist_angles import wrist_at

LAST_S, PERIOD_S = 4.0, 0.05


def board_of(turn_radps: float, sent: tuple[float, Pair] | None) -> Blackboard:
    """A wrist that spoke till `LAST_S`, panned as fast, and was sent somewhere (when, where)."""
    board = Blackboard(TOPICS)
    state, command = (board.publisher(name, board.topic(name).writer) for name in ("wrist/state", "wrist/command"))
    for k in range(round(LAST_S / PERIOD_S) + 1):
        t_s = k * PERIOD_S
        state.put(ActuatorState(t_s, 0, (turn_radps * t_s, 0.0), (turn_radps, 0.0)), t_s)
    if sent is not None:
        command.put(ActuatorState(sent[0], 0, sent[1]), sent[0])
    return board


@pytest.mark.parametrize(
    ("turn_radps", "sent", "stamp_s", "expected"),
    [
        (0.2, None, 3.5, (0.7, 0.0)),
        (0.2, None, LAST_S + 0.05, (0.8, 0.0)),
        (0.2, None, LAST_S + 0.5, None),
        (0.2, None, 1.0, None),
        (0.0, None, LAST_S + 60.0, (0.0, 0.0)),
        (0.0, (1.0, (0.0, 0.0)), LAST_S + 60.0, (0.0, 0.0)),
        (0.0, (1.0, (0.5, 0.0)), LAST_S + 60.0, None),
        (0.0, (LAST_S + 1.0, (0.0, 0.0)), LAST_S + 60.0, None),
    ],
    ids=["heard", "soon", "silent in a sweep", "before the history", "silent at rest", "where it was sent", "not where it was sent", "sent since"],
)
def test_where_the_wrist_is(turn_radps: float, sent: tuple[float, Pair] | None, stamp_s: float, expected: Pair | None) -> None:
    found = wrist_at(board_of(turn_radps, sent), stamp_s)
    assert found == (None if expected is None else pytest.approx(expected))


def test_nobody_knows_where_a_wrist_is_that_never_spoke() -> None:
    assert wrist_at(Blackboard(TOPICS), 1.0) is None
