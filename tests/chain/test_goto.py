"""Goto in closed loop: the whole chain drives among posts, boxes, doors and people."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.chain.rig import Disc, Rig, box
from tests.chain.robots import ATRV2, PIONEER

Wall = tuple[tuple[float, float], tuple[float, float]]
BOTH, SONAR, LASER, NONE = 32, 12, 22, 2


def door(width: float) -> list[Wall]:
    return [((3.0, -4.0), (3.0, -width / 2)), ((3.0, width / 2), (3.0, 4.0))]


def drive(rig: Rig, goal: tuple[float, float], flags: int = BOTH, force: float = 0.0, seconds: float = 90.0, tolerance: float = 0.0) -> Rig:
    rig.run(0.6)
    rig.order(flags, goal, (0.5, 0.0), force, tolerance=tolerance)
    rig.run(seconds, lambda: rig.status("motion").element[1] in (1, 2))
    rig.run(1.0)
    return rig


def must_arrive(rig: Rig, goal: tuple[float, float], tolerance: float = 0.3) -> None:
    status = rig.status("motion")
    assert status.element[1] == 1, status.text
    assert math.hypot(rig.pose[0] - goal[0], rig.pose[1] - goal[1]) <= tolerance
    assert rig.contacts == []
    assert rig.twist == (pytest.approx(0.0, abs=0.01), pytest.approx(0.0, abs=0.01))


@pytest.mark.parametrize(
    ("name", "platform", "discs", "walls", "goal", "flags"),
    [
        ("an empty field", ATRV2, [], [], (5.0, 2.0), BOTH),
        ("a goal behind", ATRV2, [Disc(-2.0, 0.5, 0.2)], [], (-4.0, 0.0), BOTH),
        ("a post in the middle", ATRV2, [Disc(3.0, 0.0, 0.15)], [], (6.0, 0.0), BOTH),
        ("a post, laser alone", ATRV2, [Disc(3.0, 0.1, 0.3)], [], (6.0, 0.0), LASER),
        ("a post, sonar alone", PIONEER, [Disc(3.0, 0.1, 0.3)], [], (6.0, 0.0), SONAR),
        ("a box", ATRV2, [], box(2.5, -1.0, 4.0, 1.0), (7.0, 0.0), BOTH),
        ("a long box", ATRV2, [], box(3.0, -2.0, 4.0, 1.5), (8.0, 0.0), BOTH),
        ("a door of 1.4 m, straight", ATRV2, [], door(1.4), (6.0, 0.0), BOTH),
        ("a door of 1.4 m, slantwise", ATRV2, [], door(1.4), (6.0, 2.0), BOTH),
        ("a door of 0.8 m", PIONEER, [], door(0.8), (6.0, 1.5), BOTH),
        ("a corridor", ATRV2, [], [((-2.0, 1.0), (9.0, 1.0)), ((-2.0, -0.7), (9.0, -0.7))], (7.0, 0.2), BOTH),
        ("a slalom", PIONEER, [Disc(2, 0.4, 0.2), Disc(3, -0.6, 0.2), Disc(4, 0.3, 0.2), Disc(5, -0.4, 0.2)], [], (7.0, 0.0), BOTH),
        ("a person who crosses", ATRV2, [Disc(3.0, -4.0, 0.25, (0.0, 0.9))], [], (6.0, 0.0), BOTH),
    ],
)  # fmt: skip
def test_goto_arrives_without_contact(name: str, platform, discs, walls, goal, flags) -> None:  # type: ignore[no-untyped-def]
    rig = drive(Rig(platform, list(discs), list(walls), noise=np.random.default_rng(1)), goal, flags)
    must_arrive(rig, goal)


def test_a_door_is_passed_in_the_middle_and_without_detour() -> None:
    rig = drive(Rig(ATRV2, [], door(1.4), noise=np.random.default_rng(3)), (6.0, 0.0))
    assert max(abs(y) for _, y, _ in rig.path) < 0.1
    assert rig.clearance > 0.15


def random_world(seed: int) -> tuple[list[Disc], list[Wall]]:
    """Posts, boxes, and people who walk straight on."""
    g = np.random.default_rng(seed)
    discs: list[Disc] = []
    walls: list[Wall] = []
    for _ in range(int(g.integers(3, 8))):
        x, y, kind = g.uniform(1.8, 7.0), g.uniform(-3.0, 3.0), g.integers(0, 3)
        if kind == 0:
            discs.append(Disc(x, y, g.uniform(0.05, 0.4)))
        elif kind == 1:
            w, h = g.uniform(0.3, 1.0, 2)
            walls += box(x, y, x + w, y + h) if x + w < 7.2 else []
        else:
            speed, way = g.uniform(0.3, 1.0), g.uniform(-math.pi, math.pi)
            discs.append(Disc(x, y, 0.25, (speed * math.cos(way), speed * math.sin(way))))
    return discs, walls


@pytest.mark.parametrize("seed", range(12))
def test_goto_arrives_in_worlds_nobody_tuned_it_to(seed: int) -> None:
    discs, walls = random_world(seed)
    rig = drive(Rig((ATRV2, PIONEER)[seed % 2], discs, walls, noise=np.random.default_rng(seed)), (9.0, 0.0))
    must_arrive(rig, (9.0, 0.0))


def test_without_avoidance_it_steers_straight() -> None:
    rig = Rig(PIONEER, [Disc(3.0, 0.6, 0.1)])
    drive(rig, (6.0, 0.0), NONE)
    must_arrive(rig, (6.0, 0.0))
    assert max(abs(y) for _, y, _ in rig.path) < 0.02


def test_force_weighs_the_goal_against_avoidance() -> None:
    """The stronger the goal, the nearer it passes; both sides of 1 differ from 1."""
    passes = []
    for force in (0.3, 1.0, 4.0):
        rig = drive(Rig(PIONEER, [Disc(3.0, 0.7, 0.2)]), (6.0, 0.0), force=force)
        must_arrive(rig, (6.0, 0.0))
        passes.append(rig.clearance)
    assert passes[0] > passes[1] + 0.02 > passes[2] + 0.04
    assert drive(Rig(PIONEER, [Disc(3.0, 0.7, 0.2)]), (6.0, 0.0), force=0.0).clearance == passes[1], "0 counts as 1"


def test_walled_in_it_says_stuck_with_figures_and_stands() -> None:
    rig = drive(Rig(ATRV2, [], box(-1.5, -1.5, 1.5, 1.5)), (6.0, 0.0))
    status = rig.status("motion")
    assert (status.element[1], status.reason) == (2, "stuck")
    assert "m to go" in status.text
    assert rig.contacts == []
    rig.run(6.0)
    assert rig.status("motion").element[1] == 2, "stays until the next command"
    assert rig.status("motion").element[0] != -1


def test_a_new_goto_after_stuck_starts_anew() -> None:
    rig = drive(Rig(ATRV2, [], box(-1.5, -1.5, 1.5, 1.5)), (6.0, 0.0))
    rig.walls.clear()
    rig.order(BOTH, (4.0, 0.0), (0.5, 0.0))
    rig.run(20.0, lambda: rig.status("motion").element[1] == 1)
    rig.run(1.0)
    must_arrive(rig, (4.0, 0.0))


@pytest.mark.parametrize("tolerance", [0.1, 0.3, 1.0])
def test_the_tolerance_comes_with_the_command(tolerance: float) -> None:
    rig = drive(Rig(PIONEER), (4.0, 1.0), tolerance=tolerance)
    must_arrive(rig, (4.0, 1.0), tolerance)


def test_a_laser_reboot_pauses_a_goto_and_is_not_called_stuck() -> None:
    rig = Rig(ATRV2)
    drive(rig, (6.0, 0.0), seconds=4.0)
    rig.laser = "fatal"
    rig.run(25.0)
    assert rig.status("motion").element[:2] == (7, -1)
    rig.laser = "well"
    rig.run(30.0, lambda: rig.status("motion").element[1] == 1)
    rig.run(1.0)
    must_arrive(rig, (6.0, 0.0))


def test_the_most_speed_of_the_command_holds() -> None:
    rig = Rig(PIONEER)
    rig.run(0.6)
    rig.order(BOTH, (4.0, 2.0), (0.25, 0.4))
    fastest = [0.0, 0.0]

    def look() -> bool:
        fastest[0], fastest[1] = max(fastest[0], rig.twist[0]), max(fastest[1], abs(rig.twist[1]))
        return rig.status("motion").element[1] == 1

    rig.run(40.0, look)
    assert fastest[0] == pytest.approx(0.25, abs=0.01)
    assert fastest[1] <= 0.41


def test_two_runs_are_equal_bit_for_bit() -> None:
    paths = []
    for _ in range(2):
        discs, walls = random_world(5)
        paths.append(drive(Rig(ATRV2, discs, walls, noise=np.random.default_rng(5)), (9.0, 0.0)).path)
    assert paths[0] == paths[1]


def test_a_pedestrian_who_walks_into_the_standing_robot_is_not_hit_by_it() -> None:
    rig = drive(Rig(ATRV2, [Disc(8.0, 0.0, 0.25, (-0.8, 0.0))]), (6.0, 0.0), seconds=9.0)
    assert rig.contacts == []
