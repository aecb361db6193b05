"""Gyro, wheels and laser as witnesses: a robot drives through a room, and one of the three lies."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from estimation.motion_check import Limits, MotionCheck
from estimation.news import FOUND, GYRO_DRIFT, GYRO_REFUSED, LOST, WHEEL_SLIP, WHEELS_GRIP
from estimation.se2 import Pose2, arc, compose
from pluto_bt.maps.scene import Scene
from pluto_bt.maps.world import Shape, World

ANGLES = np.linspace(-math.pi / 2, math.pi / 2, 361)
ROOM = World("room", shapes=(
    Shape("walls", "wall", np.array([(-9.0, -5.0), (12.0, -5.0), (12.0, 8.0), (-9.0, 8.0), (-9.0, -5.0)])),
    Shape("crate", "polygon", np.array([(3.0, 2.0), (4.0, 2.2), (3.8, 3.0), (3.0, 3.0)])),
    Shape("post", "circle", np.array([[-3.0, 4.0]]), 0.2),
))  # fmt: skip
DT_S, SCAN_EVERY, LATE = 0.02, 10, 10  # steps
ARM: Pose2 = (0.4, 0.0, 0.0)
Wheels = Callable[[float, float], tuple[float, float]]  # (t s, the way they run) → (way the robot comes, way they count)
Gyro = Callable[[float, float], float]  # (t s, the true turn of a step) → the turn it tells


class Drive:
    """A robot at 0.5 m/s with gentle turns; its wheels turn by 10 % too much, as skidding ones do."""

    def __init__(
        self, wheels: Wheels = lambda t, way: (way, way), gyro: Gyro = lambda t, turn: turn, has_laser: bool = True, asks_wheels: bool = True
    ) -> None:
        self.check = MotionCheck(Limits(0.9, 0.8, 80.0), asks_wheels, has_gyro=True, judges_turns=True)
        self.true: Pose2 = (-6.0, 0.0, 0.0)
        self.believed = self.true
        self.words: list[str] = []
        self._wheels, self._gyro, self._has_laser = wheels, gyro, has_laser
        self._scene, self._rng = Scene(ROOM), np.random.default_rng(3)
        self._k = 0
        self._scans: list[tuple[int, float, np.ndarray]] = []
        self.pan: Callable[[float], float] = lambda t: 0.0
        self.near: list[tuple[float, float, float]] = []  # who stands there: x m, y m, radius m

    def run(self, seconds: float, speed: float = 0.5) -> Drive:
        for _ in range(round(seconds / DT_S)):
            self._k += 1
            t = self._k * DT_S
            way, turn = speed * DT_S, 0.25 * math.sin(0.5 * t) * DT_S * (speed > 0)
            true_way, counted = self._wheels(t, way)
            self.true = compose(self.true, arc(true_way, turn))
            step = self.check.step(t, DT_S, counted, 1.1 * turn, self._gyro(t, turn), True)
            self.believed = compose(self.believed, arc(*step))
            self._scan(t)
            self.words += [news.word for news in self.check.news]
            self.check.news.clear()
        return self

    def _scan(self, t: float) -> None:
        pan = self.pan(t)
        if self._k % SCAN_EVERY == 0 and self._has_laser and math.isfinite(pan):
            ranges = np.zeros(361)
            self._scene.scan(compose(self.true, (*ARM[:2], pan)), 0.6, 0.0, ANGLES, 80.0, ranges)
            ranges = np.minimum(ranges, self._people(compose(self.true, (*ARM[:2], pan))))
            self._scans.append((self._k, pan, np.round(ranges + 0.01 * self._rng.normal(size=361), 2)))
        if self._scans and self._scans[0][0] + LATE <= self._k:
            k, pan, ranges = self._scans.pop(0)
            self.check.look(k * DT_S, ranges, float(ANGLES[0]), float(ANGLES[1] - ANGLES[0]), (*ARM[:2], pan))

    def _people(self, laser: Pose2) -> np.ndarray:
        """How far the beams come before they meet one of those who stand near."""
        x, y, theta = laser
        free = np.full(len(ANGLES), np.inf)
        for px, py, radius in self.near:
            ahead = (px - x) * np.cos(theta + ANGLES) + (py - y) * np.sin(theta + ANGLES)
            aside = (py - y) * np.cos(theta + ANGLES) - (px - x) * np.sin(theta + ANGLES)
            meets = (ahead > 0.0) & (np.abs(aside) < radius)
            free[meets] = np.minimum(free[meets], ahead[meets] - np.sqrt(radius**2 - aside[meets] ** 2))
        return free

    @property
    def error_m(self) -> float:
        return math.dist(self.true[:2], self.believed[:2])

    @property
    def error_rad(self) -> float:
        return abs(math.remainder(self.true[2] - self.believed[2], math.tau))


def test_three_honest_witnesses_are_left_alone() -> None:
    drive = Drive().run(20.0)
    assert drive.words == [] and drive.error_m < 1e-6


def test_wheels_that_count_a_little_too_much_are_trimmed_without_a_word() -> None:
    """1.5 % of 12 m would be 0.18 m; in a room the laser sees the way to a millimetre or two a metre."""
    drive = Drive(wheels=lambda t, way: (way, 1.015 * way)).run(24.0)
    assert drive.words == [] and drive.error_m < 0.04


def test_a_gyro_that_creeps_is_trimmed_without_a_word() -> None:
    """0.02 deg/s for 60 s would be 1.2 deg."""
    creep = math.radians(0.02) * DT_S
    drive = Drive(gyro=lambda t, turn: turn + creep).run(60.0, speed=0.2)
    assert drive.words == [] and drive.error_rad < math.radians(0.4)


@pytest.mark.parametrize("jump", [0.3, -0.3, 0.05, -0.02, 1.0])
def test_a_gyro_whose_bias_jumps_is_found_out_and_its_turn_taken_back(jump: float) -> None:
    def gyro(t: float, turn: float) -> float:
        return turn + (jump * DT_S if t > 4.0 else 0.0)

    drive = Drive(gyro=gyro).run(22.0)
    assert set(drive.words) <= {GYRO_DRIFT, GYRO_REFUSED} and drive.words
    assert drive.error_rad < 0.08 and drive.error_m < 0.5
    alone = Drive(gyro=gyro, has_laser=False, asks_wheels=False).run(22.0)
    assert alone.error_rad > 2 * drive.error_rad, "what would become of it without witnesses"


@pytest.mark.parametrize("slip", [0.25, 0.6, 1.0])
def test_wheels_that_slip_are_believed_as_far_as_they_grip(slip: float) -> None:
    def wheels(t: float, way: float) -> tuple[float, float]:
        return (way * (1.0 - slip) if 4.0 < t < 10.0 else way), way

    drive = Drive(wheels=wheels).run(10.0)
    assert drive.words == [WHEEL_SLIP]
    assert drive.check.way.grip == pytest.approx(1.0 - slip, abs=0.1)
    assert drive.run(6.0).words == [WHEEL_SLIP, WHEELS_GRIP]
    assert drive.error_m < 0.25


def test_a_robot_that_is_pushed_while_it_stands_knows_it() -> None:
    drive = Drive(wheels=lambda t, way: (0.3 * DT_S if 2.0 < t < 3.0 else 0.0, 0.0)).run(8.0, speed=0.0)
    assert set(drive.words) == {WHEEL_SLIP} and drive.error_m < 0.1


@pytest.mark.parametrize("to", [(-5.0, 0.9, 0.0), (6.0, 4.0, 2.0)], ids=["a little aside", "to another corner"])
def test_a_robot_that_is_carried_is_lost_until_somebody_finds_it(to: Pose2) -> None:
    drive = Drive().run(3.0)
    drive.true = to
    drive.run(1.0)
    assert drive.words == [LOST] and drive.check.lost
    drive.check.found()
    drive.believed = drive.true
    assert drive.run(3.0).words == [LOST] and not drive.check.lost and drive.error_m < 0.05


@pytest.mark.parametrize("to", [(10.7, 1.0, 0.4), (-7.8, 0.0, 2.9), (-8.2, -3.5, -1.9), (11.0, -4.0, -0.8), (10.9, 5.0, 1.9)])
def test_a_robot_that_is_set_down_close_to_a_wall_is_lost_though_people_might_stand_so_near(to: Pose2) -> None:
    drive = Drive().run(3.0)
    drive.true = to
    assert drive.run(2.0, speed=0.0).words == [LOST]


def test_a_robot_round_which_people_come_to_stand_is_not_lost_and_neither_when_they_have_gone() -> None:
    drive = Drive().run(3.0)
    drive.near = [(x, y, 0.25) for x, y in ((-3.7, -0.9), (-3.3, -0.4), (-3.3, 0.3), (-3.6, 0.9), (-4.4, 1.0), (-4.3, -1.0))]
    assert drive.run(4.0, speed=0.0).words == []
    drive.near = []
    assert drive.run(4.0).words == [] and drive.error_m < 1e-6


def left_and_right(t: float) -> float:
    """A wrist that looks to the left, to the right and ahead, a second each, and is on its way (NaN) for a second between."""
    return (0.95, math.nan, -0.95, math.nan, 0.0, math.nan)[int(t) % 6]


@pytest.mark.parametrize("speed", [0.0, 0.4], ids=["standing", "driving"])
@pytest.mark.parametrize("after_s", [k * 0.5 for k in range(12)])
def test_who_is_carried_while_the_laser_looks_left_and_right_is_lost_whenever_that_happens(after_s: float, speed: float) -> None:
    drive = Drive()
    drive.pan = left_and_right
    assert drive.run(6.1 + after_s, speed=speed).words == []
    drive.true = (6.0, 4.0, 2.0)
    assert drive.run(6.0, speed=0.0).words == [LOST]


@pytest.mark.parametrize(("hidden_s", "words"), [(0.2, []), (2.0, [LOST, FOUND])], ids=["for one scan", "for a while"])
def test_a_robot_that_sees_the_place_before_again_is_not_lost(hidden_s: float, words: list[str]) -> None:
    """As when people stand round it: the scan looks like another place, and then like the old one."""
    drive = Drive().run(3.0)
    here = drive.true
    drive.true = (6.0, 4.0, 2.0)
    drive.run(hidden_s, speed=0.0)
    drive.true = here
    drive.run(2.0, speed=0.0)
    assert drive.words == words and not drive.check.lost
    assert drive.run(4.0).words == words and drive.error_m < 0.1


def test_without_a_laser_the_gyro_is_judged_by_wheels_that_run_straight() -> None:
    def gyro(t: float, turn: float) -> float:
        return turn + (0.3 * DT_S if t > 10.0 else 0.0)

    drive = Drive(gyro=gyro, has_laser=False)
    drive.run(18.0)
    assert drive.words[:1] == [GYRO_DRIFT]
    assert drive.error_rad < 1.0 < 0.3 * 8.0


def test_a_car_whose_gyro_talks_nonsense_does_not_know_where_it_points() -> None:
    drive = Drive(gyro=lambda t, turn: 1e5, has_laser=False, asks_wheels=False).run(0.1)
    assert drive.words == [GYRO_REFUSED, LOST]


@pytest.mark.parametrize("blind_s", [1.0, 20.0])
def test_a_robot_that_is_carried_while_its_laser_is_blind_is_lost_when_it_sees_again(blind_s: float) -> None:
    drive = Drive().run(3.0)
    drive._has_laser = False
    drive.run(blind_s, speed=0.0)
    drive.true = compose(drive.true, (0.0, 1.0, 0.5))
    drive._has_laser = True
    assert drive.run(3.0).words == [LOST]


def test_a_gyro_that_lied_in_a_long_blind_moment_is_put_right_after_it() -> None:
    drive = Drive(gyro=lambda t, turn: turn + (0.2 * DT_S if 3.0 < t < 4.0 else 0.0)).run(3.0)
    drive._has_laser = False
    drive.run(30.0, speed=0.0)
    drive._has_laser = True
    drive.run(3.0)
    assert drive.error_rad < 0.03 and abs(drive.check.turn.drift_radps) < 0.003
