"""Wall follow as a raw command, T = 3: which sensors, which side, which distance, and what is said where there is no wall."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.skills.wall_parameters import WallParameters
from tests.chain.rig import Disc, Rig, box
from tests.chain.robots import ATRV2, PIONEER

PARAMETERS = WallParameters()
MIDDLE_M = PARAMETERS.distance_m + PARAMETERS.camera_side_m  # of the robot from a straight wall
LEFT = [((-3.0, 1.6), (60.0, 1.6))]
RIGHT = [((-3.0, -1.6), (60.0, -1.6))]


def rig(walls: list[tuple[tuple[float, float], tuple[float, float]]], **more) -> Rig:  # type: ignore[no-untyped-def]
    made = Rig(more.pop("platform", ATRV2), walls=list(walls), noise=np.random.default_rng(5), **more)
    made.run(0.6)
    return made


def camera(r: Rig, side: float = 1.0) -> tuple[float, float]:
    x, y, theta = r.pose
    c, s = math.cos(theta), math.sin(theta)
    back, aside = -PARAMETERS.camera_back_m, side * PARAMETERS.camera_side_m
    return x + c * back - s * aside, y + s * back + c * aside


@pytest.mark.parametrize("to", ["motion", "avoid"])
@pytest.mark.parametrize(("flags", "down", "within_m"), [(13, 11, 0.5), (23, 1, 0.15), (33, 11, 0.15)])  # sonar alone says little of where
def test_the_wall_on_the_left_is_followed_with_the_sensors_that_a_names(flags: int, down: int, within_m: float, to: str) -> None:
    r = rig(LEFT)
    if to == "avoid":
        r.links["motion"].stop()  # then the inbox of avoidance belongs to the mission
        r.running["motion"] = False
        r.inboxes["avoid"].post("mission", ActuatorState(r.now, flags, velocity=(0.4, 0.0)))
    else:
        r.order(flags, velocity=(0.4, 0.0))
    r.run(8.0)
    speeds_mps: list[float] = []
    r.run(12.0, lambda: speeds_mps.append(r.twist[0]) is not None)
    sent = r.board.newest("drive/command")
    assert sent is not None and isinstance(sent.value, ActuatorState) and sent.value.flags == down
    assert r.status("avoidance").element == (0, 0), r.status("avoidance").text
    assert (r.status("avoidance").reason, r.status("avoidance").text) == ("", "at the wall")
    assert 0.36 < max(speeds_mps) < 0.42 and min(speeds_mps) > (0.1 if flags == 13 else 0.2), "refreshed long after drive's 4 s"
    assert np.mean(speeds_mps) > (0.32 if flags == 13 else 0.37), "an echo says how far, not where: with sonar alone the way is less straight"
    assert 1.6 - camera(r)[1] == pytest.approx(PARAMETERS.distance_m, abs=within_m)
    assert not r.contacts


def test_without_a_sensor_there_is_no_wall() -> None:
    r = rig(LEFT)
    r.order(3, velocity=(0.4, 0.0))
    r.run(6.0)
    assert (r.status("motion").element, r.status("motion").reason) == ((0, 0, 0, 0), "no-wall")
    assert math.hypot(*r.pose[:2]) < 0.01


def test_side_and_distance_ride_in_force_and_velocity_holds_the_maxima() -> None:
    r = rig(RIGHT)
    r.order(33, velocity=(0.2, 0.3), force=(0.0, 0.5, -1.0))
    fastest = [0.0, 0.0]
    r.run(30.0, lambda: fastest.__setitem__(slice(None), [max(fastest[0], r.twist[0]), max(fastest[1], abs(r.twist[1]))]) is not None)
    assert camera(r, side=-1.0)[1] + 1.6 == pytest.approx(0.5, abs=0.1)
    assert 0.19 < fastest[0] < 0.215 and fastest[1] < 0.32


def test_the_nearest_wall_on_the_left_is_taken_although_the_right_one_is_nearer() -> None:
    r = rig([((-3.0, 2.4), (60.0, 2.4)), ((-3.0, -1.2), (60.0, -1.2))])
    r.order(33, velocity=(0.4, 0.0))
    r.run(25.0)
    assert 2.4 - camera(r)[1] == pytest.approx(PARAMETERS.distance_m, abs=0.15)
    assert math.cos(r.pose[2]) > 0.99


def test_a_wall_ahead_is_turned_to_and_taken_to_the_left() -> None:
    r = rig([((3.0, -40.0), (3.0, 5.0))])
    r.order(33, velocity=(0.4, 0.0))
    r.run(25.0)
    assert 3.0 - camera(r)[0] == pytest.approx(PARAMETERS.distance_m, abs=0.15)
    assert math.sin(r.pose[2]) < -0.99


def test_where_there_is_no_wall_it_waits_and_follows_the_one_that_comes() -> None:
    r = rig([])
    r.order(33, velocity=(0.4, 0.0))
    r.run(5.0)
    assert r.status("motion").reason == "no-wall" and math.hypot(*r.pose[:2]) < 0.01
    r.walls += LEFT
    r.run(15.0)
    assert r.status("motion").reason == "" and r.pose[0] > 2.0


def test_a_wall_that_goes_away_is_lost_until_the_next_command() -> None:
    r = rig(LEFT)
    r.order(33, velocity=(0.4, 0.0))
    r.run(10.0)
    r.walls.clear()
    r.run(40.0, lambda: r.status("motion").reason == "wall-lost")
    r.run(2.0)
    assert r.status("motion").reason == "wall-lost" and r.twist[0] == pytest.approx(0.0, abs=1e-3)
    r.walls += [((x - 60.0, r.pose[1] + 1.6), (x + 60.0, r.pose[1] + 1.6)) for x in (r.pose[0],)]
    r.run(3.0)
    assert r.twist[0] == pytest.approx(0.0, abs=1e-3)
    r.order(33, velocity=(0.4, 0.0))
    r.run(4.0)
    assert r.twist[0] > 0.2


def test_a_laser_that_reboots_is_waited_for() -> None:
    r = rig(LEFT)
    r.order(33, velocity=(0.4, 0.0))
    r.run(8.0)
    r.laser = "fatal"
    r.run(25.0)
    assert r.status("motion").element[0] == 7 and r.twist[0] == pytest.approx(0.0, abs=1e-3)
    r.laser = "well"
    r.run(5.0)
    assert r.status("motion").element[0] == 0 and r.twist[0] > 0.3


@pytest.mark.parametrize("platform", [ATRV2, PIONEER], ids=["atrv2", "pioneer"])
def test_round_the_inside_of_a_room_without_touching_what_stands_in_it(platform) -> None:  # type: ignore[no-untyped-def]
    r = rig(box(-4.0, -6.0, 5.0, 1.6), platform=platform, discs=[Disc(1.0, -2.2, 0.4), Disc(4.6, -1.0, 0.1)])
    r.order(33, velocity=(0.5, 0.0))
    r.run(70.0)
    assert not r.contacts and r.clearance > 0.3
    turned = sum(math.remainder(b[2] - a[2], math.tau) for a, b in zip(r.path, r.path[1:], strict=False))
    assert turned < -math.tau * 0.9, "all the way round, clockwise"
