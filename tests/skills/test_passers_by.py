"""Who will walk on is awaited; whom the robot itself ran into is not."""

from __future__ import annotations

import pytest

from pluto_bt.blackboard.messages import ActuatorState, BumperState, FVectorState
from pluto_bt.skills.passers_by import AWAITS_S, PassersBy

STANDS, DRIVES = ActuatorState(0.0), ActuatorState(0.0, velocity=(0.3, 0.0))
OPEN, PRESSED = BumperState(0.0), BumperState(0.0, front=True)


@pytest.mark.parametrize(
    ("reason", "wheels", "bumper", "is_somebody"),
    [
        ("walker", DRIVES, OPEN, True),
        ("laser", DRIVES, OPEN, False),
        ("", STANDS, PRESSED, True),
        ("", DRIVES, PRESSED, False),
        ("", STANDS, OPEN, False),
    ],
    ids=["the filter holds for him", "a wall holds it", "he walks into a robot that stands", "the robot drives into something", "nothing"],
)
def test_signs_of_somebody(reason: str, wheels: ActuatorState, bumper: BumperState, is_somebody: bool) -> None:
    about = PassersBy()
    for k in range(10):
        about.note(0.1 * k, FVectorState(0.0), wheels, OPEN)
    about.note(1.0, FVectorState(1.0, reason=reason), wheels, bumper)
    assert about.are_awaited(1.0) is is_somebody
    assert about.are_awaited(1.0 + AWAITS_S - 0.01) is is_somebody
    assert not about.are_awaited(1.0 + AWAITS_S)


def test_a_bumper_that_stays_pressed_is_one_sign_and_the_robot_does_not_wait_for_ever() -> None:
    about = PassersBy()
    for k in range(200):
        about.note(0.1 * k, None, STANDS, PRESSED if k >= 10 else OPEN)
    assert not about.are_awaited(1.0 + AWAITS_S)


def test_nothing_known_is_nobody() -> None:
    about = PassersBy()
    about.note(0.0, None, None, None)
    assert not about.are_awaited(0.0)
