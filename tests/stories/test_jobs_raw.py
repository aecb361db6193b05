"""Stories of raw commands: 42 to 46 posted to motion as the gateway posts them, while a mission only waits."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from pluto_bt.blackboard.messages import LocalMapState
from tests.raw_robot import RawRobot

STREET = """<world name="lane" seed="1">
  <wall id="lane">0,0 30,0 30,8 0,8 0,0</wall> {more}
  <robot platform="atrv2" x="3" y="4" theta_deg="0"/>
</world>"""


@pytest.fixture
def robot(tmp_path: Path) -> Any:
    return lambda more="", seed=1: RawRobot(tmp_path, STREET.format(more=more), seed)


def test_moveto_shows_scanning_following_near_and_at_goal(robot: Any) -> None:
    r = robot()
    r.order(42, (14.0, 4.0))
    assert r.run(60.0, r.is_at_rest)
    assert r.codes[:1] == [(-1, 1)] or r.codes[1:2] == [(-1, 1)]
    shown = r.codes[r.codes.index((-1, 1)) :]
    assert shown == [(-1, 1), (-1, 3), (-2, 3), (1, 0)]
    r.run(6.0)
    assert r.status.element == (0, 1, 1, 0), "reached stays until the next command, and nothing times out below it"
    assert math.dist(r.pose[:2], (14.0, 4.0)) < 0.5
    r.order(0)
    r.run(0.3)
    assert r.status.element[2:] == (0, 0)


@pytest.mark.parametrize("flags", [10, 32])
def test_a_stopped_moveto_shows_minus_one_and_goes_on_with_45(robot: Any, flags: int) -> None:
    r = robot()
    r.order(42, (20.0, 4.0))
    r.run(15.0)
    assert r.status.element[2:] == (-1, 3)
    r.order(flags, r.pose[:2])
    r.run(3.0)
    assert r.status.element[2:] == (-1, 0)
    standing = r.pose
    r.run(3.0)
    assert math.dist(standing[:2], r.pose[:2]) < 0.02
    r.order(45)
    r.run(1.0)
    assert r.status.element[2:] == (-1, 1)
    assert r.run(90.0, r.is_at_rest)
    assert r.status.element[2:] == (1, 0)
    assert math.dist(r.pose[:2], (20.0, 4.0)) < 0.6


def test_an_operators_stop_ends_a_job_at_once_and_keeps_it(robot: Any) -> None:
    r = robot()
    r.order(42, (20.0, 4.0))
    r.run(15.0)
    r.system.stop_robot("operator")
    r.run(0.2)
    assert (r.status.reason, r.status.element[2:]) == ("stopped", (-1, 0))
    r.run(2.0)
    assert r.system.simulator.velocity[0] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(
    ("orders", "reason"),
    [
        ([(45, (0, 0), (0, 0))], "nothing-to-resume"),
        ([(46, (2.5, 4.0), (3.0, 10.0)), (42, (20.0, 4.0), (0, 0))], "outside-rectangle"),
        ([(46, (10.0, 4.0), (3.0, 10.0)), (42, (12.0, 4.0), (0, 0))], "outside-rectangle"),
        ([(46, (10.0, 4.0), (3.0, 10.0)), (43, (0, 0), (0, 0))], "outside-rectangle"),
        ([(44, (0, 0), (-1.0, 5.0))], "bad-command"),
        ([(44, (0, 0), (2.0, math.inf))], "bad-command"),
        ([(42, (math.nan, 1.0), (0, 0))], "bad-command"),
        ([(43, (0, 0), (2.0, 1.0))], "no-object"),
    ],
)
def test_what_cannot_be_done_is_told_with_its_reason_and_nothing_moves(robot: Any, orders: Any, reason: str) -> None:
    r = robot()
    for flags, position, velocity in orders:
        r.order(flags, position, velocity)
        r.run(0.3)
    r.run(30.0, lambda: r.is_at_rest() and r.status.reason != "")
    assert (r.status.reason, r.status.element[2]) == (reason, 0)
    assert r.is_at_rest()
    assert math.dist(r.pose[:2], (3.0, 4.0)) < 0.02


def test_a_goal_behind_walls_fails_with_no_path(robot: Any) -> None:
    r = robot('<wall id="shut">10,0 10,8</wall>')
    r.order(42, (20.0, 4.0))
    assert r.run(200.0, r.is_at_rest)
    assert (r.status.reason, r.status.element[2:]) == ("no-path", (0, 0))


def test_46_sets_and_removes_the_rectangle(robot: Any) -> None:
    r = robot()
    r.order(46, (2.5, 4.0), (3.0, 20.0))
    r.run(0.3)
    assert r.status.element[2:] == (0, -1)
    r.order(46, (0.0, 0.0), (0.0, 5.0))
    r.run(0.3)
    assert r.status.element[2:] == (0, 0)


def test_minus_one_stops_motion_with_its_job(robot: Any) -> None:
    r = robot()
    r.order(42, (20.0, 4.0))
    r.run(10.0)
    r.order(-1)
    r.run(3.0)
    assert r.status.element[3] == -10
    assert r.system.simulator.velocity[0] == pytest.approx(0.0, abs=1e-3)
    assert r.system.executive.core.job.is_over


def test_explore_covers_its_rectangle_and_comes_home(robot: Any) -> None:
    r = robot('<circle id="tree" x="9" y="3" r="0.4"/>')
    home = r.pose
    r.order(44, velocity=(3.5, 18.0))
    r.run(1.0)
    assert r.status.element[2:] == (0, 1)
    assert r.run(300.0, r.is_at_rest)
    assert r.status.element[2:] == (1, -1), r.status.text
    kinds = [code for code in r.codes if code[0] in (-1, -2, 1)]
    assert kinds[0] == (-1, 1) and (-2, 3) in kinds, "the home-coming is a moveto"
    assert math.dist(r.pose[:2], home[:2]) < 0.6
    assert r.deepest > -0.01
    shown = r.system.board.newest("map/local").value
    assert isinstance(shown, LocalMapState) and shown.covered_m2 > 0.9 * 7.0 * 18.0 * 0.95


def test_45_with_nothing_stopped_explores_the_rectangle_of_46(robot: Any) -> None:
    r = robot()
    r.order(46, (2.8, 4.0), (3.0, 8.0))
    r.run(0.3)
    r.order(45)
    assert r.run(200.0, r.is_at_rest)
    assert r.status.element[2:] == (1, -1)
    assert math.dist(r.pose[:2], (2.8, 4.0)) < 0.6


def test_investigate_approaches_and_circles(robot: Any) -> None:
    r = robot('<circle id="bin" x="12" y="4" r="0.4"/>')
    r.order(43, velocity=(2.0, 1.0))
    away: list[float] = []
    assert r.run(200.0, lambda: away.append(math.dist(r.pose[:2], (12.0, 4.0))) or r.is_at_rest() if r.status.element[3] != 11 else False)
    assert r.status.element[2:] == (2, 0), r.status.text
    assert [code for code in r.codes if code[1] in (11, 12)] == [(0, 11), (0, 12)]
    assert max(abs(distance - 2.0) for distance in away) < 0.2
    assert r.system.board.newest("arm/state").value.position[0] == 1.0
    assert -1 not in {code[0] for code in r.links}, "43 refreshes itself, also while the arm is unfolded"


def test_45_while_a_job_is_at_work_changes_nothing(robot: Any) -> None:
    r = robot()
    r.order(42, (20.0, 4.0))
    r.run(12.0)
    r.order(45)
    r.run(3.0)
    assert r.codes == [(-1, 3)]
    assert r.velocity[0] > 0.3


def test_46_in_the_middle_of_a_moveto_only_sets_and_the_moveto_goes_on(robot: Any) -> None:
    r = robot()
    r.order(42, (14.0, 4.0))
    r.run(9.0)
    r.order(46, (2.5, 4.0), (3.0, 25.0))
    assert r.run(60.0, r.is_at_rest)
    assert r.codes == [(-1, 1), (-1, 3), (-2, 3), (1, -1)]
    assert math.dist(r.pose[:2], (14.0, 4.0)) < 0.5


@pytest.mark.parametrize(("home", "sides", "reason"), [((2.5, 4.0), (3.0, 6.0), "outside-rectangle"), ((2.5, 4.0), (-3.0, 6.0), "bad-command")])
def test_46_that_shuts_the_goal_out_or_makes_no_sense_ends_the_moveto(robot: Any, home: Any, sides: Any, reason: str) -> None:
    r = robot()
    r.order(42, (14.0, 4.0))
    r.run(9.0)
    r.order(46, home, sides)
    r.run(2.0)
    assert r.status.reason == reason
    assert r.is_at_rest()
    assert r.velocity[0] == pytest.approx(0.0, abs=1e-3)


def test_a_rectangle_is_seen_set_at_rest_between_stop_and_resume(robot: Any) -> None:
    """The manual: check element[3] == -1, but send a stop to the robot first, then a resume after."""
    r = robot()
    r.order(42, (14.0, 4.0))
    r.run(9.0)
    r.order(0)
    r.run(1.0)
    assert r.status.element[2:] == (-1, 0)
    r.order(46, (2.5, 4.0), (3.0, 25.0))
    r.run(0.3)
    assert r.status.element[2:] == (-1, -1)
    r.order(45)
    assert r.run(60.0, r.is_at_rest)
    assert r.codes == [(-1, 1), (-1, 3), (-2, 3), (1, -1)]


def test_a_stopped_explore_goes_on_where_it_was_and_home_to_the_home_of_46(robot: Any) -> None:
    r = robot()
    r.order(44, velocity=(3.5, 14.0))
    assert r.run(30.0, lambda: r.pose[0] > 7.0)
    r.order(0)
    r.run(1.0)
    assert r.status.element[2:] == (0, -1), "-1 is for a moveto point that is set, and there is none yet"
    covered_m2 = r.system.board.newest("map/local").value.covered_m2
    r.order(46, (4.0, 4.0), (3.5, 13.0))
    r.run(0.3)
    r.order(45)
    r.run(2.0)
    assert r.status.element[2:] == (0, 1)
    assert r.system.board.newest("map/local").value.covered_m2 > 0.7 * covered_m2, "coverage is kept"
    assert r.run(200.0, lambda: r.status.element[2] == -2)
    r.order(0)
    r.run(1.0)
    assert r.status.element[2:] == (-1, -1), "stopped on the way home"
    r.order(45)
    assert r.run(200.0, r.is_at_rest)
    assert r.status.element[2:] == (1, -1), r.status.text
    assert math.dist(r.pose[:2], (4.0, 4.0)) < 0.6


def test_44_starts_anew_with_home_where_the_robot_is(robot: Any) -> None:
    r = robot()
    r.order(44, velocity=(3.5, 20.0))
    assert r.run(40.0, lambda: r.pose[0] > 6.0)
    r.order(0)
    r.run(1.5)
    home = r.pose
    r.order(44, velocity=(3.5, 9.0))
    assert r.run(200.0, r.is_at_rest)
    assert r.status.element[2:] == (1, -1)
    assert math.dist(r.pose[:2], home[:2]) < 0.6


@pytest.mark.parametrize("theta", [0.0, 2.0])
def test_an_explore_from_the_middle_of_its_rectangle_looks_behind_the_robot_too(robot: Any, theta: float) -> None:
    r = robot()
    back = (9.0 - 6.0 * math.cos(theta), 4.0 - 2.0 * math.sin(theta))
    r.order(32, (9.0, 4.0), (0.5, 0.0))
    assert r.run(40.0, lambda: r.status.element[1] == 1)
    r.order(46, (2.0, 4.0), (3.5, 16.0)) if theta == 0.0 else r.order(46, back, (3.0, 7.0), (theta,))
    r.run(0.3)
    r.order(45)
    assert r.run(300.0, r.is_at_rest), "it ends"
    assert r.status.element[2:] == (1, -1), r.status.text


def test_a_stopped_investigate_is_taken_up_again(robot: Any) -> None:
    r = robot('<circle id="bin" x="12" y="4" r="0.4"/>')
    r.order(43, velocity=(2.0, 1.0))
    assert r.run(60.0, lambda: r.pose[0] > 5.0)
    r.order(0)
    r.run(1.0)
    assert r.status.element[2:] == (0, 0)
    r.order(45)
    assert r.run(200.0, r.is_at_rest)
    assert r.status.element[2:] == (2, 0), r.status.text
    assert [code for code in r.codes if code[1] in (11, 12)] == [(0, 11), (0, 12)]


def test_a_job_waits_while_the_laser_reboots_and_goes_on(robot: Any) -> None:
    r = robot('<script><at t="12"><fault device="laser" kind="fatal"/></at></script>')
    r.order(42, (14.0, 4.0))
    r.run(16.0)
    assert (r.status.element[0], r.status.element[2:]) == (7, (-1, 3))
    assert r.run(90.0, r.is_at_rest)
    assert r.status.element[2:] == (1, 0), r.status.text


def test_a_job_that_was_driven_away_from_its_ray_finds_a_new_one(robot: Any) -> None:
    r = robot()
    r.order(42, (20.0, 4.0))
    r.run(15.0)
    r.order(32, (3.0, 2.0), (0.5, 0.0))
    assert r.run(40.0, lambda: r.status.element[1] == 1)
    assert r.status.element[2:] == (-1, 0)
    r.order(45)
    assert r.run(120.0, r.is_at_rest)
    assert r.status.element[2:] == (1, 0)
