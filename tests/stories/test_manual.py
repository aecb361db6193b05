"""The command chain by the words of the Pluto manual (4, 6.1 to 6.3; DESIGN.md, sections 3 and 9), on the whole simulated robot: every flag at
every link, every status code, who may post where, and what starts and stops a thread."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from pluto_bt.blackboard.messages import ActuatorState
from tests.raw_robot import RawRobot

FIELD = """<world name="field" seed="1">
  <wall id="fence">-60,-60 60,-60 60,60 -60,60 -60,-60</wall> {parts}
  <robot platform="{platform}" x="0" y="0" theta_deg="{theta_deg}"/> <script>{script}</script>
</world>"""
Make = Callable[..., RawRobot]


@pytest.fixture
def robot(tmp_path: Path) -> Make:
    """A robot in a field of 120 m."""

    def make(parts: str = "", script: str = "", theta_deg: float = 0.0, platform: str = "atrv2") -> RawRobot:
        return RawRobot(tmp_path, FIELD.format(parts=parts, script=script, theta_deg=theta_deg, platform=platform))

    return make


# ------------------------------------------------------------------ every flag at every link

PASSED = [10 * a + t for a in range(4) for t in range(3)]
TAKES = {"motion": PASSED, "avoid": PASSED, "drive": [0, 1, 10, 11]}
REFUSES = {
    "motion": [4, 5, 6, 7, 8, 9, 14, 29, 34, 39, 40, 41, 47, 48, 49, 50, 100, 10**9, -2, -10, -(10**9)],
    "avoid": [4, 9, 14, 39, 40, 41, 42, 43, 44, 45, 46, 47, 50, 10**9, -2, -10],
    "drive": [2, 3, 4, 9, 12, 13, 20, 21, 22, 30, 31, 32, 40, 42, 44, 45, 46, 50, 10**9, -2, -10],
}
TOPIC = {"motion": "motion/command", "avoid": "avoidance/command", "drive": "drive/command"}


@pytest.fixture(scope="module", params=["motion", "avoid", "drive"])
def link_and_robot(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, RawRobot]]:
    """A robot whose links above `link` are stopped, so that commands may go to it directly."""
    r = RawRobot(tmp_path_factory.mktemp("flags"), FIELD.format(parts="", script="", theta_deg=20.0, platform="atrv2"))
    for above in {"motion": (), "avoid": ("motion",), "drive": ("motion", "avoid")}[request.param]:
        r.module(above, False)
    yield request.param, r


def accepted(r: RawRobot, link: str) -> ActuatorState:
    sample = r.system.board.newest(TOPIC[link])
    assert sample is not None and isinstance(sample.value, ActuatorState)
    return sample.value


def heading_for(r: RawRobot, link: str) -> float:
    """Where the robot points now, in the frame that `link` reckons T = 1 in."""
    raw, pose = r.system.board.newest("ATRV2/Drive/Raw").value, r.system.board.newest("Localization/Pose").value
    return float(raw.position[1] if link == "drive" else pose.pose[3])


def test_every_listed_flag_drives_and_goes_down_without_the_laser_bit(link_and_robot: tuple[str, RawRobot]) -> None:
    link, r = link_and_robot
    for flags in TAKES[link]:
        kind, sonar = flags % 10, 10 if flags // 10 % 2 else 0
        ahead = (r.pose[0] + 3.0 * math.cos(r.pose[2]), r.pose[1] + 3.0 * math.sin(r.pose[2]))
        assert r.post(flags, ahead if kind == 2 else (0.0, heading_for(r, link)), (0.3, 0.0), to=link) == ""
        r.run(1.5)
        status = r.status_of(link)
        assert (accepted(r, link).flags, accepted(r, "drive").flags) == (flags, sonar + min(kind, 1)), flags
        assert r.velocity[0] == pytest.approx(0.3, abs=0.03), flags
        assert (status.element[0], status.reason) == (0, ""), flags
        assert link == "drive" or status.element[1] == (-1 if kind == 2 else 0), flags
        assert status.data[0] == pytest.approx(r.velocity[0], abs=0.03), "data are the velocities in force"
    r.post(0, to=link)
    r.run(1.0)


def test_every_other_flag_is_refused_with_zero_velocity(link_and_robot: tuple[str, RawRobot]) -> None:
    link, r = link_and_robot
    for flags in REFUSES[link]:
        r.post(0, velocity=(0.3, 0.0), to=link)
        r.run(0.8)
        assert r.velocity[0] > 0.1, flags
        r.post(flags, (3.0, 0.0), (0.3, 0.0), to=link)
        r.run(0.7)
        status = r.status_of(link)
        assert (status.element[0], status.reason) == (0, "bad-command"), flags
        assert str(flags) in status.text
        assert r.velocity == (pytest.approx(0.0, abs=1e-3), pytest.approx(0.0, abs=1e-3)), flags
    r.post(0, velocity=(0.3, 0.0), to=link)
    r.run(1.0)
    assert r.status_of(link).reason == "", "a good command ends it"


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_numbers_that_are_none_are_refused_at_every_link(link_and_robot: tuple[str, RawRobot], bad: float) -> None:
    link, r = link_and_robot
    for position, velocity, force in (((bad, 0.0), (0.3, 0.0), 1.0), ((0.0, 0.0), (bad, 0.0), 1.0), ((0.0, 0.0), (0.3, 0.0), bad)):
        r.post(0, position, velocity, (force,), to=link)
        r.run(0.8)
        assert r.status_of(link).reason == "bad-command"
        assert r.velocity[0] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(("position", "velocity"), [((), (0.3, 0.0)), ((0.0,), (0.3, 0.0)), ((0.0, 0.0), (0.3,)), ((0.0, 0.0), ("0.3", "0"))])
def test_a_command_with_an_element_missing_is_refused_and_breaks_no_link(link_and_robot: tuple[str, RawRobot], position: Any, velocity: Any) -> None:
    link, r = link_and_robot
    r.post(0, velocity=(0.3, 0.0), to=link)
    r.run(0.8)
    r.post(0, position, velocity, to=link)
    r.run(0.8)
    assert r.status_of(link).reason == "bad-command"
    assert r.velocity[0] == pytest.approx(0.0, abs=1e-3)
    assert [part.module.name for part in r.system.parts if part.failures] == []


# ------------------------------------------------------------------ threads and inboxes


def stopped_codes(r: RawRobot) -> tuple[bool, bool, bool]:
    """Which of motion, avoid and drive show -10, each in its own element."""
    return r.status.element[3] == -10, r.status_of("avoid").element == (-10, -10), r.status_of("drive").element == (-10,)


@pytest.mark.parametrize(
    ("orders", "stopped"),
    [
        (["motion -1"], (True, True, False)),
        (["stop motion"], (True, False, False)),
        (["stop avoid"], (False, True, False)),
        (["stop drive"], (False, False, True)),
        (["stop motion", "avoid -1"], (True, True, False)),
        (["motion -1", "drive -1"], (True, True, True)),
        (["motion -1", "start motion"], (False, False, False)),
        (["motion -1", "start avoid"], (True, False, False)),
        (["motion -1", "drive -1", "start motion"], (False, False, False)),
        (["start motion", "start motion"], (False, False, False)),
        (["stop motion", "stop motion", "start motion"], (False, False, False)),
    ],
    ids=lambda value: " then ".join(value) if isinstance(value, list) else "",
)
def test_what_starts_and_stops_a_thread(robot: Make, orders: list[str], stopped: tuple[bool, bool, bool]) -> None:
    r = robot()
    for order in orders:
        verb, what = order.split()
        if verb in ("start", "stop"):
            r.module(what, verb == "start")
        else:
            assert r.post(int(what), to=verb) == ""
        r.run(0.3)
    assert stopped_codes(r) == stopped
    assert {"motion", "avoid", "drive"} <= {part.module.name for part in r.system.parts}, "a stopped module stays listed"
    if not any(stopped):
        r.order(32, (3.0, 0.0), (0.3, 0.0))
        r.run(1.5)
        assert r.velocity[0] > 0.2


@pytest.mark.parametrize(
    ("stopped", "free"),
    [((), ["motion"]), (("motion",), ["motion", "avoid"]), (("motion", "avoid"), ["motion", "avoid", "drive"]), (("avoid",), ["motion", "drive"])],
)
def test_an_inbox_belongs_to_the_link_above_while_that_one_runs(robot: Make, stopped: tuple[str, ...], free: list[str]) -> None:
    r = robot()
    for name in stopped:
        r.module(name, False)
    for link in ("motion", "avoid", "drive"):
        assert r.post(0, to=link) == ("" if link in free else "wrong-state")
    for link in ("filter", "base"):
        assert r.post(0, to=link) == "wrong-state"


@pytest.mark.parametrize("stopped", [(), ("motion",), ("motion", "avoid")])
def test_stop_wins_whoever_drives(robot: Make, stopped: tuple[str, ...]) -> None:
    r = robot()
    for name in stopped:
        r.module(name, False)
    link = ("motion", "avoid", "drive")[len(stopped)]
    r.post(0, velocity=(0.9, 0.0), to=link)
    r.run(2.0)
    r.system.operator_stop("operator")
    assert r.post(0, velocity=(0.9, 0.0), to=link) == "wrong-state", "what comes in the same moment is refused"
    r.run(0.1)
    assert r.system.board.newest("ATRV2/Drive/Command").value.velocity == (0.0, 0.0)
    assert r.status_of(link).reason == "stopped"
    r.run(1.3)
    assert r.velocity[0] == pytest.approx(0.0, abs=1e-3)


def test_a_goto_goes_on_when_motion_alone_is_stopped(robot: Make) -> None:
    r = robot()
    r.order(32, (8.0, 0.0), (0.5, 0.0))
    r.run(2.0)
    r.module("motion", False)
    assert r.status.element[3] == -10
    assert r.run(30.0, lambda: r.status_of("avoid").element == (0, 1))


def test_a_job_ends_with_its_motion_thread_and_leaves_a_status_of_rest(robot: Make) -> None:
    r = robot()
    r.order(42, (20.0, 0.0))
    assert r.run(20.0, lambda: r.velocity[0] > 0.3)
    r.module("motion", False)
    assert (r.status.element, r.status.data) == ((0, 0, 0, -10), (0.0, 0.0))
    r.run(2.0)
    assert r.velocity[0] == pytest.approx(0.0, abs=1e-3)


def test_a_stopped_drive_shows_through_all_links_without_a_gap_whatever_is_commanded(robot: Make) -> None:
    r = robot()
    r.module("drive", False)
    for flags in (0, 32, 42, 30):
        r.order(flags, (8.0, 0.0), (0.3, 0.0))
        r.run(3.0)
        assert {code[0] for code in r.links} == {-10}, flags


def test_what_was_posted_while_avoidance_was_stopped_is_dropped_and_not_shown_as_running(robot: Make) -> None:
    r = robot()
    r.module("avoid", False)
    r.order(32, (8.0, 0.0), (0.5, 0.0))
    r.run(0.5)
    assert r.status.element == (-10, -10, 0, 0)
    r.module("avoid", True)
    r.run(1.0)
    assert r.status.element == (0, 0, 0, 0)
    assert r.velocity[0] == pytest.approx(0.0, abs=1e-3)


# ------------------------------------------------------------------ every status code by name


def until_code(r: RawRobot, code: int, seconds: float, flags: int, velocity: tuple[float, float], position: tuple[float, float] = (0.0, 0.0)) -> bool:
    """Give the command once a second, as a person at a joystick, until element[0] shows `code`."""
    for _ in range(round(seconds)):
        r.order(flags, position, velocity)
        if r.run(1.0, lambda: r.status.element[0] == code):
            return True
    return False


LOW = '<polygon id="kerb" height="0.2">{x0},-2 {x1},-2 {x1},2 {x0},2</polygon>'  # nothing but a bumper notices it
WALL = '<wall id="wall">{x},-4 {x},4</wall>'
CODES = [  # element[0], the name, what is there, the flags, the velocities
    (1, "front bumper", LOW.format(x0=2.0, x1=2.5), 0, (0.5, 0.0)),
    (2, "back bumper", LOW.format(x0=-2.5, x1=-2.0), 0, (-0.5, 0.0)),
    (3, "sonar front", WALL.format(x=2.0), 10, (0.5, 0.0)),
    (4, "sonar back", WALL.format(x=-2.0), 10, (-0.5, 0.0)),
    (5, "sonar sides", '<wall id="wall">-3,0.55 3,0.55</wall>', 10, (0.0, 0.5)),
    (6, "laser slow/stop", WALL.format(x=2.0), 20, (0.5, 0.0)),
]


@pytest.mark.parametrize(("code", "name", "parts", "flags", "velocity"), CODES, ids=[row[1] for row in CODES])
def test_element_0_names_what_holds_the_robot(robot: Make, code: int, name: str, parts: str, flags: int, velocity: tuple[float, float]) -> None:
    r = robot(parts)
    assert until_code(r, code, 15.0, flags, velocity), r.status
    places = []
    for _ in range(7):  # first it slows, then it stops
        r.order(flags, velocity=velocity)
        r.run(1.0)
        places.append(r.pose)
    assert r.status.element == (code, 0, 0, 0)
    assert math.dist(places[-1], places[-3]) < 0.03, "it stands, but for what the noise of the sonar lets through"
    assert r.system.simulator.collisions == [] or code in (1, 2)
    assert r.status.reason == {1: "bumper", 2: "bumper", 6: "laser"}.get(code, "sonar")
    if code in (1, 2):
        assert r.status_of("drive").element == (code,)
        r.order(flags, velocity=(0.0, 0.4))
        r.run(1.0)
        assert r.velocity[1] == pytest.approx(0.0, abs=1e-3), "no rotation"
        r.order(flags, velocity=(-0.4 * velocity[0], 0.0))
        r.run(1.5)
        assert abs(r.velocity[0]) > 0.1, "backing off is allowed"
        r.order(flags, velocity=(0.0, 0.0))
        r.run(0.3)
        assert r.status.element[0] == 0, "released, and a new command has come"


@pytest.mark.parametrize("flags", [0, 10, 20, 30, 1, 31])
def test_element_0_is_minus_1_four_seconds_after_the_last_command_of_t_0_and_1(robot: Make, flags: int) -> None:
    r = robot()
    r.order(flags, velocity=(0.3, 0.0))
    r.run(3.9)
    assert r.status.element[0] == 0
    assert r.velocity[0] > 0.2
    r.run(0.3)
    assert (r.status.element, r.status.reason) == ((-1, 0, 0, 0), "command-timeout")
    r.run(1.0)
    assert r.velocity[0] == pytest.approx(0.0, abs=1e-3)
    r.order(flags, velocity=(0.3, 0.0))
    r.run(1.2)
    assert r.status.element[0] == 0 and r.velocity[0] > 0.2


@pytest.mark.parametrize("flags", [20, 30, 21, 32, 22, 0])  # with A = 0 it is the stop filter that must see
def test_element_0_is_7_while_the_laser_reboots(robot: Make, flags: int) -> None:
    r = robot(script='<at t="3"><fault device="laser" kind="fatal"/></at>')
    for _ in range(6):
        r.order(flags, (20.0, 0.0) if flags % 10 == 2 else (0.0, 0.0), (0.3, 0.0))
        r.run(1.0)
    assert (r.status.element[0], r.status.reason) == (7, "laser-fatal")
    assert r.velocity[0] == pytest.approx(0.0, abs=1e-3)
    for _ in range(19):
        r.order(flags, (20.0, 0.0) if flags % 10 == 2 else (0.0, 0.0), (0.3, 0.0))
        r.run(1.0)
    assert r.status.element[0] == 0 and r.velocity[0] > 0.2, "it has rebooted"


def test_element_0_is_7_also_at_rest_while_the_laser_reboots(robot: Make) -> None:
    r = robot(script='<at t="3"><fault device="laser" kind="fatal"/></at>')
    r.order(32, (0.6, 0.0), (0.5, 0.0))
    r.run(6.0)
    assert r.status.element == (7, 1, 0, 0), "reached stays as well"
    r.run(20.0)
    assert r.status.element == (0, 1, 0, 0)


def test_element_1_by_a_goto_from_running_to_reached_and_stuck(robot: Make) -> None:
    r = robot('<wall id="pen">9,-3 15,-3 15,3 9,3 9,-3</wall>')
    r.order(32, (3.0, 0.0), (0.5, 0.0))
    assert r.run(20.0, lambda: r.status.element[1] == 1)
    assert [code[1] for code in r.links] in ([-1, 1], [0, -1, 1])
    r.run(6.0)
    assert r.status.element == (0, 1, 0, 0), "reached stays, and nothing times out below it"
    r.order(32, (12.0, 0.0), (0.5, 0.0))
    assert r.status.element[1] != 2
    assert r.run(120.0, lambda: r.status.element[1] == 2), r.status.text
    assert r.status.reason == "stuck"
    r.run(6.0)
    assert r.status.element[1:] == (2, 0, 0)
    r.order(0)
    r.run(0.3)
    assert r.status.element[1] == 0


def test_a_goto_that_was_touched_waits_for_a_new_command(robot: Make) -> None:
    r = robot(script='<at t="3"><fault device="bumpers" kind="stuck" value="1" for="2"/></at>')
    r.order(32, (8.0, 0.0), (0.5, 0.0))
    r.run(3.0)
    assert r.status.element[:2] == (1, -1)
    at = r.pose
    r.run(4.0)
    assert r.status.element[:2] == (1, -1), "released, but nobody has commanded anew"
    assert math.dist(at[:2], r.pose[:2]) < 0.05
    r.order(32, (8.0, 0.0), (0.5, 0.0))
    assert r.run(25.0, lambda: r.status.element[:2] == (0, 1))


# ------------------------------------------------------------------ frames, acceleration, the filter below


@pytest.mark.parametrize("theta_deg", [0.0, 90.0, -150.0])
@pytest.mark.parametrize("link", ["motion", "avoid", "drive"])
def test_the_heading_of_t_1_is_interface_3s_above_and_the_odometrys_at_drive(robot: Make, theta_deg: float, link: str) -> None:
    r = robot(theta_deg=theta_deg)
    for above in ("motion", "avoid")[: ("motion", "avoid", "drive").index(link)]:
        r.module(above, False)
    target_rad = heading_for(r, link) + 0.6
    r.post(1, (0.0, target_rad), (0.3, 0.0), to=link)
    r.run(3.9)
    assert math.remainder(r.pose[2] - math.radians(theta_deg) - 0.6, math.tau) == pytest.approx(0.0, abs=0.05)
    assert r.velocity[0] > 0.25


def test_the_drive_never_accelerates_harder_than_the_platform_says(robot: Make) -> None:
    r = robot()
    limits = r.system.options.robot.limits
    before, worst, worst_turn = (0.0, 0.0), 0.0, 0.0
    for k in range(60):
        if k % 12 == 0:
            r.order(0, velocity=((0.9, 0.0), (-0.5, 0.8), (0.9, -0.8), (0.0, 0.0), (0.4, 0.8))[k // 12])
        r.run(0.1)
        data = r.status_of("drive").data
        worst, worst_turn = max(worst, abs(data[0] - before[0])), max(worst_turn, abs(data[1] - before[1]))
        before = (data[0], data[1])
    assert worst <= 0.1 * max(limits.acceleration_mps2, limits.deceleration_mps2) + 1e-6
    assert worst_turn <= 0.1 * math.radians(limits.turn_acceleration_dps2) + 1e-6


@pytest.mark.parametrize("flags", [0, 1, 2])
def test_with_both_off_the_stop_filter_still_prevents_contact(robot: Make, flags: int) -> None:
    r = robot(WALL.format(x=3.0))
    for _ in range(12):
        r.order(flags, (6.0, 0.0) if flags == 2 else (0.0, 0.0), (0.9, 0.0))
        r.run(1.0)
    assert r.system.simulator.collisions == []
    assert r.pose[0] < 2.42
    assert r.status.element[0] != 0 and r.status.data == (0.0, 0.0)


def test_a_straight_goto_that_is_blocked_is_stuck_where_it_stands(robot: Make) -> None:
    r = robot(WALL.format(x=3.0))
    r.order(2, (6.0, 0.0), (0.9, 0.0))
    farthest_m = [0.0]

    def is_stuck() -> bool:
        farthest_m.append(max(farthest_m[-1], r.pose[0]))
        return bool(r.status.element[1] == 2)

    assert r.run(20.0, is_stuck), r.status
    assert (r.status.reason, r.system.simulator.collisions) == ("stuck", [])
    assert farthest_m[-1] - r.pose[0] < 0.01 and abs(r.pose[1]) < 0.1, "it neither backs nor looks for a way around: it cannot see"


def test_a_rectangle_does_not_limit_what_is_passed_through(robot: Make) -> None:
    r = robot()
    r.order(46, (-1.0, 0.0), (2.0, 3.0))
    r.run(0.2)
    r.order(32, (6.0, 0.0), (0.5, 0.0))
    assert r.run(30.0, lambda: r.status.element[1] == 1)
    assert r.status.element == (0, 1, 0, -1)
    assert r.pose[0] > 5.6


def test_data_follow_the_true_velocities_through_a_minute_of_driving_by_hand(robot: Make) -> None:
    r = robot(WALL.format(x=9.0))
    orders: list[tuple[int, Any, Any]] = [
        (30, (0.0, 0.0), (0.5, 0.0)),
        (30, (0.0, 0.0), (0.5, 0.2)),
        (31, (0.0, 0.0), (0.4, 0.0)),
        (30, (0.0, 0.0), (-0.3, 0.0)),
        (32, (6.0, 2.0), (0.7, 0.6)),
    ]
    errors: list[float] = []

    def look() -> bool:
        errors.append(abs(r.status.data[0] - r.velocity[0]))
        return False

    for k in range(15):
        r.order(*orders[k % len(orders)])
        r.run(4.0, look)
    assert sum(errors) / len(errors) < 0.03, "the motors' lag alone"
    assert max(errors) < 0.2


@pytest.mark.parametrize("platform", ["jbot", "car"])
def test_a_robot_without_a_laser_says_that_it_cannot_do_the_jobs_of_motion(robot: Make, platform: str) -> None:
    r = robot(platform=platform)
    for flags in (42, 43, 44, 45):
        r.order(flags, (3.0, 0.0), (2.0, 3.0) if flags == 44 else (0.0, 0.0))
        r.run(1.0)
        assert (r.status.element, r.status.reason) == ((0, 0, 0, 0), "no-device")
    r.order(46, velocity=(4.0, 6.0))
    r.run(0.2)
    assert r.status.element == (0, 0, 0, -1), "a rectangle can be set all the same"
    assert r.pose[:2] == (0.0, 0.0)
