"""The drive link, by the sentences of the manual (6.1) and the rows of DESIGN.md, section 9."""

from __future__ import annotations

import math

import pytest

from pluto_bt.blackboard.messages import ActuatorState, BumperState, SonarState
from pluto_bt.skills.drive import Drive, DriveParameters, DriveSenses
from pluto_bt.skills.limits import STILL, Twist
from tests.chain.robots import ATRV2, CAR

CLEAR = (8.0,) * 12
FRONT, BACK, LEFT = (4, 8), (1, 2), (0, 7)  # transducers of the ring


class Bench:
    """A drive whose senses are set by hand; the wheels follow at once."""

    def __init__(self, platform=ATRV2) -> None:  # type: ignore[no-untyped-def]
        self.drive = Drive(platform, DriveParameters())
        self.now = 0.0
        self.ranges = CLEAR
        self.front = self.back = False
        self.raw_age = self.sonar_age = self.bumper_age = 0.0
        self.heading = self.distance = 0.0

    def bumper(self) -> BumperState | None:
        return None if math.isinf(self.bumper_age) else BumperState(self.now - self.bumper_age, self.front, self.back)

    def order(self, flags: int, velocity: Twist = STILL, heading: float = 0.0) -> None:
        self.drive.accept(ActuatorState(self.now, flags, (0.0, heading), velocity), self.now)

    def run(self, seconds: float) -> Twist:
        twist = STILL
        for _ in range(round(seconds / 0.05)):
            raw = ActuatorState(self.now - self.raw_age, 0, (self.distance, self.heading))
            senses = DriveSenses(raw, SonarState(self.now - self.sonar_age, self.ranges), self.bumper())
            twist = self.drive.step(self.now, senses)
            self.now += 0.05
            self.distance += twist[0] * 0.05
            self.heading += twist[1] * 0.05
        return twist

    @property
    def code(self) -> int:
        return self.drive.status(self.now).element[0]

    @property
    def reason(self) -> str:
        return self.drive.status(self.now).reason

    def echo(self, range_m: float, *transducers: int) -> None:
        self.ranges = tuple(range_m if i in transducers else 8.0 for i in range(12))


def test_velocity_is_reached_with_the_platforms_acceleration() -> None:
    bench = Bench()
    bench.order(0, (0.4, 0.0))
    bench.run(0.05)
    assert bench.run(0.5)[0] == pytest.approx(0.2)
    assert bench.run(1.0) == (0.4, 0.0)
    assert (bench.code, bench.reason) == (0, "")


def test_velocity_is_cut_to_the_platforms_limits_and_the_status_says_what_is_in_force() -> None:
    bench = Bench()
    bench.order(0, (9.0, -9.0))
    twist = bench.run(3.5)
    assert twist == (0.9, -math.radians(45.8))
    assert bench.drive.status(bench.now).data == twist


def test_regulator_turns_to_the_angle_and_drives_at_the_speed() -> None:
    bench = Bench()
    bench.order(1, (0.5, 0.0), heading=1.0)
    bench.run(3.8)
    assert bench.heading == pytest.approx(1.0, abs=0.02)
    assert bench.drive.twist[0] == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("flags", [-2, 2, 3, 9, 12, 20, 21, 31, 42, 100])
def test_other_flags_are_refused_with_zero_velocity(flags: int) -> None:
    bench = Bench()
    bench.order(0, (0.5, 0.0))
    bench.run(2.0)
    bench.order(flags, (0.5, 0.0))
    assert bench.run(0.05) == STILL
    assert (bench.code, bench.reason) == (0, "bad-command")


@pytest.mark.parametrize("velocity", [(math.nan, 0.0), (0.1, math.inf)])
def test_a_number_that_is_none_is_refused(velocity: Twist) -> None:
    bench = Bench()
    bench.order(0, velocity)
    assert bench.run(0.1) == STILL
    assert bench.reason == "bad-command"


def test_without_a_new_command_it_stops_controlled_after_four_seconds() -> None:
    bench = Bench()
    bench.order(0, (0.5, 0.0))
    bench.run(3.95)
    assert bench.code == 0
    twist = bench.run(0.15)
    assert bench.code == -1
    assert 0.3 < twist[0] < 0.5, "a controlled stop, not a jerk"
    assert bench.run(1.0) == STILL
    assert bench.reason == "command-timeout"


def test_a_new_command_ends_the_timeout_and_an_amended_one_does_not_put_it_off() -> None:
    bench = Bench()
    bench.order(0, (0.5, 0.0))
    for _ in range(5):
        bench.run(1.0)
        bench.drive.accept(ActuatorState(0.0, 0, (0.0, 0.0), (0.4, 0.0)), bench.now, amends=True)
    bench.run(0.05)
    assert bench.code == -1
    bench.order(0, (0.5, 0.0))
    bench.run(0.05)
    assert bench.code == 0


@pytest.mark.parametrize(
    ("panel", "velocity", "left", "code"),
    [
        ("front", (0.3, 0.0), STILL, 1),
        ("front", (0.0, 0.3), STILL, 1),
        ("front", (-0.3, 0.3), (-0.3, 0.0), 1),
        ("back", (-0.3, 0.0), STILL, 2),
        ("back", (0.0, 0.3), STILL, 2),
        ("back", (0.3, 0.3), (0.3, 0.0), 2),
    ],
)
def test_a_pressed_bumper_leaves_only_the_way_off(panel: str, velocity: Twist, left: Twist, code: int) -> None:
    bench = Bench()
    setattr(bench, panel, True)
    bench.run(0.1)
    bench.order(0, velocity)
    assert bench.run(1.0) == left
    assert (bench.code, bench.reason) == (code, "bumper")


def test_a_bumper_stops_at_once_without_a_ramp() -> None:
    bench = Bench()
    bench.order(0, (0.9, 0.2))
    bench.run(3.0)
    bench.front = True
    assert bench.run(0.05) == STILL


def test_a_bumper_clears_on_release_plus_a_new_command() -> None:
    bench = Bench()
    bench.order(0, (0.3, 0.0))
    bench.front = True
    bench.run(0.5)
    bench.front = False
    assert bench.run(0.5) == STILL, "release alone moves nothing"
    assert bench.code == 1
    bench.order(0, (0.3, 0.0))
    assert bench.run(1.0) == (0.3, 0.0)
    assert bench.code == 0


def test_a_new_command_alone_does_not_clear_a_pressed_bumper() -> None:
    bench = Bench()
    bench.front = True
    bench.run(0.1)
    bench.order(0, (0.3, 0.0))
    assert bench.run(0.5) == STILL


@pytest.mark.parametrize(
    ("name", "transducers", "velocity", "code"),
    [
        ("front stops forward", FRONT, (0.5, 0.0), 3),
        ("back stops backward", BACK, (-0.5, 0.0), 4),
        ("a side stops turning", LEFT, (0.0, 0.5), 5),
    ],
)
def test_sonar_protection_stops_and_says_where(name: str, transducers: tuple[int, ...], velocity: Twist, code: int) -> None:
    bench = Bench()
    bench.echo(0.05, *transducers)
    bench.order(10, velocity)
    assert bench.run(1.0) == STILL
    assert (bench.code, bench.reason) == (code, "sonar")


@pytest.mark.parametrize(
    ("name", "transducers", "velocity"),
    [("behind while going ahead", BACK, (0.5, 0.0)), ("ahead while backing", FRONT, (-0.5, 0.0)), ("beside while going ahead", LEFT, (0.5, 0.0))],
)
def test_sonar_looks_only_where_the_robot_goes(name: str, transducers: tuple[int, ...], velocity: Twist) -> None:
    bench = Bench()
    bench.echo(0.3, *transducers)
    bench.order(10, velocity)
    assert bench.run(2.0) == velocity
    assert bench.code == 0


def test_without_the_ten_the_sonar_does_not_matter() -> None:
    bench = Bench()
    bench.echo(0.05, *FRONT)
    bench.order(0, (0.5, 0.0))
    assert bench.run(2.0) == (0.5, 0.0)


def test_it_slows_before_it_stops_and_stands_before_the_obstacle() -> None:
    bench = Bench()
    bench.order(10, (0.9, 0.0))
    wall_m, speeds = 5.0, []
    while bench.now < 3.9 + 4.0:
        if abs(bench.now - round(bench.now)) < 0.01:
            bench.order(10, (0.9, 0.0))
        bench.echo(max(0.15, wall_m - bench.distance - 0.58), *FRONT)
        speeds.append(bench.run(0.05)[0])
    assert max(speeds) == 0.9
    assert any(0.1 < v < 0.6 for v in speeds[40:])
    assert speeds[-1] == 0.0
    assert bench.code == 3
    assert 0.0 < wall_m - bench.distance - 0.585 < 0.25


def test_a_sonar_that_is_deaf_from_nearness_counts_as_touching() -> None:
    bench = Bench()
    bench.echo(0.15, *FRONT)
    bench.order(10, (0.5, 0.0))
    assert bench.run(1.0) == STILL


@pytest.mark.parametrize("ranges", [(math.nan,) * 12, (8.0,) * 11, ()])
def test_a_sonar_that_makes_no_sense_stops_when_asked_for(ranges: tuple[float, ...]) -> None:
    bench = Bench()
    bench.ranges = ranges
    bench.order(10, (0.5, 0.0))
    assert bench.run(1.0) == STILL
    assert bench.reason == "sonar-stale"


def test_old_echoes_stop_when_asked_for() -> None:
    bench = Bench()
    bench.sonar_age = 0.6
    bench.order(10, (0.5, 0.0))
    assert bench.run(1.0) == STILL
    assert bench.reason == "sonar-stale"


@pytest.mark.parametrize(("age_s", "word"), [(0.45, ""), (0.55, "bumper-stale"), (math.inf, "bumper-stale")])
def test_bumpers_that_are_silent_stop_whatever_is_asked_for(age_s: float, word: str) -> None:
    bench = Bench()
    bench.bumper_age = age_s
    bench.order(0, (0.2, 0.0))
    assert bench.run(1.0) == (STILL if word else (0.2, 0.0))
    assert (bench.code, bench.reason) == (0, word)


def test_a_robot_without_bumpers_misses_none() -> None:
    bench = Bench(CAR)
    bench.bumper_age = math.inf
    bench.order(0, (0.2, 0.0))
    assert bench.run(1.0) == (0.2, 0.0)


def test_old_odometry_stops_at_once_and_fresh_odometry_goes_on() -> None:
    bench = Bench()
    bench.order(0, (0.5, 0.0))
    bench.run(2.0)
    bench.raw_age = 0.4
    assert bench.run(0.05) == STILL
    assert bench.reason == "odometry-stale"
    bench.raw_age = 0.0
    assert bench.run(1.0)[0] > 0.3


def test_stop_is_at_once_and_nothing_times_out_after_it() -> None:
    bench = Bench()
    bench.order(0, (0.9, 0.3))
    bench.run(2.0)
    bench.drive.stop(ActuatorState(bench.now))
    assert bench.run(0.05) == STILL
    bench.run(5.0)
    assert (bench.code, bench.reason) == (0, "stopped")


def test_the_car_drives_curves_and_its_limits_hold() -> None:
    bench = Bench(CAR)
    bench.order(0, (0.5, 0.25))
    twist = bench.run(2.0)
    assert twist == (0.5, 0.25)
    bench.order(0, (0.5, 5.0))
    v, w = bench.run(1.0)
    assert w / v == pytest.approx(1.0 / (0.83 * 0.9))


def test_a_text_is_written_once_when_a_state_begins() -> None:
    bench = Bench()
    bench.echo(0.5, *FRONT)
    bench.order(10, (0.9, 0.0))
    bench.run(0.1)
    first = bench.drive.status(0.0).text
    assert first.startswith("echo 0.4")
    bench.echo(0.3, *FRONT)
    bench.run(0.1)
    assert bench.drive.status(0.0).text is first
