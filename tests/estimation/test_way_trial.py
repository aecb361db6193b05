"""Wheels against laser: how far they grip, how sure that is, and what is doubted meanwhile."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimation.news import WHEEL_SLIP, WHEELS_GRIP, News
from estimation.reckoning import Motion
from estimation.way_trial import Seen, WayTrial

STEP_M, STEP_S = 0.1, 0.2  # of the wheels' way from scan to scan


def motion(wheels_m: float, time_s: float = 1.0) -> Motion:
    return Motion(10.0, (wheels_m, 0.0, 0.0), time_s, wheels_m, 0.0, 0.0, time_s)


def seen(off_m: float, sigma_m: float = 0.003, gain: float = 0.3, aside_m: float = 0.0) -> Seen:
    return Seen(off_m, sigma_m, aside_m, gain)


class Drive:
    """Wheels that grip so far, and a laser that sees the way."""

    def __init__(self, wheels_m: float = 1.0) -> None:
        self.news: list[News] = []
        self.trial = WayTrial(self.news)
        self.wheels_m = wheels_m
        self.added_m2 = 0.0

    def goes(self, steps: int, grip: float, sigma_m: float = 0.003, is_seen: bool = True) -> Drive:
        unseen_m = 0.0
        for _ in range(steps):
            way_m, added_m2 = self.trial.reckoned(STEP_S, STEP_M)
            self.wheels_m, self.added_m2 = self.wheels_m + STEP_M, self.added_m2 + added_m2
            unseen_m += grip * STEP_M - way_m
            if is_seen:
                farther = self.trial.weigh(seen(unseen_m, sigma_m), motion(STEP_M), self.wheels_m)
                unseen_m -= farther.way_m if farther is not None else 0.0
        return self

    @property
    def words(self) -> list[str]:
        return [news.word for news in self.news]


@settings(max_examples=40, deadline=None)
@given(st.floats(0.0, 0.85), st.floats(0.001, 0.006))
def test_the_grip_is_found_and_followed_until_it_is_whole_again(grip: float, sigma_m: float) -> None:
    drive = Drive()
    found = drive.trial.weigh(seen(grip - 1.0), motion(1.0), drive.wheels_m)
    assert found is not None and found.way_m == grip - 1.0 and found.share == pytest.approx(grip - 1.0)
    assert drive.goes(10, grip, sigma_m).trial.grip == pytest.approx(grip, abs=0.03)
    assert drive.words == [WHEEL_SLIP]
    assert drive.goes(20, 1.0, sigma_m).trial.grip == 1.0
    assert drive.words == [WHEEL_SLIP, WHEELS_GRIP]


def test_a_laser_that_hardly_sees_the_way_teaches_slowly_and_noise_does_not_mislead() -> None:
    drive = Drive()
    drive.trial.weigh(seen(-0.5), motion(1.0), drive.wheels_m)
    drive.goes(6, 0.5)
    for off_m in (0.03, -0.03) * 10:  # a standard deviation of 3 cm, in steps of 10 cm: 0.3 of grip each
        drive.trial.reckoned(STEP_S, STEP_M)
        drive.wheels_m += STEP_M
        drive.trial.weigh(seen(off_m, 0.03), motion(STEP_M), drive.wheels_m)
    assert drive.trial.grip == pytest.approx(0.5, abs=0.12)


def test_a_turn_on_the_spot_says_nothing_of_the_grip() -> None:
    drive = Drive()
    drive.trial.weigh(seen(-0.5), motion(1.0), drive.wheels_m)
    drive.goes(6, 0.5)
    grip, owed_m = drive.trial.grip, drive.trial.debt.owed
    for off_m in (0.01, -0.012, 0.014) * 10:
        drive.trial.reckoned(STEP_S, 0.0)
        drive.trial.weigh(seen(off_m), motion(0.0), drive.wheels_m)
    assert drive.trial.grip == grip and drive.trial.debt.owed == owed_m


def test_what_nobody_sees_of_a_slipping_way_is_doubted_until_a_scan_tells_or_for_good() -> None:
    drive = Drive()
    drive.trial.weigh(seen(-0.5), motion(1.0), drive.wheels_m)
    drive.goes(6, 0.5).trial.debt.pay(10.0)
    assert drive.trial.doubt_m < 0.03
    drive.goes(10, 0.5, is_seen=False)
    doubt_m = drive.trial.doubt_m
    assert 0.1 < doubt_m < 0.4, "a metre of way, with a grip that may wander"
    told = Drive()
    told.trial.weigh(seen(-0.5), motion(1.0), told.wheels_m)
    told.goes(6, 0.5).goes(10, 0.5, is_seen=False).goes(1, 0.5).trial.debt.pay(10.0)
    assert told.trial.doubt_m < 0.05 and told.goes(3, 0.5).added_m2 == 0.0
    drive.trial.give_up(is_lost=True)
    assert drive.trial.doubt_m == 0.0 and drive.goes(1, 0.5).added_m2 == pytest.approx(doubt_m**2)


@pytest.mark.parametrize(
    ("comparison", "is_suspect", "doubt_m"),
    [
        (seen(-0.05), False, 0.0),  # so much says nothing
        (seen(-0.2), True, 0.2),
        (seen(-0.2, gain=0.01), False, 0.0),  # the scan fits as well where the wheels are
        (seen(-0.2, gain=0.04), False, 0.2),  # a little worse: it may be somebody who walks beside the robot
        (seen(-0.2, sigma_m=0.05), False, 0.0),
        (seen(-0.04, sigma_m=0.02, aside_m=0.06), False, 0.8),  # a bare wall aslant: it may have come any part of the way
        (seen(-0.04, sigma_m=0.02, aside_m=0.01), False, 0.0),
    ],
)
def test_who_slips_has_to_be_seen_clearly_and_what_is_seen_less_clearly_is_doubted(comparison: Seen, is_suspect: bool, doubt_m: float) -> None:
    trial = WayTrial([])
    assert trial.is_suspect(comparison, motion(0.8)) is is_suspect
    assert trial.doubt_m == pytest.approx(doubt_m)
    trial.give_up(is_lost=False)
    assert trial.doubt_m == 0.0 and trial.reckoned(STEP_S, STEP_M) == (STEP_M, pytest.approx(doubt_m**2))


def test_a_robot_that_is_pushed_while_its_wheels_stand_is_put_right_and_its_wheels_are_believed() -> None:
    drive = Drive()
    farther = drive.trial.weigh(seen(0.15), motion(0.0), drive.wheels_m)
    assert farther is not None and farther.way_m == 0.15 and not drive.trial.is_slipping and drive.words == [WHEEL_SLIP]


def test_a_robot_that_is_pushed_while_its_wheels_slip_is_put_right_too() -> None:
    drive = Drive()
    drive.trial.weigh(seen(-0.5), motion(1.0), drive.wheels_m)
    drive.goes(6, 0.5)
    farther = drive.trial.weigh(seen(0.3), motion(0.0), drive.wheels_m)
    assert farther is not None and farther.way_m == 0.3
