"""The stasis detector of the jBot article, stuck wheels, and the tilt from the vertical."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimation.stasis import Stasis, StuckWheels, tilt_rad

DT_S = 0.05
TURNS, RESTS = 0.011, 0.004  # rad in 50 ms: above ARE_TURNING = .010, below NOT_TURNING = .005


def article(steps: list[tuple[float, float]]) -> list[bool]:
    """The C code of the article, line by line, but for the alarm, which stays."""
    err, alarm, alarms = 0, False, []
    for wheel, imu in steps:
        if abs(imu) < 0.005 and abs(wheel) > 0.010:
            err += 1
        elif err:
            err -= 1
        if err > 60:
            alarm, err = True, 0
        alarms.append(alarm)
    return alarms


def test_the_alarm_comes_with_the_61st_step_after_3_05_seconds() -> None:
    stasis = Stasis()
    for n in range(1, 62):
        assert not stasis.alarm
        stasis.step(DT_S, TURNS, RESTS)
        assert stasis.count == n % 61
    assert stasis.alarm


def test_a_good_step_takes_one_off_and_the_alarm_stays_until_it_is_read() -> None:
    stasis = Stasis()
    for _ in range(60):
        stasis.step(DT_S, TURNS, RESTS)
    for _ in range(10):
        stasis.step(DT_S, 0.0, 0.0)
    assert stasis.count == 50
    for _ in range(11):
        stasis.step(DT_S, -TURNS, -RESTS)
    assert stasis.alarm
    for _ in range(200):
        stasis.step(DT_S, 0.0, 0.0)
    assert stasis.alarm, "good steps do not take it back"
    assert stasis.read() and not stasis.alarm and not stasis.read()


CASES = [
    # what                                   wheels  body    counts
    ("both turn",                            0.05,   0.05,   False),
    ("both rest",                            0.0,    0.0,    False),
    ("the body is pushed round",             0.0,    0.05,   False),
    ("wheels turn, the body does not",       0.05,   0.0,    True),
    ("to the right as well",                 -0.05,  0.0049, True),
    ("wheels on the limit",                  0.01,   0.0,    False),
    ("body on the limit",                    0.05,   0.0051, False),
    ("a yaw that wraps has hardly turned",   0.05,   math.tau - 0.001, True),
]  # fmt: skip


@pytest.mark.parametrize(("what", "wheels", "body", "counts"), CASES, ids=[case[0] for case in CASES])
def test_what_counts(what: str, wheels: float, body: float, counts: bool) -> None:
    stasis = Stasis()
    stasis.step(DT_S, wheels, body)
    assert stasis.count == counts


@given(st.lists(st.tuples(st.sampled_from([0.0, TURNS, -TURNS]), st.sampled_from([0.0, RESTS, TURNS])), max_size=300))
def test_it_agrees_with_the_article(steps: list[tuple[float, float]]) -> None:
    stasis, alarms = Stasis(), []
    for wheel, imu in steps:
        stasis.step(DT_S, wheel, imu)
        alarms.append(stasis.alarm)
    assert alarms == article(steps)


def look(stuck: StuckWheels, from_s: float, count: int, commanded: tuple[float, float], measured: tuple[float, float] = (0.0, 0.0)) -> float:
    """`count` looks, 0.1 s apart; the time of the next one."""
    for i in range(count):
        stuck.step(from_s + 0.1 * i, commanded, measured)
    return from_s + 0.1 * count


@pytest.mark.parametrize("commanded", [(0.3, 0.0), (0.0, -0.5)])
def test_wheels_are_stuck_after_a_second_of_commands(commanded: tuple[float, float]) -> None:
    stuck = StuckWheels(1.0)
    now_s = look(stuck, 0.0, 10, commanded)
    assert not stuck.alarm
    now_s = look(stuck, now_s, 1, commanded, (0.05, 0.0))  # they moved: it begins anew
    now_s = look(stuck, now_s, 9, commanded)
    assert not stuck.alarm
    now_s = look(stuck, now_s, 1, commanded)
    assert stuck.alarm
    look(stuck, now_s, 5, (0.0, 0.0))
    assert stuck.read() and not stuck.alarm


def test_rests_between_the_tries_count_neither_way_but_a_long_one_begins_anew() -> None:
    stuck, now_s = StuckWheels(1.0), 0.0
    for _ in range(2):
        now_s = look(stuck, now_s, 4, (0.3, 0.0))
        now_s = look(stuck, now_s, 10, (0.0, 0.0))
        assert not stuck.alarm
    now_s = look(stuck, now_s, 4, (0.3, 0.0))
    assert stuck.read()
    now_s = look(stuck, now_s, 9, (0.3, 0.0))
    now_s = look(stuck, now_s, 32, (0.0, 0.0))
    look(stuck, now_s, 8, (0.3, 0.0))
    assert not stuck.alarm


def test_standing_without_a_command_or_with_a_tiny_one_is_no_sign() -> None:
    stuck = StuckWheels(1.0)
    for i in range(50):
        stuck.step(0.1 * i, (0.01, 0.0), (0.0, 0.0))
    assert not stuck.alarm


@pytest.mark.parametrize(("pitch_deg", "roll_deg", "tilt_deg"), [(0, 0, 0), (50, 0, 50), (0, -50, 50), (-30, 0, 30), (40, 40, 54.07), (180, 0, 180)])
def test_tilt_is_the_angle_from_the_vertical_in_any_direction(pitch_deg: float, roll_deg: float, tilt_deg: float) -> None:
    assert math.degrees(tilt_rad(math.radians(pitch_deg), math.radians(roll_deg))) == pytest.approx(tilt_deg, abs=0.01)
