"""Can the laser be trusted, and do the encoders follow? Tables of what is noticed, and of what must not be taken for a fault."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from pluto_bt.blackboard.messages import ActuatorState, LaserScan, read_only
from pluto_bt.maps.platform import Laser
from pluto_bt.skills.limits import Limits
from pluto_bt.skills.scan_watch import ScanWatch
from pluto_bt.skills.verdict import ALL_WELL
from pluto_bt.skills.wheel_watch import WheelWatch

LASER = Laser(x_m=0.0, rate_hz=5.0, arrival_delay_s=0.19)
RANGES = 3.0 + np.sin(np.arange(361) / 30.0)
N_HALF = 180
Array = np.ndarray


def scan(stamp_s: float, ranges: Array) -> LaserScan:
    return LaserScan(stamp_s, -math.pi / 2, math.pi / 360, read_only(ranges), len(ranges))


def noisy(k: int) -> Array:
    return RANGES + 0.01 * np.random.default_rng(k).normal(size=361)


def beams(value: float, first: int, last: int) -> Callable[[int], Array]:
    def ranges(k: int) -> Array:
        out = noisy(k)
        out[first : last + 1] = value
        return out

    return ranges


def half_stuck(k: int) -> Array:
    return np.concatenate((noisy(0)[:N_HALF], noisy(k)[N_HALF:]))


@pytest.mark.parametrize(
    ("name", "ranges", "moves", "word"),
    [
        ("all is well", noisy, True, ""),
        ("equal scans while it stands", lambda k: noisy(0), False, ""),
        ("equal scans while it moves", lambda k: noisy(0), True, "laser-stale"),
        ("half of the scan is equal while it moves", half_stuck, True, "laser-stale"),
        ("an empty field always looks the same", lambda k: np.full(361, 80.0), True, ""),
        ("no numbers", beams(math.nan, 0, 360), True, "laser-stale"),
        ("no numbers in half the beams", beams(math.nan, 0, 180), True, "laser-stale"),
        ("zeros in a third of the beams", beams(0.0, 100, 220), True, "laser-stale"),
        ("a few holes", beams(math.nan, 10, 60), True, ""),
        ("fatal", lambda k: np.full(361, -1.0), True, "laser-fatal"),
        ("no beams at all", lambda k: np.zeros(0), True, "laser-stale"),
    ],
)
def test_what_a_scan_is_blamed_for(name: str, ranges: Callable[[int], Array], moves: bool, word: str) -> None:
    watch = ScanWatch(LASER, 0.0, 0.25)
    for k in range(4):
        watch.look(scan(0.2 * k, ranges(k)), (0.1 * k if moves else 0.0, 0.0, 0.0))
    assert watch.verdict(0.6 + 0.2).reason == word


def test_a_scan_is_too_old_after_its_way_and_a_period_and_a_quarter() -> None:
    watch = ScanWatch(LASER, 0.0, 0.25)
    assert watch.verdict(0.0).reason == "laser-stale", "there is none yet"
    watch.look(scan(1.0, noisy(0)), (0.0, 0.0, 0.0))
    assert watch.verdict(1.43) == ALL_WELL
    assert watch.verdict(1.45).reason == "laser-stale"


def test_after_a_gap_two_scans_in_time_are_asked_for_so_that_a_slow_laser_does_not_make_it_jerk() -> None:
    watch = ScanWatch(LASER, 0.0, 0.25)
    for k in range(8):  # two a second
        watch.look(scan(0.5 * k, noisy(k)), (0.0, 0.0, 0.0))
        assert k == 0 or watch.verdict(0.5 * k + 0.2).reason == "laser-stale"
        watch.verdict(0.5 * k + 0.49)
    for k in range(2):
        watch.look(scan(4.0 + 0.2 * k, noisy(8 + k)), (0.0, 0.0, 0.0))
        assert (watch.verdict(4.2 + 0.2 * k) == ALL_WELL) == (k == 1)


LIMITS = Limits(1.0, 1.0, 0.5, 1.0, 1.0)


def words(told: Callable[[float], tuple[float, float]], counted: Callable[[float], tuple[float, float]], seconds: float = 3.0) -> list[str]:
    watch = WheelWatch(LIMITS, 0.3, 1.0)
    return [watch.step(ActuatorState(t, 0, counted(t)), told(t), t).reason for t in np.arange(0.0, seconds, 0.05).tolist()]


@pytest.mark.parametrize(
    ("name", "told", "counted", "is_noticed"),
    [
        ("it follows", lambda t: (0.4, 0.2), lambda t: (0.4 * t, 0.2 * t), False),
        ("it stands and is told to", lambda t: (0.0, 0.0), lambda t: (1.0, 1.0), False),
        ("the encoders stand", lambda t: (0.4, 0.0), lambda t: (1.0, 1.0), True),
        ("the encoders stand, slowly driven", lambda t: (0.05, 0.0), lambda t: (1.0, 1.0), True),
        ("backwards too", lambda t: (-0.4, 0.0), lambda t: (1.0, 1.0), True),
        ("turning only", lambda t: (0.0, 0.5), lambda t: (1.0, 1.0), True),
        ("the way is counted, the turn is not", lambda t: (0.4, 0.5), lambda t: (0.4 * t, 0.0), True),
        ("half of the way is lost", lambda t: (0.4, 0.0), lambda t: (0.2 * t, 0.0), False),
        ("a turn that begins suddenly and late", lambda t: (0.4, -0.005 if t < 2.0 else -0.4), lambda t: (0.4 * t, -0.4 * max(0.0, t - 2.12)), False),
        ("to and fro", lambda t: (0.4 * (1 if int(t) % 2 else -1), 0.0), lambda t: (0.1 * math.sin(3.0 * t), 0.0), False),
    ],
)
def test_what_wheels_are_blamed_for(name: str, told: Callable[..., tuple[float, float]], counted: Callable[..., tuple[float, float]],
                                    is_noticed: bool) -> None:  # fmt: skip
    assert ("odometry-frozen" in words(told, counted)) == is_noticed


def test_wheels_are_not_blamed_for_readings_that_come_once_a_second() -> None:
    watch, seldom = WheelWatch(LIMITS, 0.3, 1.0), [float(int(0.05 * k)) for k in range(100)]
    said = [watch.step(ActuatorState(t, 0, (0.4 * t, 0.0)), (0.4, 0.0), 0.05 * k).reason for k, t in enumerate(seldom)]
    assert "odometry-frozen" not in said


def test_stuck_encoders_are_noticed_in_half_a_second_and_tried_again_after_a_second() -> None:
    said = words(lambda t: (0.4, 0.0), lambda t: (0.4 * min(t, 1.0), 0.0), 4.0)
    first = said.index("odometry-frozen") * 0.05
    assert 1.3 <= first <= 1.45
    assert said[round((first + 0.5) / 0.05)] == "odometry-frozen"
    assert said[round((first + 1.1) / 0.05)] == ""
