"""The three links joined: flags and statuses as they travel, each code by name (DESIGN.md, sections 3 and 9)."""

from __future__ import annotations

import math

import pytest

from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.skills.rectangle import Rectangle
from tests.chain.rig import Disc, Rig
from tests.chain.robots import ATRV2, PIONEER

WALL_AHEAD = [((2.0, -3.0), (2.0, 3.0))]
WALL_BEHIND = [((-2.0, -3.0), (-2.0, 3.0))]


def rig(**kwargs) -> Rig:  # type: ignore[no-untyped-def]
    made = Rig(kwargs.pop("platform", ATRV2), walls=list(kwargs.pop("walls", [])), **kwargs)
    made.run(0.6)
    return made


def command(r: Rig, link: str) -> ActuatorState:
    sample = r.board.newest(f"{link}/command")
    assert sample is not None and isinstance(sample.value, ActuatorState)
    return sample.value


@pytest.mark.parametrize(("flags", "down"), [(2, 1), (12, 11), (22, 1), (32, 11)])
def test_goto_goes_down_as_a_regulator_command_and_arrives(flags: int, down: int) -> None:
    r = rig()
    r.order(flags, (2.0, 1.0), (0.5, 0.0))
    r.run(0.5)
    assert command(r, "drive").flags == down
    assert r.status("motion").element[1] == -1
    assert r.run(15.0, lambda: r.status("motion").element[1] == 1)
    r.run(6.0)
    assert r.status("motion").element == (0, 1, 0, 0), "reached stays, and drive does not time out below it"
    assert math.hypot(r.pose[0] - 2.0, r.pose[1] - 1.0) < 0.3
    assert r.twist == (pytest.approx(0.0, abs=1e-3), pytest.approx(0.0, abs=1e-3))


def test_the_timeout_fires_although_avoidance_slows_and_restores() -> None:
    r = rig(walls=[((1.5, -3.0), (1.5, 3.0))])
    r.order(20, velocity=(0.4, 0.0))
    r.run(3.0)
    assert r.status("motion").element[0] == 6
    r.walls.clear()
    r.run(1.5)
    assert r.status("motion").element[0] == -1


def test_the_timeout_fires_although_the_heading_is_converted_every_cycle() -> None:
    r = rig()
    r.order(1, (0.0, 0.5), (0.2, 0.0))
    for k in range(40):
        r.raw_offset_rad = 0.01 * k
        r.run(0.1)
    r.run(0.3)
    assert r.status("motion").element[0] == -1


def test_a_heading_is_relative_to_the_adjusted_pose() -> None:
    r = rig(raw_offset_rad=1.0)
    r.order(1, (0.0, 0.5), (0.2, 0.0))
    r.run(3.5)
    assert r.pose[2] == pytest.approx(0.5, abs=0.03)


def test_laser_slows_then_stops_before_the_wall_and_goes_on_when_it_is_gone() -> None:
    r = rig(walls=WALL_AHEAD)
    for _ in range(8):
        r.order(20, velocity=(0.9, 0.0))
        r.run(1.0)
    status = r.status("motion")
    assert (status.element[0], status.reason) == (6, "laser")
    assert status.text.startswith("obstacle ")
    assert r.contacts == []
    assert 0.03 < 2.0 - r.pose[0] - 0.585 < 0.25
    r.walls.clear()
    r.order(20, velocity=(0.4, 0.0))
    r.run(2.0)
    assert r.status("motion").element[0] == 0
    assert r.twist[0] == pytest.approx(0.4, abs=0.02)


@pytest.mark.parametrize("flags", [0, 10])
def test_without_the_laser_bit_the_laser_does_not_matter(flags: int) -> None:
    r = rig(laser="fatal")
    r.order(flags, velocity=(0.3, 0.0))
    r.run(1.5)
    assert r.status("motion").element[0] == 0
    assert r.twist[0] == pytest.approx(0.3, abs=0.02)


@pytest.mark.parametrize(("flags", "position"), [(20, (0.0, 0.0)), (21, (0.0, 0.0)), (32, (5.0, 0.0))])
def test_a_fatal_laser_error_stops_and_shows_7_until_it_is_over(flags: int, position: tuple[float, float]) -> None:
    r = rig()
    for _ in range(2):
        r.order(flags, position, (0.4, 0.0))
        r.run(1.0)
    r.laser = "fatal"
    for _ in range(3):
        r.order(flags, position, (0.4, 0.0))
        r.run(1.0)
    assert (r.status("motion").element[0], r.status("motion").reason) == (7, "laser-fatal")
    assert r.twist[0] == pytest.approx(0.0, abs=1e-3)
    r.laser = "well"
    for _ in range(2):
        r.order(flags, position, (0.4, 0.0))
        r.run(1.0)
    assert r.status("motion").element[0] == 0
    assert r.twist[0] > 0.2


@pytest.mark.parametrize("fault", ["off", "nan", "frozen"])
@pytest.mark.parametrize("flags", [20, 32])
def test_a_laser_that_cannot_be_trusted_stops_within_seven_tenths(fault: str, flags: int) -> None:
    r = rig(walls=[((9.0, -3.0), (9.0, 3.0))])
    r.order(flags, (8.0, 0.0), (0.4, 0.0))
    r.run(2.0)
    r.laser = fault
    r.run(1.3 if fault != "off" else 0.7)
    assert command(r, "drive").velocity[0] == 0.0
    assert r.status("motion").reason == "laser-stale"


def test_a_laser_in_an_empty_field_is_not_called_frozen() -> None:
    r = rig()
    r.order(32, (8.0, 0.0), (0.5, 0.0))
    r.run(8.0)
    assert r.pose[0] > 2.5


def test_backing_without_eyes_behind_is_slow() -> None:
    r = rig()
    r.order(20, velocity=(-0.5, 0.0))
    r.run(2.0)
    assert r.twist[0] == pytest.approx(-0.15, abs=0.01)
    r.order(30, velocity=(-0.5, 0.0))
    r.run(2.0)
    assert r.twist[0] == pytest.approx(-0.5, abs=0.02)


def test_turning_on_the_spot_beside_a_remembered_post_stops_before_the_corner_hits_it() -> None:
    r = rig(discs=[Disc(1.4, -0.75, 0.1)], platform=ATRV2)
    r.order(0, velocity=(0.4, 0.0))
    r.run(3.9)
    r.order(20, velocity=(0.0, 0.0))
    r.run(1.5)
    assert r.pose[0] > 1.3, "the post is abeam now, out of the laser's sight"
    for _ in range(4):
        r.order(20, velocity=(0.0, 0.5))
        r.run(1.0)
    assert r.contacts == []
    assert r.status("motion").element[0] == 6
    assert abs(r.pose[2]) < 0.9


@pytest.mark.parametrize(("walls", "velocity", "code"), [(WALL_AHEAD, 0.5, 3), (WALL_BEHIND, -0.5, 4)])
def test_sonar_codes_travel_up(walls: list[tuple[tuple[float, float], tuple[float, float]]], velocity: float, code: int) -> None:
    r = rig(walls=walls)
    for _ in range(6):
        r.order(10, velocity=(velocity, 0.0))
        r.run(1.0)
    assert (r.status("motion").element[0], r.status("motion").reason) == (code, "sonar")
    assert r.contacts == []


def test_codes_of_an_earlier_command_do_not_leak_into_a_new_one() -> None:
    r = rig()
    r.order(0, velocity=(0.3, 0.0))
    r.run(4.5)
    assert r.status("motion").element[0] == -1
    seen = []
    r.order(32, (3.0, 0.0), (0.4, 0.0))
    r.run(1.0, lambda: seen.append(r.status("motion").element[:2]) or False)
    assert set(seen) <= {(0, 0), (0, -1)}
    assert seen[-1] == (0, -1)


def test_a_reached_goal_does_not_leak_into_the_next_goto() -> None:
    r = rig()
    r.order(2, (0.1, 0.0), (0.4, 0.0))
    r.run(1.0)
    assert r.status("motion").element[1] == 1
    r.order(2, (3.0, 0.0), (0.4, 0.0))
    seen = []
    r.run(1.0, lambda: seen.append(r.status("motion").element[1]) or False)
    assert 1 not in seen
    assert seen[-1] == -1


def test_data_are_the_velocities_in_force() -> None:
    r = rig()
    r.order(0, velocity=(0.4, 0.0))
    r.run(0.6)
    assert 0.05 < r.status("motion").data[0] < 0.4
    r.run(1.0)
    assert r.status("motion").data == pytest.approx((0.4, 0.0))


def test_stop_is_zero_at_once_on_every_link_and_beats_a_waiting_command() -> None:
    r = rig()
    r.order(32, (8.0, 0.0), (0.9, 0.0))
    r.run(3.0)
    r.order(32, (9.0, 0.0), (0.9, 0.0))
    r.stop()
    r.run(0.02)
    assert command(r, "drive").velocity == (0.0, 0.0)
    assert r.status("drive").data == (0.0, 0.0)
    r.run(2.0)
    assert r.twist[0] == pytest.approx(0.0, abs=1e-3)
    assert r.status("motion").reason == "stopped"
    assert r.status("motion").element == (0, 0, 0, 0)
    r.order(32, (8.0, 0.0), (0.9, 0.0))
    r.run(1.0)
    assert r.twist[0] > 0.1


def test_release_at_motion_stops_motion_and_avoidance_and_the_lease_holder_drives() -> None:
    r = rig()
    r.order(32, (8.0, 0.0), (0.5, 0.0))
    r.run(2.0)
    assert r.order(0, velocity=(0.2, 0.0), to="drive") == "wrong-state"
    r.order(-1)
    r.run(1.5)
    assert r.status("motion").element[3] == -10
    assert r.status("avoidance").element == (-10, -10)
    assert r.status("drive").element == (0,)
    assert r.twist[0] == pytest.approx(0.0, abs=1e-3)
    assert r.order(10, velocity=(0.2, 0.0), to="drive") == ""
    r.run(1.5)
    assert r.twist[0] == pytest.approx(0.2, abs=0.02)
    r.order(32, (8.0, 0.0), (0.5, 0.0))
    r.run(0.5)
    assert r.status("motion").element[3] == -10, "a stopped link drops commands"


def test_start_makes_a_released_link_run_again_without_its_old_command() -> None:
    r = rig()
    r.order(-1)
    r.run(0.5)
    r.order(32, (8.0, 0.0), (0.5, 0.0))
    for name in ("avoid", "motion"):
        r.running[name] = True
        r.links[name].start(r.now)
        r.links[name].start(r.now)
    r.run(1.0)
    assert r.status("motion").element == (0, 0, 0, 0)
    assert r.twist[0] == pytest.approx(0.0, abs=1e-3)
    r.order(32, (8.0, 0.0), (0.5, 0.0))
    r.run(1.0)
    assert r.status("motion").element[1] == -1


def test_a_stopped_avoidance_shows_through_motion() -> None:
    r = rig()
    r.order(32, (8.0, 0.0), (0.5, 0.0))
    r.run(1.0)
    r.running["avoid"] = False
    r.links["avoid"].stop()
    r.run(1.0)
    assert r.status("motion").element[:2] == (-10, -10)
    assert r.twist[0] == pytest.approx(0.0, abs=1e-3)


def test_a_released_drive_shows_through_all() -> None:
    r = rig()
    r.running["avoid"] = False
    assert r.order(-1, to="drive") == ""
    r.running["avoid"] = True
    r.run(0.5)
    assert r.status("drive").element == (-10,)
    assert r.status("avoidance").element[0] == -10
    assert r.status("motion").element[0] == -10


def test_starting_and_stopping_motion_leaves_avoidance_alone() -> None:
    r = rig()
    r.order(32, (8.0, 0.0), (0.5, 0.0))
    r.run(1.0)
    r.links["motion"].stop()
    r.running["motion"] = False
    r.run(1.0)
    assert r.status("avoidance").element[1] == -1
    assert r.status("motion").element[3] == -10


@pytest.mark.parametrize(
    ("velocity", "rest", "reason"),
    [((4.0, 6.0), -1, ""), ((0.0, 6.0), 0, ""), ((-1.0, 6.0), 0, "bad-command"), ((4.0, 0.0), 0, "bad-command"), ((math.inf, 6.0), 0, "bad-command")],
)
def test_46_sets_the_rectangle_and_b_0_removes_it(velocity: tuple[float, float], rest: int, reason: str) -> None:
    r = rig()
    r.order(46, (1.0, 2.0), velocity, force=0.5)
    r.run(0.3)
    assert r.status("motion").element[3] == rest
    assert r.status("motion").reason == reason


def test_46_keeps_home_and_does_not_move_the_robot() -> None:
    r = rig()
    r.order(46, (1.0, 2.0), (40.0, 60.0), force=0.5)
    r.run(1.0)
    rectangle = r.links["motion"]._skill.rectangle
    assert rectangle == Rectangle(40.0, 60.0, (1.0, 2.0, 0.5))
    assert r.twist == (0.0, 0.0)
    r.order(46, velocity=(0.0, 0.0))
    r.run(0.2)
    assert r.links["motion"]._skill.rectangle is None


def test_the_robots_own_pose_lost_stops_goto_with_a_reason() -> None:
    r = rig(platform=PIONEER)
    r.order(32, (8.0, 0.0), (0.5, 0.0))
    r.run(2.0)
    r._publish.pop("Localization/Pose")
    r._publish["Localization/Pose"] = type("Nobody", (), {"put": lambda self, value, now_s: None})()  # type: ignore[assignment]
    r.run(1.0)
    assert r.status("motion").reason == "no-pose"
    assert command(r, "drive").velocity == (0.0, 0.0)


def test_odometry_lost_stops_the_drive_with_a_reason() -> None:
    r = rig()
    r.order(0, velocity=(0.4, 0.0))
    r.run(1.0)
    r.odometry = "off"
    r.run(0.6)
    assert r.status("drive").reason == "odometry-stale"
    assert r.status("motion").reason == "odometry-stale"
    assert r.status("drive").data == (0.0, 0.0)


@pytest.mark.parametrize("link", ["motion", "avoidance", "drive"])
def test_stepping_early_and_often_changes_nothing(link: str) -> None:
    r = rig()
    r.order(0, velocity=(0.4, 0.0))
    r.run(1.0)
    before = r.status(link)
    name = "avoid" if link == "avoidance" else link
    for _ in range(5):
        r.links[name].step(r.now)
    assert r.status(link).element == before.element
    assert r.status(link).data == pytest.approx(before.data, abs=0.03)
